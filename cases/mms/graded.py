"""Uniform layouts against graded ones: the study, and the cost at which each layout reaches an error.

Three ways to spread particles, on the same grids: `uniform`; `graded`, the same number of them moved to where strain is
expected; `thinned`, the same packing there and fewer elsewhere. The claim to test (Moormann, Giridharan & Stolle 2022,
end of section 2.1) is that the same error needs fewer particles.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import exp, log
from typing import Any

from mpm_verify.cases.harness.build import Asked, union
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.mms.run import Result, Run
from mpm_verify.solver.plugins import label

Results = Mapping[str, Result]
Point = tuple[float, float]  # cost, error


@dataclass(frozen=True)
class Plan:
    """Request for a study of layouts. `ppc` are those of the uniform layouts; graded ones need packed cells."""

    methods: tuple[str, ...] = ("cpdi", "gimp", "mpm")
    solutions: tuple[str, ...] = ("localised", "axis_aligned")
    cells: tuple[int, ...] = (16, 32, 64)
    ppc: tuple[int, ...] = (1, 4, 9)
    contrast: float = 2.0
    power: float = 0.25


def build_graded(plan: Plan, command: str, name: str) -> Study[Any]:
    """Build the Study; nothing in it is judged. Raises ValueError, see Sweep.check and mms.grading.Grading.

    A contrast leaves ppc / contrast^2 particles in a cell where there is no strain: counts with less than one are not
    graded.
    """
    dense = tuple(count for count in plan.ppc if count >= plan.contrast**2)
    if not dense:
        raise ValueError(f"a contrast of {plan.contrast:g} needs {plan.contrast**2:g} particles per cell or more")
    spread = [f"{kind}:contrast={plan.contrast},power={plan.power}" for kind in ("graded", "thinned")]
    parts = [
        Asked("mms", {"method": plan.methods, "solution": (solution,), "cells": plan.cells, "ppc": ppc,
                      "layout": (layout,)})
        for solution in plan.solutions
        for layout, ppc in (("uniform", plan.ppc), *((layout, dense) for layout in spread))
    ]  # fmt: skip
    title = f"Uniform and graded layouts of particles on {' and '.join(map(label, plan.solutions))}"
    study = union(parts, command, name, title)
    runs = tuple(run for run in study.runs if run.courant == Run.courant)
    return replace(study, runs=runs, plans=tuple(replace(one, judged=False) for one in study.plans))


def kind(run: Run) -> str:
    """Kind of the layout: uniform, graded or thinned."""
    return run.layout.partition(":")[0]


@dataclass(frozen=True)
class Bounded:
    """Factor, or where the study does not reach far enough a bound of it: `at_least`, `at_most`."""

    value: float
    bound: str = ""


@dataclass(frozen=True)
class Saving:
    """Saving of a run that is not uniform, beside the uniform ones.

    `particles` and `errors`: its own over those of the uniform run with the same `ppc` on the same grid, None where
    that one failed. `same_grid`: particles of a uniform layout with its error on its grid, over its own. `any_grid`:
    particle updates of the cheapest uniform run with its error, of any grid and count, over its own; None if there is
    none.
    """

    result: Result
    error: float
    particles: float | None
    errors: float | None
    same_grid: Bounded | None
    any_grid: float | None


def savings(runs: Sequence[Run], results: Results, quantity: str = "u") -> list[Saving]:
    """Savings, one for each finished run with a layout that is not uniform, in the order of the runs."""
    done = [(run, results[run.digest]) for run in runs if run.digest in results]
    return [
        saving(result, runs, results, quantity)
        for run, result in done
        if kind(run) != "uniform" and result.status == "finished"
    ]


def saving(result: Result, runs: Sequence[Run], results: Results, quantity: str) -> Saving:
    """Saving of one finished run."""
    run, error = result.run, result.errors[quantity]["rms"]
    every = uniform(run, runs, results, quantity)
    here = [(r, e) for r, e in every if r.run.cells == run.cells]
    twin = next(((r, e) for r, e in here if r.run.ppc == run.ppc), None)
    cheapest = least_updates(error, every)
    return Saving(
        result,
        error,
        result.particles / twin[0].particles if twin else None,
        error / twin[1] if twin and twin[1] > 0 else None,
        factor(error, result.particles, [(float(r.particles), e) for r, e in here]),
        None if cheapest is None else cheapest / result.updates,
    )


def uniform(run: Run, runs: Sequence[Run], results: Results, quantity: str) -> list[tuple[Result, float]]:
    """Finished uniform runs of the run's method and solution, and their errors."""
    mine = [r for r in runs if (r.method, r.solution, kind(r)) == (run.method, run.solution, "uniform")]
    done = [results[r.digest] for r in mine if r.digest in results]
    return [(result, result.errors[quantity]["rms"]) for result in done if result.status == "finished"]


def least_updates(error: float, every: Sequence[tuple[Result, float]]) -> float | None:
    """Least particle updates at which a refinement with some uniform count passes the error."""
    lines = [[(r.updates, e) for r, e in every if r.run.ppc == ppc] for ppc in {r.run.ppc for r, _ in every}]
    return min((cost for line in lines if (cost := cost_of(error, line)) is not None), default=None)


def factor(error: float, mine: float, points: Sequence[Point]) -> Bounded | None:
    """Cost at which the points reach the error, over `mine`; a bound where all of them are above it, or all below."""
    if not points:
        return None
    cost = cost_of(error, points)
    if cost is not None:
        return Bounded(cost / mine)
    if error < min(e for _, e in points):
        return Bounded(max(c for c, _ in points) / mine, "at_least")
    return Bounded(min(c for c, e in points if e <= error) / mine, "at_most")


def cost_of(error: float, points: Sequence[Point]) -> float | None:
    """Least cost at which the line through the points, straight in logarithms, comes down to the error; None if never.

    A line that begins below the error says nothing of what is cheaper than its first point.
    """
    for (c0, e0), (c1, e1) in pairwise(sorted(points)):
        if e1 <= error <= e0 and e1 < e0:
            return c0 * exp(log(c1 / c0) * log(e0 / error) / log(e0 / e1))
    return None
