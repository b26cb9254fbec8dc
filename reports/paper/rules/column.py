"""Rules of the claims on the column's figures 4 to 8: answers of the column's own claims, part by part."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from mpm_verify.cases.column.claims import CLOSE, LITTLE, beyond
from mpm_verify.cases.column.records import Claim, ClaimCode, FinishedRun
from mpm_verify.reports.paper.evidence import Evidence
from mpm_verify.reports.paper.records import DIRECTION, NEARNESS, Answer
from mpm_verify.reports.paper.rules.told import answer, length_of, named, reproduced

At = Mapping[str, Any]
AS_FIGURE = "both"  # smoothing of rates and stresses, as the study of Figure 7 has it


def c8(seen: Evidence, at: At) -> Answer:
    """Front above the experiment's band, for each number of particles."""
    claim = seen.column("figure4", ClaimCode.FRONT_OVER)
    found, measure = answer(at, every=claim), length_of(claim, at)
    over = {named("ppc", one): beyond(one.lengths[measure], claim.known.front) > 0 for one in claim.runs}
    return replace(found, parts=dict(over))


def c9(seen: Evidence, at: At) -> Answer:
    """Height rises with the particles."""
    return answer(at, direction=seen.column("figure4", ClaimCode.HEIGHT_RISES))


def c10(seen: Evidence, at: At) -> Answer:
    """Height below the band with one per cell."""
    return answer(at, direction=seen.column("figure4", ClaimCode.HEIGHT_UNDER_WITH_ONE))


def c11(seen: Evidence, at: At) -> Answer:
    """Height near the band with 9 per cell, and with the most that were run."""
    nine = seen.column("figure4", ClaimCode.HEIGHT_NEAR_WITH_MORE)
    most = seen.column("particles", ClaimCode.HEIGHT_NEAR_WITH_MORE)
    found = answer(at, nine=nine, most=most)
    parts = {named("ppc", claim.runs[0]): reproduced(claim, at) for claim in (nine, most)}
    return replace(found, parts=parts)


def damping(at: At) -> str:
    """Study of Figures 5 and 6 by the kind of damping."""
    return "figure5_objective" if at["damping_kind"] == "objective" else "figure5"


def c13(seen: Evidence, at: At) -> Answer:
    """Front falls with damping, and comes nearer to the band."""
    study = damping(at)
    falls, closer = (seen.column(study, code) for code in (ClaimCode.FRONT_FALLS, ClaimCode.FRONT_CLOSER))
    return answer(at, direction=falls, nearness=closer)


def c15(seen: Evidence, at: At) -> Answer:
    """Potential energy changes by less than can be seen on its figure."""
    return answer(at, nearness=seen.column(damping(at), ClaimCode.POTENTIAL_KEPT))


def c16(seen: Evidence, at: At) -> Answer:
    """Kinetic energy changes markedly of its own peak, and by what can be seen beside the potential energy."""
    claim = seen.column(damping(at), ClaimCode.KINETIC_CHANGED)
    beside = seen.column(damping(at), ClaimCode.POTENTIAL_KEPT).numbers["kinetic"]
    found = answer(at, of_its_own_peak=claim)
    return replace(found, parts={**found.parts, "beside the potential energy": beside > LITTLE},
                   numbers={**found.numbers, "kinetic over potential at first": beside})  # fmt: skip


def variant(at: At) -> tuple[str, Callable[[FinishedRun], bool]]:
    """Study and runs of a variant of smoothing: that of the figure, or one of those that it leaves open."""
    chosen = str(at["smoothing"])
    if chosen == AS_FIGURE:
        return "figure7", lambda one: True
    return "smoothing", lambda one: one.run.smoothing == "none" or one.run.smoothing.endswith(f":{chosen}")


def smoothed(seen: Evidence, at: At, code: ClaimCode) -> Claim:
    """Claim on smoothing, of the variant that is read."""
    study, among = variant(at)
    return seen.column(study, code, among)


def c18(seen: Evidence, at: At) -> Answer:
    """Front and height above the bands with volumetric smoothing, and the front because of it."""
    front, height = (smoothed(seen, at, code) for code in (ClaimCode.VOLUMETRIC_FRONT, ClaimCode.VOLUMETRIC_HEIGHT))
    found, measure = answer(at, front=front, height=height), length_of(front, at)
    one, plain = (run.lengths[measure] for run in front.runs)
    return replace(found, parts={**found.parts, "front further than without": one > plain})


def c19(seen: Evidence, at: At) -> Answer:
    """Front nearer to the band with deviatoric smoothing."""
    return answer(at, nearness=smoothed(seen, at, ClaimCode.DEVIATORIC_FRONT))


def c20(seen: Evidence, at: At) -> Answer:
    """Fraction of particles outside the strength with each smoothing. No test of locking."""
    ran = seen.columns("figure7")
    numbers = {f"outside the strength, {one.run.smoothing}": one.values["outside"] for one in ran}
    numbers |= {f"lost in transfers, {one.run.smoothing}": one.values["lost"] for one in ran}
    return Answer({"locking": None}, numbers)


def u3(seen: Evidence, at: At) -> Answer:
    """UBCSAND as the experiment until 0.17 s: no curve is at hand; how far the two models are apart by then."""
    early = seen.column("figure8", ClaimCode.SAND_EARLY)
    late = seen.column("figure8", ClaimCode.SAND_LATE)
    return Answer({NEARNESS: early.reproduced}, {"apart until 0.17 s [m]": late.numbers["early"]})


def u4(seen: Evidence, at: At) -> Answer:
    """UBCSAND nearer to Mohr-Coulomb later than before 0.17 s."""
    return answer(at, nearness=seen.column("figure8", ClaimCode.SAND_LATE))


def u5(seen: Evidence, at: At) -> Answer:
    """Both fronts near the band."""
    return answer(at, nearness=seen.column("figure8", ClaimCode.BOTH_NEAR))


def u6(seen: Evidence, at: At) -> Answer:
    """UBCSAND runs out less, by little."""
    claim = seen.column("figure8", ClaimCode.MATERIALS_CLOSE)
    found, measure = answer(at, nearness=claim), length_of(claim, at)
    sand, plain = (run.lengths[measure] for run in claim.runs)
    apart = sand / plain - 1
    return replace(found, parts={DIRECTION: apart < 0, NEARNESS: abs(apart) <= CLOSE},
                   numbers={**found.numbers, "apart": apart})  # fmt: skip


RULES = {"C8": c8, "C9": c9, "C10": c10, "C11": c11, "C13": c13, "C15": c15, "C16": c16, "C18": c18, "C19": c19,
         "C20": c20, "U3": u3, "U4": u4, "U5": u5, "U6": u6}  # fmt: skip
