"""Rules of the claims on CPDI, MPM, manufactured solutions and norms."""

from collections.abc import Mapping
from math import sqrt
from typing import Any

from mpm_verify.cases.judging.records import Outcome
from mpm_verify.reports.paper.evidence import Evidence, slopes
from mpm_verify.reports.paper.records import DIRECTION, NEARNESS, Answer, NotFinishedError

At = Mapping[str, Any]
USUAL_PPC = 4
SECOND = 1.9  # order from which an error is of second order
ROUND_OFF = 1e-12
NOTHING = 1.05  # gain of an error by more particles that is none


def errors(seen: Evidence, at: At, method: str, ppc: int = USUAL_PPC) -> dict[int, float]:
    """Errors of u by cells, in the norm and over the duration that are read."""
    return seen.errors("figure1", at["norm"], method=method, ppc=ppc, periods=at["periods"])


def second(seen: Evidence, study: str, **fields: Any) -> Answer:
    """Order of u in rms on the finest pair of levels: second or not."""
    orders = slopes(seen.errors(study, **fields))
    if not orders:
        raise NotFinishedError(study)
    return Answer({"second order": orders[-1] > SECOND}, {"order of u": orders[-1]})


def f1(seen: Evidence, at: At) -> Answer:
    """Force at an inner node of a bar of one stress: jumps of points, round-off of domains."""
    found = {}
    for method in ("mpm", "cpdi"):
        found[method] = seen.one("cell_crossing", method=method).values["spurious_force"]
    numbers = {f"force of {name} over stress and area": value for name, value in found.items()}
    return Answer({"points jump": found["mpm"] > 0.1, "domains do not": found["cpdi"] < ROUND_OFF}, numbers)


def f2(seen: Evidence, at: At) -> Answer:
    """Second order where the body turns as it strains, which a transpose of F would take away."""
    return second(seen, "rotation")


def f3(seen: Evidence, at: At) -> Answer:
    """Mass at the nodes is that of the particles, and u is of second order."""
    lost = max(one.values["most_mass_lost"] for one in seen.ended("figure3"))
    found = second(seen, "figure1", method="cpdi", ppc=USUAL_PPC, periods=0.0)
    return Answer({"weights sum to one": lost < ROUND_OFF, **found.parts}, {"mass lost": lost, **found.numbers})


def f4(seen: Evidence, at: At) -> Answer:
    """F by the increments of the velocity gradient: second order of u and F under rotation."""
    found = seen.results("rotation")
    return Answer({"no run fails": all(one.status == "finished" for one in found), **second(seen, "rotation").parts},
                  second(seen, "rotation").numbers)  # fmt: skip


def f5(seen: Evidence, at: At) -> Answer:
    """No verdict of CPDI over one period refutes its order: the body force belongs to the motion."""
    seen.results("figure1", method="cpdi", periods=0.0)
    judged = [one.verdict.outcome for one in seen.record("figure1").analysis.findings
              if one.plan.judged and (one.plan.run.method, one.plan.run.periods) == ("cpdi", 0.0)]  # fmt: skip
    if set(judged) <= {Outcome.ERROR}:
        raise NotFinishedError("figure1")
    passed, failed = judged.count(Outcome.PASS), judged.count(Outcome.FAIL)
    parts = {"second order": passed > 0, "no order is refuted": not failed}
    return Answer(parts, {"verdicts": len(judged), "pass": passed, "fail": failed})


def f7(seen: Evidence, at: At) -> Answer:
    """Printed norm: its order less that of the root mean square, which a norm of the same error would not have."""
    of = {norm: slopes(seen.errors("figure1", norm, method="cpdi", ppc=USUAL_PPC, periods=0.0))
          for norm in ("rms", "printed")}  # fmt: skip
    if not all(of.values()):
        raise NotFinishedError("figure1")
    more = of["printed"][-1] - of["rms"][-1]
    return Answer({"order of the error": abs(more) < 0.1}, {"order in the printed norm": of["printed"][-1],
                  "order in rms": of["rms"][-1], "gained by the norm": more})  # fmt: skip


