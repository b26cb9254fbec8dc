"""Rules of the claims on the column's set-up, mesh, particles, aspect, energies and methods."""

from collections.abc import Mapping
from math import inf
from typing import Any

from mpm_verify.cases.column.claims import SCATTER, beyond
from mpm_verify.cases.column.experiment import experiment
from mpm_verify.cases.column.records import FinishedRun
from mpm_verify.reports.paper.evidence import Evidence, slopes
from mpm_verify.reports.paper.records import DIRECTION, NEARNESS, Answer, NotFinishedError
from mpm_verify.reports.paper.rules.told import crowded, value_of

At = Mapping[str, Any]
PRINTED = {"width": 0.0905, "aspect": 7.0}  # Table 1: 9.05 by 63.35 cm
PRINTED_MATERIAL = {"E": 840e3, "nu": 0.3, "phi": 31.0, "psi": 1.0, "rho0": 2650.0}
LOOSEST, DENSEST = 1300.0, 2000.0  # kg/m3 of a dry sand with its pores
PRINTED_CELLS = 135  # of the width, of 0.67 mm
TALL = 2.0  # aspect from which the paper's source has columns run too far
SAVED, LOST = 1.8, 1.0  # orders of an undamped and of a damped manufactured solution


def alone(seen: Evidence, study: str) -> FinishedRun:
    """The one run of a study, finished. Raises NotFinishedError."""
    return seen.ended(study)[0]


def c2(seen: Evidence, at: At) -> Answer:
    """Parameters of Table 1 are those of the run; the density is one of a sand with its pores."""
    run, parameters = alone(seen, "figure3").run, seen.results("figure3")[0].parameters
    own = {name: float(parameters[name]) for name in PRINTED_MATERIAL}
    same = own == PRINTED_MATERIAL and all(getattr(run, name) == value for name, value in PRINTED.items())
    return Answer(
        {"as printed": same, "density of a sand": LOOSEST <= own["rho0"] <= DENSEST},
        {"E over density, gravity and height": own["E"] / (own["rho0"] * run.g * run.height)},
    )


def c3(seen: Evidence, at: At) -> Answer:
    """Cells of 0.67 mm: the finest mesh that is stored."""
    most = max(one.run.cells for one in seen.ended("mesh"))
    return Answer({"run": True if most >= PRINTED_CELLS else None}, {"finest cell, mm": 1e3 * PRINTED["width"] / most})


def depends(seen: Evidence, study: str, axis: str, at: At) -> Answer:
    """Fronts along an axis differ by more than they owe to where particles lie in their cells."""
    ran = seen.columns(study)
    if len(ran) < 2:
        raise NotFinishedError(study)
    fronts = {value_of(axis, getattr(one.run, axis)): one.values[at["front"]] for one in ran}
    spread = max(fronts.values()) / min(fronts.values()) - 1
    numbers = {f"{at['front']}, {name} [m]": value for name, value in fronts.items()} | {"spread": spread}
    return Answer({DIRECTION: spread > SCATTER}, numbers, crowded(axis, ran))


def c4(seen: Evidence, at: At) -> Answer:
    """Run-out depends on the mesh."""
    return depends(seen, "mesh", "cells", at)


def c5(seen: Evidence, at: At) -> Answer:
    """Run-out depends on the particles."""
    return depends(seen, "particles", "ppc", at)


def c6(seen: Evidence, at: At) -> Answer:
    """The set-up runs to rest."""
    rest = alone(seen, "figure3").values["rest"]
    return Answer({"comes to rest": rest < inf}, {"at rest from [s]": rest} if rest < inf else {})


def c7(seen: Evidence, at: At) -> Answer:
    """Nothing slips on the floor."""
    return Answer({"nothing slips": alone(seen, "figure3").run.floor == "fixed"})


