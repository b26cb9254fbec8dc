"""Sentences about the column: values and runs by name, the paper's sentences, what was found, what a study comes to."""

from collections.abc import Callable, Mapping
from math import inf
from typing import Any

from mpm_verify.cases.column.claims import beyond
from mpm_verify.cases.column.exam import ColumnRemark
from mpm_verify.cases.column.experiment import Band
from mpm_verify.cases.column.records import Claim, ClaimCode, Compared
from mpm_verify.cases.column.run import ColumnRun, ColumnStudy
from mpm_verify.reports.sentences.remarks import unread

NOTHING = {
    ("smoothing", "none"): "no smoothing", ("start", "none"): "no stress at first", ("limit", inf): "no limit",
    ("gate", inf): "no gate", ("damping", 0.0): "no damping",
}  # fmt: skip
AFTER = {
    "cells": "cells wide", "ppc": "per cell", "damping_kind": "damping", "deformation": "F", "smoothing": "smoothing",
}  # fmt: skip
QUANTITIES = {
    "front_99": "front, 99 %", "front_999": "front, 99.9 %", "toe": "toe", "height": "height at the wall",
    "height_fit": "height by fit",
}  # fmt: skip
MEASURED = {  # after the word by
    "front_99": "the front of 99 % of the mass", "front_999": "that of 99.9 %", "toe": "the toe",
    "height": "the strip at the wall", "height_fit": "the line through the first width",
}  # fmt: skip
ENERGIES = {
    "potential": "potential energy", "kinetic": "kinetic energy of the particles",
    "on_grid": "kinetic energy on the grid",
}  # fmt: skip
LENGTHS = (
    "Front and toe are distances from the wall in m. The front, by which the paper's sentences are answered, is that "
    "of 99 % of the mass; 99.9 % lie within the next, and the heap that is connected to the wall ends at its toe. In a "
    "triangle they are at 0.9, 0.968 and 1 of its length: what can be seen of a deposit ends at the toe.",
    "The height is that of the heap next to the wall, in one strip of a seventh of the width. By fit it is where a "
    "line through the first width of the surface meets the wall, which sand that hangs there does not lift. Falls: by "
    "how much the first still fell in the last fifth of the time. Area: that below the surface over that of the "
    "column; 1 for a heap that is packed as the column was.",
    "A run rests once the kinetic energy that the grid sees stays below a ten-thousandth of the initial potential "
    "energy. Times of rest are in √(h₀/g); grains of the experiment came to rest after 2.5 to 3.3 of it.",
)
OLDER = "A dash stands where a run was stored before that was measured; the command of the study runs it again."
BOOKS = (
    "The logarithm of det F is plastic dilation, void strain and elastic strain, which is small; pooling moves void "
    "and compression between the particles of a cell, and keeps their sum. Crowding is the volume that particles keep "
    "over the space that they are in: with few particles nothing on the grid ties the two. Mean det F over crowding is "
    "the area of the heap, that of the column 1. Drifted: the strain that pooling has taken from crowded particles so "
    "far, that is by how much positions came closer than det F knew."
)
ASPECTS = (
    "Run-out is the distance by which the front, 99 % of the mass, comes beyond the column's free side, over its "
    "width. The scaling of the experiment is quoted in two forms, and its change from squat to tall columns between "
    "1.8 and 2.8; the band holds all that they give. With fewer than {few} cells of the "
    "height a squat column falls short."
)
ANSWERS = {True: "reproduced", False: "not reproduced", None: "cannot be told"}


# ---- names of values and runs


def value(axis: str, of: Any) -> str:
    """Value of an axis: `14 cells wide`, `no damping`."""
    if (axis, of) in NOTHING:
        return NOTHING[axis, of]
    if isinstance(of, bool):
        return axis if of else f"no {axis}"
    if axis == "damping":
        return f"{100 * of:g} % damping"
    if axis in AFTER:
        return f"{of} {AFTER[axis]}"
    if axis in ("method", "material"):
        return str(of)
    return f"{axis} {f'{of:g}' if isinstance(of, float) else of}"


def listed(values: Mapping[str, Any]) -> str:
    """Values of several axes."""
    return ", ".join(value(axis, of) for axis, of in values.items())


