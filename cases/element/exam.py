"""Examination of one material by `verify material`: element tests with errors and orders in the strain step."""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from enum import StrEnum
from typing import Any

import numpy as np

from mpm_verify.cases.element.drawn import drawn
from mpm_verify.cases.element.following import Stopped
from mpm_verify.cases.element.judged import checks
from mpm_verify.cases.element.motion import UNIT
from mpm_verify.cases.element.paths import PathSource
from mpm_verify.cases.element.run import ElementRun
from mpm_verify.cases.element.study import FINE, ROUND_OFF, ElementStudy
from mpm_verify.cases.harness.checks import Check, Examination, Remark
from mpm_verify.cases.harness.study import Study
from mpm_verify.solver.material.ubcsand import Ubcsand, out_of_range
from mpm_verify.solver.plugins import label, split


class ElementRemark(StrEnum):
    """Remarks on what came out, on each test, and on parameters."""

    TESTS = "element.tests"
    UNJUDGED = "element.unjudged"  # nothing is known of the path
    EXACT = "element.exact"  # tests without an error in any number of steps
    ORDERS = "element.orders"
    FIRST_ORDER = "element.first_order"  # is expected of a return along the stress at the end of a step
    FAILED = "element.failed"
    AGAINST = "element.against"  # what errors are against: a source
    AGAINST_OWN = "element.against_own"  # the test's own curve with more steps
    ROUND_OFF = "element.round_off"
    NO_ORDER = "element.no_order"
    ORDER = "element.order"
    ZZ_WITHIN = "element.zz_within"  # the range of the principal stresses in the plane, in all steps
    ZZ_OUTSIDE = "element.zz_outside"
    UNDEFORMED = "element.undeformed"
    OR_MORE = "element.or_more"
    NO_EFFECT = "element.no_effect"
    NO_EFFECT_PRIMARY = "element.no_effect_primary"  # in primary loading
    AFTER_REVERSAL = "element.after_reversal"
    CORRELATION = "element.correlation"
    OUR_READING = "element.our_reading"
    RATE_IDLE = "element.rate_idle"  # along a path of strains
    RATE_ACTS = "element.rate_acts"  # along a motion: what turns, and how well steps resolve it
    PATH_READ = "element.path_read"  # columns of a file
    PATH_END = "element.path_end"  # the stress there
    PATH_STOPPED = "element.path_stopped"
    PATH_STRESSES = "element.path_stresses"  # columns that control a stress
    PATH_MOTION = "element.path_motion"  # strains that are read as simple shear
    PATH_DEFORMED = "element.path_deformed"  # a motion whose first F is not that of the undeformed state
    PLANE_YIELDS = "element.plane_yields"  # of a material that a strain of zz does not make yield
    PATH_ZERO = "element.path_zero"  # in every row, as in plane strain
    PATH_UNUSED = "element.path_unused"
    UNREAD = "element.unread"  # files of curves that cannot be read


def examination(
    study: Study[ElementRun],
    run: ElementRun,
    material: Any,
    studies: Sequence[ElementStudy],
    known: Sequence[Check],
    reads: Sequence[PathSource],
    unread: Sequence[str],
    environment: dict[str, str],
) -> Examination:
    """Examination of the tests of one material, with what is known of it; `unread`: files that cannot be read."""
    found = [*(check for one in studies for check in checks(material, one)), *known]
    still = not any(one.test.motion for one in studies)
    remarks = [
        *lead(material, studies, found),
        *(rate_idle(run.material) if still else []),
        *read(reads),
        *deformed(material, studies),
        *path_ends(studies),
    ]
    remarks += [remark for one in studies for remark in notes(material, one)]
    if unread:
        remarks.append(Remark(ElementRemark.UNREAD, {"files": ", ".join(unread)}))
    return Examination(
        study.name, study.title, study.command, tuple(remarks), tuple(found),
        parameters(material, run.stress, run.steps, run.start), origins(material), environment,
        drawn(material, list(studies), run.stress),
    )  # fmt: skip


def rate_idle(specification: str) -> list[Remark]:
    """Remark on an objective rate that is asked for, which no path of strains can tell from another."""
    given = [item.removeprefix("rate=") for item in split(specification)[1].split(",") if item.startswith("rate=")]
    return [Remark(ElementRemark.RATE_IDLE, {"rate": rate}) for rate in given]


def read(sources: Sequence[PathSource]) -> list[Remark]:
    """Remarks on what was read of a path's file, and what was not."""
    found = []
    for one in sources:
        used, zero, unused = (", ".join(names) for names in (one.used, one.zero, one.unused))
        found.append(Remark(ElementRemark.PATH_READ, {"file": one.name, "used": used, "largest": one.largest,
                                                      "motion": one.motion}))  # fmt: skip
        if one.stresses:
            found.append(Remark(ElementRemark.PATH_STRESSES, {"columns": ", ".join(one.stresses)}))
        if one.motion == "simple_shear":
            found.append(Remark(ElementRemark.PATH_MOTION, {"file": one.name}))
        if zero:
            found.append(Remark(ElementRemark.PATH_ZERO, {"columns": zero}))
        if unused:
            found.append(Remark(ElementRemark.PATH_UNUSED, {"file": one.name, "columns": unused}))
    return found


def deformed(material: Any, studies: Sequence[ElementStudy]) -> list[Remark]:
    """Remarks on motions that start deformed: their F, and what the stress is there."""
    found = []
    for one in studies:
        if one.test.motion and (one.test.points[0] != UNIT).any():
            F = dict(zip(("xx", "yy", "xy", "zz", "yx"), map(float, one.test.points[0]), strict=True))
            whose = "energy" if material.energy is not None else "start"
            found.append(Remark(ElementRemark.PATH_DEFORMED, {"path": one.test.title, "whose": whose, **F}))
    return found


