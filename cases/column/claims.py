"""Claims: sentences of the paper about the column that are held against our runs: reproduced or not, with the numbers.

A claim is about one axis: particles per cell, damping, smoothing, material. It is held against runs that differ in that
axis alone. What "little" and "close" mean is said here, since the paper gives no numbers; None is the answer where our
runs, or what is known of the experiment, cannot tell. Each has its answers by all measures of the length that it hangs
on (records.py). The sentences are in reports/sentences/column.py.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from mpm_verify.cases.column.experiment import Band, Experiment, experiment
from mpm_verify.cases.column.records import HANGS, MEASURES, Claim, ClaimCode, Compared, FinishedRun
from mpm_verify.cases.column.run import ColumnRun

LITTLE = 0.01  # of the initial potential energy: what can be seen on a figure of it
MARKED = 0.10  # of the largest kinetic energy
CROWDED = 1.2  # from which crowding on a heap is too small for its material
CLOSE = 0.05  # of the front
SCATTER = 0.01  # of the front: what it owes to the positions of particles in their cells (study offsets)
NEAR = 0.10  # of the experiment's band
EARLY = 0.17  # s: until then the paper's materials differ


def claims(ran: Sequence[FinishedRun], axes: Sequence[str]) -> list[Claim]:
    """Claims on every axis that the paper speaks of, one list a family of runs."""
    found = []
    for axis in axes:
        for family in families(ran, axis):
            known = experiment(family[0].run)
            shared = values(family[0].run, [other for other in axes if other != axis])
            if axis in SPEAK and known and len(family) > 1:
                found += [replace(claim, shared=shared) for claim in by_all(SPEAK[axis], family, known)]
    return found


def by_all(speak: "Speaker", family: Sequence[FinishedRun], known: Experiment) -> list[Claim]:
    """Claims by the usual measures, each with its answers by all that every run of the family has."""
    answers = {}
    for kind, names in MEASURES.items():
        for name in (name for name in names if all(name in one.values for one in family)):
            told = speak([replace(one, **{f"{kind}_by": name}) for one in family], known)  # type: ignore[arg-type]
            answers[name] = {claim.code: claim.reproduced for claim in told if claim.code in HANGS[kind]}
    return [
        replace(claim, by={name: by[claim.code] for name, by in answers.items() if claim.code in by})
        for claim in speak(family, known)
    ]


def families(ran: Sequence[FinishedRun], axis: str) -> list[list[FinishedRun]]:
    """Runs that differ in one axis alone, in the order of the study."""
    found: dict[ColumnRun, list[FinishedRun]] = {}
    if not ran:
        return []
    usual: Any = {axis: getattr(ran[0].run, axis)}
    for one in ran:
        found.setdefault(replace(one.run, **usual), []).append(one)
    return list(found.values())


def values(run: ColumnRun, axes: Sequence[str]) -> dict[str, Any]:
    """Values of a run on these axes."""
    return {axis: getattr(run, axis) for axis in axes}


def compared(axis: str, *runs: FinishedRun) -> tuple[Compared, ...]:
    """Runs as a claim on the axis tells them."""
    return tuple(
        Compared(getattr(one.run, axis), one.front, one.height, one.values["crowding"], one.lengths) for one in runs
    )


def rises(numbers: Sequence[float]) -> bool:
    """Whether each number is above the one before."""
    return all(later > earlier for earlier, later in pairwise(numbers))


def beyond(value: float, band: Band) -> float:
    """Distance of a value above (or, negative, below) a band, as a fraction of its nearer end; zero inside."""
    low, high = band
    return value / high - 1 if value > high else value / low - 1 if value < low else 0.0


def of_particles(family: Sequence[FinishedRun], known: Experiment) -> list[Claim]:
    """Claims of Figure 4."""
    few = sorted(family, key=lambda one: one.run.ppc)
    first, last = few[0], few[-1]
    every, creep = compared("ppc", *few), max((one.creep for one in few), key=abs)
    rising = settled(few, rises([one.height for one in few]))
    under = beyond(first.height, known.height) < 0 if first.run.ppc == 1 else None
    return [
        Claim(ClaimCode.FRONT_OVER, "ppc", all(beyond(one.front, known.front) > 0 for one in few), every, known,
              {"crowded": CROWDED}),
        Claim(ClaimCode.HEIGHT_RISES, "ppc", rising, every, known, {"creep": creep}),
        Claim(ClaimCode.HEIGHT_UNDER_WITH_ONE, "ppc", under, compared("ppc", first), known),
        Claim(ClaimCode.HEIGHT_NEAR_WITH_MORE, "ppc", abs(beyond(last.height, known.height)) <= NEAR,
              compared("ppc", last), known, {"near": NEAR}),
    ]  # fmt: skip


def settled(family: Sequence[FinishedRun], found: bool) -> bool | None:
    """Whether heights rise; None where one may still fall below the one before."""
    falls = [later.height - earlier.height < later.creep * later.height for earlier, later in pairwise(family)]
    return None if found and any(falls) else found


def of_damping(family: Sequence[FinishedRun], known: Experiment) -> list[Claim]:
    """Claims of Figures 5 and 6."""
    rising = sorted(family, key=lambda one: one.run.damping)
    first, last = rising[0], rising[-1]
    closer = abs(beyond(last.front, known.front)) < abs(beyond(first.front, known.front))
    ends = compared("damping", first, last)
    found = [
        Claim(ClaimCode.FRONT_FALLS, "damping", rises([-one.front for one in rising]), compared("damping", *rising),
              known),
        Claim(ClaimCode.FRONT_CLOSER, "damping", closer, ends, known),
    ]  # fmt: skip
    if not (first.curves and last.curves):
        return found
    start = float(first.curves["potential"][0])
    potential, kinetic = (largest_change(first, last, name) for name in ("potential", "on_grid"))
    most = float(first.curves["on_grid"].max())
    least = float(last.curves["on_grid"].max())
    changes = {"potential": potential / start, "kinetic": kinetic / start, "little": LITTLE}
    marked = {"kinetic": kinetic / most, "fall": 1 - least / most, "marked": MARKED}
    return [
        *found,
        Claim(ClaimCode.POTENTIAL_KEPT, "damping", potential <= LITTLE * start, ends, known, changes),
        Claim(ClaimCode.KINETIC_CHANGED, "damping", kinetic >= MARKED * most, ends, known, marked),
    ]  # fmt: skip


def largest_change(one: FinishedRun, other: FinishedRun, name: str) -> float:
    """Largest difference of two curves at equal times."""
    t = one.curves["t"]
    return float(np.abs(one.curves[name] - np.interp(t, other.curves["t"], other.curves[name])).max())


def of_smoothing(family: Sequence[FinishedRun], known: Experiment) -> list[Claim]:
    """Claims of Figure 7."""
    by = {one.run.smoothing.partition(":")[0]: one for one in reversed(family)}
    plain, found = by.get("none"), []
    if plain and (one := by.get("volumetric")):
        both = compared("smoothing", one, plain)
        found += [
            Claim(ClaimCode.VOLUMETRIC_FRONT, "smoothing", beyond(one.front, known.front) > 0, both, known),
            Claim(ClaimCode.VOLUMETRIC_HEIGHT, "smoothing", beyond(one.height, known.height) > 0, both, known),
        ]
    if plain and (one := by.get("deviatoric")):
        near, far = (abs(beyond(each.front, known.front)) for each in (one, plain))
        nearer = None if near == far == 0 else one.front < (1 - SCATTER) * plain.front and near < far
        both = compared("smoothing", one, plain)
        found.append(Claim(ClaimCode.DEVIATORIC_FRONT, "smoothing", nearer, both, known, {"scatter": SCATTER}))
    return found


def of_material(family: Sequence[FinishedRun], known: Experiment) -> list[Claim]:
    """Claims of Figure 8."""
    by = {one.run.material.partition(":")[0]: one for one in reversed(family)}
    if not {"mohr_coulomb", "ubcsand"} <= by.keys():
        return []
    plain, sand = by["mohr_coulomb"], by["ubcsand"]
    apart = sand.front / plain.front - 1
    both = compared("material", sand, plain)
    near = all(abs(beyond(one.front, known.front)) <= NEAR for one in (plain, sand))
    found: dict[ClaimCode, tuple[bool | None, dict[str, float]]] = {
        ClaimCode.MATERIALS_CLOSE: (abs(apart) <= CLOSE, {"apart": apart, "close": CLOSE}),
        ClaimCode.SAND_STIFFER: (-CLOSE <= apart < 0, {"apart": apart}),
        ClaimCode.BOTH_NEAR: (near, {"near": NEAR}),
        ClaimCode.SAND_EARLY: (None, {"until": EARLY}),
    }
    if sand.curves and plain.curves:
        early, late = apart_at(sand, plain)
        found[ClaimCode.SAND_LATE] = (late < early, {"until": EARLY, "early": early, "late": late})
    return [Claim(code, "material", reproduced, both, known, numbers) for code, (reproduced, numbers) in found.items()]


def apart_at(sand: FinishedRun, plain: FinishedRun) -> tuple[float, float]:
    """Distance of the fronts: at most until EARLY, and at the end [m]."""
    t, front = sand.curves["t"], sand.curves[sand.front_by]
    difference = front - np.interp(t, plain.curves["t"], plain.curves[plain.front_by])
    return float(np.abs(difference[t <= EARLY]).max(initial=0.0)), abs(float(difference[-1]))


Speaker = Callable[[Sequence[FinishedRun], Experiment], list[Claim]]
SPEAK: dict[str, Speaker] = {
    "ppc": of_particles,
    "damping": of_damping,
    "smoothing": of_smoothing,
    "material": of_material,
}