def label(study: ColumnStudy, run: ColumnRun) -> str:
    """Name of a run by what the study varies; by its method, mesh and material where it varies nothing."""
    return listed({axis: getattr(run, axis) for axis in study.axes or ("method", "cells", "ppc", "material")})


def quantity(key: str) -> str:
    """Name of a length that is refined."""
    return QUANTITIES[key]


def answer(claim: Claim) -> str:
    """Answer: reproduced, not reproduced, or cannot be told."""
    return ANSWERS[claim.reproduced]


# ---- the paper's sentences, and what was found


def says(claim: Claim) -> str:
    """Sentence of the paper."""
    return SAYS[claim.code]


def found(claim: Claim) -> str:
    """Sentences on what the runs came to, and by which measure."""
    return " ".join(filter(None, (FOUND[claim.code](claim), measured(claim))))


def measured(claim: Claim) -> str:
    """Sentence on the measure of the length that a claim hangs on, and what others answer; empty for energies."""
    if not claim.by:
        return ""
    usual, *others = claim.by
    same = [MEASURED[name] for name in others if claim.by[name] is claim.reproduced]
    text = f"By {MEASURED[usual]}" + f"; the same by {' and '.join(same)}" * bool(same)
    for name in (name for name in others if claim.by[name] is not claim.reproduced):
        text += f"; by {MEASURED[name]}: {ANSWERS[claim.by[name]]} ({each(claim, by(name))})"
    return text + "."


def by(name: str) -> Callable[[Compared], float]:
    """Function that gives the length of a run by a measure."""
    return lambda one: one.lengths[name]


def band(limits: Band) -> str:
    """Band in m."""
    return f"{limits[0]:.3f} to {limits[1]:.3f} m"


def off(length: float, limits: Band) -> str:
    """Distance from a band, such as `28 % below the band`."""
    away = beyond(length, limits)
    return "in the band" if not away else f"{100 * abs(away):.0f} % {'above' if away > 0 else 'below'} the band"


def fronts(claim: Claim) -> str:
    """Fronts, such as `0.902 m with 1 per cell, ...`."""
    return each(claim, lambda one: one.front)


def heights(claim: Claim) -> str:
    """Heights, such as `0.080 m with 1 per cell, ...`."""
    return each(claim, lambda one: one.height)


def each(claim: Claim, length: Callable[[Compared], float]) -> str:
    """Length of each run, with what the run has on the axis."""
    return ", ".join(f"{length(one):.3f} m with {value(claim.axis, one.value)}" for one in claim.runs)


def front_over(claim: Claim) -> str:
    """Fronts, and which runs are weak evidence, as their heap is too small for its material."""
    text = f"The front comes to {fronts(claim)}; the experiment's band is {band(claim.known.front)}."
    crowded = [one for one in claim.runs if one.crowding > claim.numbers["crowded"]]
    named = " and ".join(f"{one.crowding:.2f} times with {value(claim.axis, one.value)}" for one in crowded)
    weak = f" But particles keep more volume than the space that they fill, {named}: those runs are weak evidence."
    return text + (weak if crowded else "")


def potential_kept(claim: Claim) -> str:
    """Changes of both energies."""
    n, last = claim.numbers, value(claim.axis, claim.runs[-1].value)
    return (
        f"With {last} it changes by up to {100 * n['potential']:.1f} % of the initial potential energy, and kinetic "
        f"energy by up to {100 * n['kinetic']:.1f} % of it. From {100 * n['little']:.0f} % on a "
        "change can be seen on a figure."
    )


def kinetic_changed(claim: Claim) -> str:
    """Change of the kinetic energy."""
    n = claim.numbers
    return (
        f"By up to {100 * n['kinetic']:.0f} % of its largest value, which falls by {100 * n['fall']:.0f} %. From "
        f"{100 * n['marked']:.0f} % on it counts as marked."
    )


def volumetric_front(claim: Claim) -> str:
    """Front with and without."""
    one, plain = claim.runs
    return (
        f"The front comes to {one.front:.3f} m; the experiment's band is {band(claim.known.front)}. It is "
        f"{1000 * (one.front - plain.front):+.0f} mm from where it comes without smoothing."
    )