def path_ends(studies: Sequence[ElementStudy]) -> list[Remark]:
    """Remarks on the stress at the end of each path from a file and motion, or on where it stops."""
    found = []
    for one in studies:
        if one.test.source and one.failed:
            found.append(Remark(ElementRemark.PATH_STOPPED, {"path": one.test.title, **stopped_at(one.failed)}))
        elif one.curve and (one.test.source or one.test.motion):
            sx, sy, sz, xy = (float(one.curve[name][-1]) for name in ("sx", "sy", "sz", "tau"))
            found.append(Remark(ElementRemark.PATH_END, {"path": one.test.title, "xx": -sx, "yy": -sy, "zz": -sz,
                                                         "xy": xy}))  # fmt: skip
    return found


def stopped_at(stopped: Stopped) -> dict[str, float | str]:
    """Cause of an early end, what is left, and where."""
    where = {"left": stopped.left, "step": stopped.step, "steps": stopped.steps, "line": stopped.line}
    return {"cause": stopped.cause, **where}


def lead(material: Any, studies: Sequence[ElementStudy], found: Sequence[Check]) -> list[Remark]:
    """Remarks on what came out: how many checks, which orders, what is exact."""
    missed = sum(check.outcome != "PASS" for check in found)
    counts = {"tests": len(studies), "checks": len(found), "missed": missed}
    told = [Remark(ElementRemark.TESTS if found else ElementRemark.UNJUDGED, counts)]
    flat = sum(max(one.errors) <= ROUND_OFF for one in studies)
    orders = [one.order for one in studies if one.order == one.order]
    if flat:
        told.append(Remark(ElementRemark.EXACT, {"tests": flat}))
    if orders:
        told.append(Remark(ElementRemark.ORDERS, {"least": min(orders), "most": max(orders)}))
        if material.order == 1:
            told.append(Remark(ElementRemark.FIRST_ORDER))
    return told


def notes(material: Any, one: ElementStudy) -> list[Remark]:
    """Remarks on a test: what its errors are held against, what came out, and how much of the path zz stays within."""
    group, stopped = one.test.title, one.failed
    found = []
    if stopped:
        found.append(Remark(ElementRemark.FAILED, stopped_at(stopped), group))
    if one.source:
        found.append(Remark(ElementRemark.AGAINST, {"source": one.source}, group))
    else:
        found.append(Remark(ElementRemark.AGAINST_OWN, {"times": FINE}, group))
    if max(one.errors) <= ROUND_OFF:
        found.append(Remark(ElementRemark.ROUND_OFF, {"largest": max(one.errors)}, group))
    elif np.isnan(one.order):
        found.append(Remark(ElementRemark.NO_ORDER, {}, group))
    else:
        found.append(Remark(ElementRemark.ORDER, {"order": one.order}, group))
    if one.test.motion and material.rate is not None:
        found.append(Remark(ElementRemark.RATE_ACTS, {"rate": label(material.rate), "steps": one.steps[-1]}, group))
    if one.test.axial and material.out_of_plane == "plane":
        found.append(Remark(ElementRemark.PLANE_YIELDS, {}, group))
    outside = beyond(material, one)
    if outside is not None:
        code = ElementRemark.ZZ_OUTSIDE if outside else ElementRemark.ZZ_WITHIN
        found.append(Remark(code, {"fraction": outside}, group))
    return found


def beyond(material: Any, one: ElementStudy) -> float | None:
    """Fraction of the finest run's steps in which zz leaves the plane's range; None of a material that sees zz."""
    if material.name not in PLANE_ALONE or one.test.axial or len(one.curve.get("s", ())) < 2:
        return None
    sigma = np.column_stack([-one.curve["sx"], -one.curve["sy"], -one.curve["sz"], one.curve["tau"]])
    return float(np.mean(PLANE_ALONE[material.name](sigma[1:])))


def parameters(material: Any, stress: float, steps: int, start: str = "isotropic") -> dict[str, float | str]:
    """Parameters of the material and of the tests."""
    own: dict[str, float | str] = dict(asdict(material))
    if start != "isotropic":
        own["stress at the start"] = start
    return own | {
        "confining stress": 0.0 if material.energy is not None else stress,
        "steps of the coarsest run": steps,
    }


def origins(material: Any) -> dict[str, str]:
    """Codes for where a value comes from, and whether it has an effect."""
    found: dict[str, str] = {"steps of the coarsest run": ElementRemark.OR_MORE}
    if material.energy is not None:
        found["confining stress"] = ElementRemark.UNDEFORMED
    if material.name in ORIGINS:
        found |= ORIGINS[material.name](material)
    return found


def of_ubcsand(material: Ubcsand) -> dict[str, str]:
    """Codes for the parameters of UBCSAND."""
    idle = ElementRemark.NO_EFFECT if material.reversal else ElementRemark.NO_EFFECT_PRIMARY
    found: dict[str, str] = {f"hfac{n}": idle for n in range(1, 7)}
    found |= {"Rf": ElementRemark.CORRELATION, "reversal": ElementRemark.OUR_READING}
    if material.reversal:
        found |= dict.fromkeys(("hfac1", "hfac2"), str(ElementRemark.AFTER_REVERSAL))
    return found


# By the name of the material: where its parameters' values come from, and the stresses that it does not judge.
ORIGINS: dict[str, Callable[[Any], dict[str, str]]] = {"ubcsand": of_ubcsand}
PLANE_ALONE: dict[str, Callable[..., Any]] = {"ubcsand": out_of_range}