def f8(seen: Evidence, at: At) -> Answer:
    """Runs with the time step as printed end with an error below u itself; the step over that of 0.4 dx/C."""
    found = seen.results("printed_step")
    usable = sum(one.status == "finished" and one.errors["u"]["rms"] < one.scale["u"] for one in found)
    usual = seen.results("figure1", method="cpdi", ppc=USUAL_PPC, periods=0.0, cells=found[0].run.cells)[0]
    numbers = {"runs": len(found), "that fail": seen.failures("printed_step"), "over 0.4 dx/C": found[0].dt / usual.dt}
    return Answer({"errors below u": usable == len(found)}, numbers)


def f9(seen: Evidence, at: At) -> Answer:
    """MPM has a lower rate than CPDI on the finest cells, and its error falls from each mesh to the next."""
    numbers: dict[str, float] = {}
    parts: dict[str, bool | None] = {}
    lower = []
    for ppc in (1, 4, 9):
        mpm, cpdi = (slopes(errors(seen, at, method, ppc)) for method in ("mpm", "cpdi"))
        if not cpdi:
            raise NotFinishedError("figure1")
        failed = seen.failures("figure1", method="mpm", ppc=ppc, periods=at["periods"])
        lower += [mpm[-1] < cpdi[-1]] if mpm else []
        parts[f"MPM converges, {ppc} per cell"] = not failed and bool(mpm) and min(mpm) > 0
        numbers |= {f"order of MPM, {ppc} per cell, pair {k + 1}": one for k, one in enumerate(mpm)}
        numbers |= {f"order of CPDI, {ppc} per cell": cpdi[-1], f"failed runs of MPM, {ppc} per cell": failed}
    return Answer({DIRECTION: all(lower) if lower else None, **parts}, numbers)


def f10(seen: Evidence, at: At) -> Answer:
    """Error of CPDI below that of MPM and its other relatives on the finest cells that both have."""
    cpdi, mpm = (errors(seen, at, method) for method in ("cpdi", "mpm"))
    both = [cells for cells in cpdi if cells in mpm]
    if not both:
        raise NotFinishedError("figure1")
    finest = max(both)
    return Answer({DIRECTION: cpdi[finest] < mpm[finest]}, {"cells": finest, "error of CPDI": cpdi[finest],
                  "error of MPM": mpm[finest]})  # fmt: skip


def f11(seen: Evidence, at: At) -> Answer:
    """Error of CPDI falls from 1 to 4 and from 4 to 9 per cell on the finest cells; nearly as their number grows."""
    found = [errors(seen, at, "cpdi", ppc) for ppc in (1, 4, 9)]
    both = set.intersection(*(set(one) for one in found))
    if not both:
        raise NotFinishedError("figure1")
    one, four, nine = (each[max(both)] for each in found)
    gains = {"from 1 to 4": one / four, "from 4 to 9": four / nine}
    linear = all(gain > sqrt(more) for gain, more in zip(gains.values(), (4, 9 / 4), strict=True))
    parts = {name: gain > NOTHING for name, gain in gains.items()}
    return Answer({**parts, NEARNESS: linear}, {f"gain {name}": gain for name, gain in gains.items()})


def f12(seen: Evidence, at: At) -> Answer:
    """Second order with the force of the reference position of each particle."""
    return second(seen, "figure1", method="cpdi", ppc=USUAL_PPC, periods=0.0)


def f13(seen: Evidence, at: At) -> Answer:
    """Processor time of a particle update in the column over that of MPM."""
    ticks = {method: seen.ticks("methods", method=method) for method in ("mpm", "cpdi", "bspline2", "bspline3")}
    numbers = {f"time of {name} over MPM's": value / ticks["mpm"] for name, value in ticks.items() if name != "mpm"}
    return Answer({"CPDI costs more": ticks["cpdi"] > ticks["mpm"]}, numbers)


def f14(seen: Evidence, at: At) -> Answer:
    """CPDI2 is of second order; its enrichment at interfaces is not built."""
    found = second(seen, "family", method="cpdi2")
    return Answer({"CPDI2, second order": found.parts["second order"], "enrichment": None}, found.numbers)


RULES = {"F1": f1, "F2": f2, "F3": f3, "F4": f4, "F5": f5, "F7": f7, "F8": f8, "F9": f9, "F10": f10, "F11": f11,
         "F12": f12, "F13": f13, "F14": f14}  # fmt: skip
