"""Runs of a study in order: each refinement in space, its replicates, and its runs with smaller time steps.

A refinement is of all fields of a Run but the cells, the time step and the positions of the particles in their cells;
these three are refined apart from each other. A case has refinements if its Run has all three fields.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from mpm_verify.cases.harness.study import REFINED, Head, QuantityPlan, RunRecord, head
from mpm_verify.solver.layout import CENTRED, Offset

Run = Any  # of any case with refinements: cells, courant and offset are its fields
MOST = 64  # replicates


@dataclass(frozen=True)
class Series:
    """One refinement at the Courant number of the study, coarse to fine.

    `runs` have the particles at their usual positions. `replicates` holds, for each of them, that run and those with
    the particles elsewhere in their cells; `times` the finest one and those with smaller time steps, largest first.
    """

    runs: tuple[Run, ...]
    replicates: tuple[tuple[Run, ...], ...] = ()
    times: tuple[Run, ...] = ()

    @property
    def first(self) -> Run:
        """The coarsest run; it names the method, particle count and all else that the runs share."""
        return self.runs[0]

    @property
    def head(self) -> Head:
        """All fields that the runs of the refinement share."""
        return head(self.first)

    @property
    def halved(self) -> Run | None:
        """The finest run with half the time step, if the study has it; itself where none is to be halved."""
        finest = self.runs[-1]
        if finest.tied:
            return finest
        half = replace(finest, courant=finest.courant / 2)
        return next((run for run in self.times if run == half), None)


def refines(run: type[RunRecord]) -> bool:
    """Whether runs of this class can be those of a refinement."""
    return set(REFINED) <= {item.name for item in fields(run)}


def collect(runs: Sequence[Run]) -> list[Series]:
    """Every refinement: by solution where there are several, methods in the order of the study, fewest particles first.

    Of two that differ in anything else, the one that the study has first comes first.
    """
    mine: dict[Head, list[Run]] = {}
    for run in runs:
        mine.setdefault(head(run), []).append(run)
    methods = {name: i for i, name in enumerate(dict.fromkeys(getattr(run, "method", "") for run in runs))}

    def rank(name: Head) -> tuple[str, int, int]:
        known = dict(name)
        return str(known.get("solution", "")), methods[known.get("method", "")], int(known.get("ppc", 0))

    return [_series(mine[name]) for name in sorted(mine, key=rank)]


def usual_offset(runs: Sequence[Run]) -> Offset:
    """Position of the particles of a refinement: in the middle, unless all lie elsewhere in their cells."""
    return CENTRED if any(run.offset == CENTRED for run in runs) else runs[0].offset


def _series(runs: Sequence[Run]) -> Series:
    """The largest Courant number is that of the refinement in space; the others are of the finest cells."""
    courant, at = max(run.courant for run in runs), usual_offset(runs)
    usual = [run for run in runs if run.offset == at]
    refined = sorted((run for run in usual if run.courant == courant), key=lambda run: run.cells)
    shifted = [run for run in runs if run.offset != at and run.courant == courant]
    replicates = tuple((run, *(r for r in shifted if r.cells == run.cells)) for run in refined)
    times = [run for run in usual if refined and run.cells == refined[-1].cells]
    return Series(tuple(refined), replicates, tuple(sorted(times, key=lambda run: -run.courant)))


def complete(
    runs: Sequence[Run], plans: Sequence[QuantityPlan[Any]], times: Sequence[float], replicates: int
) -> tuple[Run, ...]:
    """Runs of a table of cells, and those that its judgement needs.

    These are half the time step on the finest cells where an order is judged, the smaller Courant numbers `times`
    there, and `replicates` of each point.
    """
    largest: dict[Head, int] = {}
    for run in runs:
        largest[head(run)] = max(run.cells, largest.get(head(run), 0))
    finest = [run for run in runs if run.cells == largest[head(run)]]
    asked = {plan.head for plan in plans if plan.judged and plan.expectation and plan.expectation.order is not None}
    halved = [replace(run, courant=run.courant / 2) for run in finest if head(run) in asked and not run.tied]
    timed = [replace(run, courant=courant) for run in finest for courant in sorted(set(times), reverse=True)]
    shifted = elsewhere(runs, replicates)
    return tuple(dict.fromkeys([*runs, *halved, *timed, *shifted]))


def elsewhere(runs: Sequence[Run], replicates: int) -> list[Run]:
    """Runs with the particles elsewhere in their cells, replicates - 1 of each."""
    return [replace(run, offset=offset) for run in runs for offset in offsets(replicates)[1:]]


def offsets(replicates: int) -> list[Offset]:
    """Positions of the particles of each replicate: fractions of their spacing in (-1/2, 1/2), the usual one first.

    The others are the Halton sequence (Halton 1960, doi:10.1007/BF01386213), without its zero: it covers the square
    evenly, and more replicates keep the positions of fewer, so that stored runs serve again.
    Raises ValueError for a number of replicates that is not from 1 to MOST.
    """
    if not 1 <= replicates <= MOST:
        raise ValueError(f"replicates = {replicates} cannot be run; choose whole numbers from 1 to {MOST}")
    if replicates == 1:
        return [CENTRED]
    from scipy.stats.qmc import Halton  # slow to import

    points = Halton(2, scramble=False).random(replicates)[1:] - 0.5
    return [CENTRED, *((float(a), float(b)) for a, b in points)]