def c12(seen: Evidence, at: At) -> Answer:
    """Undamped columns run too far: the more the taller, and above the band from an aspect of 2 on."""
    excess = {}
    for one in sorted(seen.columns("aspect"), key=lambda one: one.run.aspect):
        if known := experiment(one.run):
            excess[one.run.aspect] = (one.values[at["front"]] / known.front[1] - 1, beyond(one.values[at["front"]],
                                                                                            known.front))  # fmt: skip
    if len(excess) < 2:
        raise NotFinishedError("aspect")
    ends = list(excess.values())
    over = all(away > 0 for aspect, (_, away) in excess.items() if aspect > TALL)
    numbers = {f"over the band, aspect {aspect:g}": value for aspect, (value, _) in excess.items()}
    return Answer({DIRECTION: ends[-1][0] > ends[0][0], NEARNESS: over}, numbers)


def c14(seen: Evidence, at: At) -> Answer:
    """Damping changes the run-out by more than scatter, and takes the order of a manufactured solution away."""
    study = "figure5_objective" if at["damping_kind"] == "objective" else "figure5"
    ran = {one.run.damping: one.values[at["front"]] for one in seen.columns(study)}
    plain, damped = (slopes(seen.errors("damped", damping=value)) for value in (0.0, 0.05))
    if not (plain and damped) or not {0.0, 0.05} <= ran.keys():
        raise NotFinishedError("damped")
    change = ran[0.05] / ran[0.0] - 1
    parts = {"run-out": abs(change) > SCATTER, "order of u": plain[-1] > SAVED and damped[-1] < LOST}
    return Answer(parts, {"change of the front at 5 %": change, "order without": plain[-1], "order at 5 %": damped[-1]})


def c17(seen: Evidence, at: At) -> Answer:
    """Friction takes most of the energy; the largest kinetic energy is as much."""
    one = alone(seen, "figure3")
    if not one.curves:
        raise NotFinishedError("figure3")
    first = float(one.curves["potential"][0])
    plastic, kinetic = one.values["plastic"] / first, float(one.curves["on_grid"].max()) / first
    numbers = {"plastic work": plastic, "largest kinetic energy": kinetic, "potential at the end":
               one.values["potential"] / first, "lost in transfers": one.values["lost"]}  # fmt: skip
    return Answer({"friction takes most": plastic > 0.5, "seen in kinetic energy": kinetic >= plastic}, numbers)


def z1(seen: Evidence, at: At) -> Answer:
    """CPDI more accurate than MPM against the manufactured solution, and apart from its relatives in the column."""
    errors = {name: seen.errors("figure1", method=name, periods=at["periods"], ppc=4) for name in ("cpdi", "mpm")}
    both = [cells for cells in errors["cpdi"] if cells in errors["mpm"]]
    if not both:
        raise NotFinishedError("figure1")
    finest = max(both)
    ran = {one.run.method: one for one in seen.columns("methods")}
    if "cpdi" not in ran or len(ran) < 2:
        raise NotFinishedError("methods")
    fronts = {name: one.values[at["front"]] for name, one in ran.items()}
    others = [value for name, value in fronts.items() if name not in ("cpdi", "mpm")]
    known = experiment(ran["cpdi"].run)
    near = {name: abs(beyond(value, known.front)) if known else inf for name, value in fronts.items()}
    best = all(near["cpdi"] < away for name, away in near.items() if name != "cpdi")
    numbers = {f"{at['front']}, {name} [m]": value for name, value in fronts.items()}
    numbers |= {"error of MPM over CPDI's": errors["mpm"][finest] / errors["cpdi"][finest]}
    return Answer({"manufactured solution": errors["cpdi"][finest] < errors["mpm"][finest],
                   "column, nearest to the band": best if others else None}, numbers)  # fmt: skip


RULES = {"C2": c2, "C3": c3, "C4": c4, "C5": c5, "C6": c6, "C7": c7, "C12": c12, "C14": c14, "C17": c17, "Z1": z1}
