"""Checks of a study: invariants that hold of a column whatever the experiment says, where its method can hold them.

Each invariant is checked for the run that is worst in it. Two are known not to hold the work of their forces: classical
MPM, whose gradients of weights jump where a particle crosses a cell, and CPDI with domains that may be longer than 0.7
cells by half a diagonal, whose weights change by much in a step. The work of the stress on the strain that particles
see is then another than that of the forces at the nodes, by 3 % of the energy there is with domains of a cell, and by
more than all of it without a limit or with classical MPM. Smoothing of rates or stresses alone, through nodes, or by
F-bar is not asked either: strain and stress are then not smoothed by one projector. The sum of the strains of pooled
sand is held where moduli are constant: UBCSAND's own steps miss it where sand has just touched, by up to 7 % on random
paths. What is not asked is told. How many runs come to rest, the study declares.
"""

from collections.abc import Sequence
from math import inf, nan, sqrt
from typing import Any

from mpm_verify.cases.column.claims import values
from mpm_verify.cases.column.records import FinishedRun
from mpm_verify.cases.column.run import ColumnRun, ColumnStudy
from mpm_verify.cases.harness.checks import Check, Way
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, create, load, split

OVER = "over the initial potential energy"
BUDGET, DRIFT, BACK = 0.01, 1e-9, 1e-3  # of a work that is approximate, and of sums that are exact
MASS, STABLE = 1e-12, 0.95
BOOKS, AREA = 1e-3, 0.03  # of strains whose sum is of third order in the step; of a surface of 99 % of the mass
LONG = 0.7  # cells, half diagonal of a domain


def checks(study: ColumnStudy, ran: Sequence[FinishedRun]) -> list[Check]:
    """Checks of the runs that came to their end."""
    smooth = [one for one in ran if holds_work(one.run)]
    pooled = [one for one in ran if one.run.pooling]
    linear = [one for one in pooled if plugin(MATERIALS, one.run.material).stored_energy]
    asked: list[tuple[str, Sequence[FinishedRun], list[float], float, str]] = [
        (f"energy budget, largest residual {OVER}", ran, [one.values["unbalanced"] for one in ran], DRIFT,
         "sum of terms measured apart"),
        (f"work of the material less that of its forces, {OVER}", smooth, [one.values["misworked"] for one in smooth],
         BUDGET, "virtual work"),
        (f"plastic work, largest fall {OVER}", smooth, [one.values["plastic_falls"] for one in smooth], BACK,
         "dissipation"),
        ("momentum less that given by gravity, walls and damping, over m sqrt(2 g h)", ran,
         [missing(one) for one in ran], DRIFT, "conservation"),
        (f"elastic energy that pooling gives, {OVER}", pooled, [-one.values["pooled"] / energy(one) for one in pooled],
         DRIFT, "convexity"),
        ("ln J less dilation, void and elastic strain, mean", linear, [abs(one.values["unbooked"]) for one in linear],
         BOOKS, "sum of strains"),
        ("area over volume ratio / crowding, less 1", pooled, [abs(one.values["booked"] - 1) for one in pooled], AREA,
         "volume of the heap, measured twice"),
        ("mass at the nodes over that of the particles, less 1", ran, [one.values["most_mass_lost"] for one in ran],
         MASS, "partition of unity"),
        ("Courant number with the stiffness and speed of the moment", ran, [one.values["most_courant"] for one in ran],
         STABLE, "stability of the step"),
    ]  # fmt: skip
    rested = sum(one.values["rest"] < inf for one in ran)
    found = [Check("Runs", f"runs at rest out of {len(study.runs)}", float(rested) if ran else nan, float(study.finish),
                   "at_least", "declared by the study")]  # fmt: skip
    way: Way = "at_most"
    for name, runs, numbers, bound, source in asked:
        if runs:
            worst = max(range(len(runs)), key=lambda k: numbers[k])
            found.append(Check("Invariants", name + named(study, runs[worst].run), numbers[worst], bound, way, source))
    return found


def holds_work(run: ColumnRun) -> bool:
    """Whether the work of the forces of a run must be that of its stress."""
    basis = plugin(METHODS, run.method)
    long = basis.has_limit and run.limit > LONG
    adjoint = run.smoothing == "none" or create(SMOOTHINGS, run.smoothing).adjoint
    return not basis.gradients_jump and not long and adjoint


def plugin(package: str, specification: str) -> Any:
    """Class of a plug-in, without its parameters."""
    return load(package, split(specification)[0])


def energy(one: FinishedRun) -> float:
    """Initial potential energy."""
    return one.values["mass"] * one.run.g * one.run.height / 2


def named(study: ColumnStudy, run: ColumnRun) -> str:
    """Name of a run by what the study varies; empty where there is one."""
    if len(study.runs) < 2 or not study.axes:
        return ""
    return f" ({', '.join(f'{axis}={value}' for axis, value in values(run, study.axes).items())})"


def missing(one: FinishedRun) -> float:
    """Momentum that no force accounts for, over m sqrt(2 g h)."""
    return one.values["most_momentum_lost"] / one.values["mass"] / sqrt(2 * one.run.g * one.run.height)