def volumetric_height(claim: Claim) -> str:
    """Height with and without."""
    one, plain = claim.runs
    return (
        f"The height at the wall is {one.height:.3f} m, and {plain.height:.3f} m without smoothing; the experiment's "
        f"is {band(claim.known.height)}."
    )


def deviatoric_front(claim: Claim) -> str:
    """Front with and without, against the band."""
    one, plain = claim.runs
    where = [off(run.front, claim.known.front) for run in (one, plain)]
    return (
        f"The front comes to {one.front:.3f} m with and {plain.front:.3f} m without it, {where[0]} and {where[1]}; up "
        f"to {100 * claim.numbers['scatter']:.0f} % is scatter."
    )


def materials_close(claim: Claim) -> str:
    """Both fronts."""
    sand, plain = claim.runs
    return (
        f"The fronts come to {sand.front:.3f} m and {plain.front:.3f} m, {100 * claim.numbers['apart']:+.1f} %; up to "
        f"{100 * claim.numbers['close']:.0f} % counts as close."
    )


def sand_stiffer(claim: Claim) -> str:
    """Distance by which UBCSAND comes less far, or further."""
    sand, plain = claim.runs
    return (
        f"The front of UBCSAND comes {1000 * abs(sand.front - plain.front):.0f} mm "
        f"{'less far' if claim.numbers['apart'] < 0 else 'further'}, its height at the wall is {sand.height:.3f} m "
        f"against {plain.height:.3f} m."
    )


def both_near(claim: Claim) -> str:
    """Both fronts against the band."""
    sand, plain = (off(one.front, claim.known.front) for one in claim.runs)
    near = f"up to {100 * claim.numbers['near']:.0f} % counts as close"
    return f"UBCSAND {sand}, Mohr-Coulomb {plain}, {band(claim.known.front)}; {near}."


def sand_late(claim: Claim) -> str:
    """Distance of the fronts, early and at the end."""
    n = claim.numbers
    return (
        f"The two fronts differ by up to {1000 * n['early']:.0f} mm until {n['until']:g} s, and by "
        f"{1000 * n['late']:.0f} mm at the end."
    )


SAYS: dict[ClaimCode, str] = {
    ClaimCode.FRONT_OVER: "Run-out is over-predicted whatever the number of particles.",
    ClaimCode.HEIGHT_RISES: "The final height rises with the number of particles.",
    ClaimCode.HEIGHT_UNDER_WITH_ONE: "With one per cell the final height is under-predicted.",
    ClaimCode.HEIGHT_NEAR_WITH_MORE: "With more it reaches roughly the experiment's.",
    ClaimCode.FRONT_FALLS: "Run-out falls as damping grows.",
    ClaimCode.FRONT_CLOSER: "It comes closer to the experiment.",
    ClaimCode.POTENTIAL_KEPT: "Potential energy is not discernibly changed by damping.",
    ClaimCode.KINETIC_CHANGED: "Kinetic energy is markedly changed.",
    ClaimCode.VOLUMETRIC_FRONT: "Volumetric smoothing over-predicts the run-out.",
    ClaimCode.VOLUMETRIC_HEIGHT: "Volumetric smoothing over-predicts the height of the slope.",
    ClaimCode.DEVIATORIC_FRONT: "Deviatoric smoothing reduces the run-out, towards the experiment.",
    ClaimCode.MATERIALS_CLOSE: "UBCSAND and Mohr-Coulomb end close to each other.",
    ClaimCode.SAND_STIFFER: "UBCSAND is marginally stiffer: it runs out a little less.",
    ClaimCode.BOTH_NEAR: "Both come close to the experiment.",
    ClaimCode.SAND_EARLY: "UBCSAND follows the experiment in the first 0.17 s.",
    ClaimCode.SAND_LATE: "UBCSAND follows Mohr-Coulomb later, and not before 0.17 s.",
}
FOUND: dict[ClaimCode, Callable[[Claim], str]] = {
    ClaimCode.FRONT_OVER: front_over,
    ClaimCode.HEIGHT_RISES: lambda claim: (
        f"It is {heights(claim)}. In the last fifth of the time they still fell by up to "
        f"{100 * claim.numbers['creep']:.1f} %."
    ),
    ClaimCode.HEIGHT_UNDER_WITH_ONE: lambda claim: (
        f"It is {heights(claim)}; the experiment's is {band(claim.known.height)}."
    ),
    ClaimCode.HEIGHT_NEAR_WITH_MORE: lambda claim: (
        f"It is {heights(claim)}, {off(claim.runs[-1].height, claim.known.height)}; up to "
        f"{100 * claim.numbers['near']:.0f} % counts as roughly."
    ),
    ClaimCode.FRONT_FALLS: lambda claim: f"The front comes to {fronts(claim)}.",
    ClaimCode.FRONT_CLOSER: lambda claim: (
        f"From {off(claim.runs[0].front, claim.known.front)} to {off(claim.runs[-1].front, claim.known.front)}, "
        f"{band(claim.known.front)}."
    ),
    ClaimCode.POTENTIAL_KEPT: potential_kept,
    ClaimCode.KINETIC_CHANGED: kinetic_changed,
    ClaimCode.VOLUMETRIC_FRONT: volumetric_front,
    ClaimCode.VOLUMETRIC_HEIGHT: volumetric_height,
    ClaimCode.DEVIATORIC_FRONT: deviatoric_front,
    ClaimCode.MATERIALS_CLOSE: materials_close,
    ClaimCode.SAND_STIFFER: sand_stiffer,
    ClaimCode.BOTH_NEAR: both_near,
    ClaimCode.SAND_EARLY: lambda claim: "No curve of the experiment is at hand.",
    ClaimCode.SAND_LATE: sand_late,
}


