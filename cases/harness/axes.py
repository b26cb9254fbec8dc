"""Axes of a study beside the cells: time step, particles per cell, and positions of the particles in their cells.

Each is refined with the others held, so that each error is seen alone. All from finished runs; a study with one value
on an axis has nothing there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, log, sqrt
from statistics import median
from typing import Any

import numpy as np

from mpm_verify.cases.harness.refinement import Series, collect
from mpm_verify.cases.harness.study import Head, ResultRecord, head, without
from mpm_verify.cases.judging.fit import Fit, slopes
from mpm_verify.solver.failure import Failure, FailureKind

Run = Any  # of any case with refinements
Result = ResultRecord[Any]
Results = Mapping[str, Result]
UNDONE = Failure(FailureKind.NOT_RUN, step=-1)


@dataclass(frozen=True)
class TimeAxis:
    """Errors of one series on its finest cells, the largest time step first; `courants` and `errors` (n,), n > 1."""

    run: Run  # with the largest time step
    courants: tuple[float, ...]
    errors: tuple[float, ...]

    @property
    def orders(self) -> tuple[float | None, ...]:
        """Local order in the time step (n-1,), None where an error is zero. An error of space makes it small."""
        return slopes(self.courants, self.errors)

    @property
    def fractions(self) -> tuple[float, ...]:
        """Fraction of each error that the time step makes, (n,): |e(dt) - e(smallest dt)| / e(dt)."""
        return tuple(abs(e - self.errors[-1]) / e if e else 0.0 for e in self.errors)


@dataclass(frozen=True)
class ParticleAxis:
    """Errors of one method and solution on the same cells, fewest particles first; `ppc` and `errors` (n,), n > 1."""

    run: Run  # with the fewest particles
    ppc: tuple[int, ...]
    errors: tuple[float, ...]

    @property
    def orders(self) -> tuple[float | None, ...]:
        """Local order in the spacing of the particles, dx / sqrt(ppc), (n-1,)."""
        return slopes([1 / sqrt(count) for count in self.ppc], self.errors)


@dataclass(frozen=True)
class PositionAxis:
    """Errors of the replicates of one series; `cells` (n,), `errors` n tuples, the usual position first in each."""

    run: Run  # the coarsest one
    cells: tuple[int, ...]
    errors: tuple[tuple[float, ...], ...]

    @property
    def ends(self) -> tuple[tuple[float, float, float], ...]:
        """Smallest, middle and largest error of each level."""
        return tuple((min(e), median(e), max(e)) for e in self.errors)

    @property
    def alone(self) -> Fit:
        """Fit of the usual positions alone: its interval comes from the residuals."""
        return self._fit([e[:1] for e in self.errors])

    @property
    def together(self) -> Fit:
        """Fit of all replicates: its interval comes from their scatter."""
        return self._fit(self.errors)

    def _fit(self, errors: Sequence[Sequence[float]]) -> Fit:
        return Fit(1 / np.array(self.cells), [np.array(e) for e in errors])


def time_axes(runs: Sequence[Run], results: Results, quantity: str = "u", norm: str = "rms") -> list[TimeAxis]:
    """Time axes, one for each series with two finished time steps or more."""
    found = []
    for series in collect(runs):
        pairs = [(run, e) for run in series.times if (e := error(run, results, quantity, norm)) is not None]
        if len(pairs) > 1:
            found.append(TimeAxis(pairs[0][0], tuple(run.courant for run, _ in pairs), tuple(e for _, e in pairs)))
    return found


def particle_axes(runs: Sequence[Run], results: Results, quantity: str = "u", norm: str = "rms") -> list[ParticleAxis]:
    """Particle axes, one for each method, solution and cell count that finished with two particle counts or more."""
    points: dict[tuple[Head, int], list[tuple[Run, float]]] = {}
    for series in collect(runs):
        for run, errors in zip(series.runs, replicated(series, results, quantity, norm), strict=True):
            if errors:
                points.setdefault((without("ppc", head(run)), run.cells), []).append((run, middle(errors)))
    return [
        ParticleAxis(found[0][0], tuple(run.ppc for run, _ in found), tuple(e for _, e in found))
        for found in points.values()
        if len(found) > 1
    ]


def position_axes(runs: Sequence[Run], results: Results, quantity: str = "u", norm: str = "rms") -> list[PositionAxis]:
    """Position axes, one for each series whose replicates have all finished on some level, with those levels."""
    found = []
    for series in collect(runs):
        levels = zip(series.runs, replicated(series, results, quantity, norm), strict=True)
        whole = [(run, errors) for run, errors in levels if len(errors) > 1]
        if whole:
            found.append(PositionAxis(series.first, tuple(run.cells for run, _ in whole), tuple(e for _, e in whole)))
    return found


def replicated(series: Series, results: Results, quantity: str, norm: str) -> list[tuple[float, ...]]:
    """Errors of each level and its replicates, see `level`."""
    return [level(runs, results, quantity, norm)[0] for runs in series.replicates]


def level(
    runs: Sequence[Run], results: Results, quantity: str, norm: str
) -> tuple[tuple[float, ...], Failure | None, int]:
    """Errors of a run and its replicates; none where one of them is not done or failed, and why, and which one.

    A replicate that cannot take its first step is left out: its domains at the edge are too wide for the method, which
    says nothing of the method where they are not.
    """
    errors = []
    for number, run in enumerate(runs):
        result = results.get(run.digest)
        if number and result and result.failure and result.failure.step == 0:
            continue
        if result is None or result.status == "failed":
            return (), result.failure if result and result.failure else UNDONE, number
        if quantity not in result.errors:  # a table has each quantity in rows of its own
            return (), Failure(FailureKind.NO_ERROR, step=-1), number
        errors.append(result.errors[quantity][norm])
    return tuple(errors), None, 0


def error(run: Run, results: Results, quantity: str, norm: str) -> float | None:
    """Error of a finished run, None where there is none."""
    result = results.get(run.digest)
    return result.errors.get(quantity, {}).get(norm) if result and result.status == "finished" else None


def middle(errors: Sequence[float]) -> float:
    """Geometric mean over replicates, as the order rule takes it; the error itself where there is one."""
    if len(errors) == 1 or min(errors) == 0:
        return sum(errors) / len(errors)
    return exp(sum(map(log, errors)) / len(errors))


def cell_crossings(result: Result | None) -> float | None:
    """Mean number of cell faces that a particle crossed in the whole run; None where the run is not done."""
    if result is None or result.crossings is None or not result.particles:
        return None
    return float(result.crossings / result.particles)