# ---- what a study comes to


def claims(n: Mapping[str, Any]) -> str:
    """Number of sentences that are reproduced."""
    untold = f", {n['open']:g} cannot be told" if n["open"] else ""
    hang = f" By another measure of front or height {n['hang']:g} of them have another answer." if n["hang"] else ""
    return f"Sentences of the paper: {n['reproduced']:g} reproduced, {n['not_reproduced']:g} not{untold}.{hang}"


def unread_curves(n: Mapping[str, Any]) -> str:
    """Sentence on the figures and sentences that are left out."""
    return f"{unread(n)} So are sentences of the paper that are about curves."


def by_fit(n: Mapping[str, Any]) -> str:
    """Height by fit, of a run that was measured so."""
    return f", {n['height_fit']:.3f} m by fit" if "height_fit" in n else ""


REMARKS: dict[str, Callable[[Mapping[str, Any]], str]] = {
    ColumnRemark.FINISHED: lambda n: f"{n['finished']:g} of {n['runs']:g} runs came to their end.",
    ColumnRemark.FAILED: lambda n: f"{n['failed']:g} failed; the table says where and why.",
    ColumnRemark.TO_DO: lambda n: f"{n['runs']:g} are still to be done: the same command goes on.",
    ColumnRemark.CLAIMS: claims,
    ColumnRemark.CROWDED: lambda n: (
        f"In the heap of {n['runs']:g} of them particles keep more than {n['limit']:g} times the volume of the space "
        "that they are in: such a heap is too small for its material."
    ),
    ColumnRemark.GIVEN: lambda n: (
        f"With few particles positions drift from det F. In {n['runs']:g} of them pooling had to give more than "
        f"{100 * n['limit']:g} % of the initial energy, up to {100 * n['most']:.0f} %, to hold particles to their "
        "space: such a run shows that correction as much as the sand. Take more particles per cell."
    ),
    ColumnRemark.ALONE: lambda n: (
        f"The front comes to {n['front_99']:.3f} m by 99 % of the mass, to {n['front_999']:.3f} m by 99.9 %, and the "
        f"toe to {n['toe']:.3f} m; the height at the wall is {n['height']:.3f} m{by_fit(n)}. The method itself loses "
        f"{100 * n['lost']:.1f} % of the energy."
    ),
    ColumnRemark.UNREAD: unread_curves,
    ColumnRemark.BANDS: lambda n: (
        "The band of the experiment lies between two forms in which texts quote its scaling, that of the height "
        "between two experiments; they are not error bars. No curve of the experiment is shown, as none is at hand."
    ),
}
