"""The runs of a study in order: each refinement in space, its replicates, and its runs with smaller time steps."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mpm_verify.cases.harness.study import Run
from mpm_verify.solver.layout import CENTRED

Head = tuple[str, str, int]  # method, solution, particles per cell


@dataclass(frozen=True)
class Series:
    """The refinement of one method, solution and particle count at the Courant number of the study, coarse to fine.

    `runs` have the particles at their usual places. `replicates` holds, for each of them, that run and those with the
    particles elsewhere in their cells; `times` the finest one and those with smaller time steps, largest first.
    """

    runs: tuple[Run, ...]
    replicates: tuple[tuple[Run, ...], ...] = ()
    times: tuple[Run, ...] = ()

    @property
    def first(self) -> Run:
        """The coarsest run; it names the method, solution and particle count of all."""
        return self.runs[0]

    @property
    def head(self) -> Head:
        """Method, solution and particle count."""
        return head(self.first)

    @property
    def halved(self) -> Run | None:
        """The finest run with half the time step, if the study has it."""
        half = replace(self.runs[-1], courant=self.runs[-1].courant / 2)
        return half if half in self.times else None


def head(run: Run) -> Head:
    """What names the series of a run."""
    return run.method, run.solution, run.ppc


def collect(runs: Sequence[Run]) -> list[Series]:
    """Every series: by solution, methods in the order of the study, fewest particles first.

    Of a study with several layouts, those of the first one.
    """
    runs = [run for run in runs if run.layout == runs[0].layout]
    mine: dict[Head, list[Run]] = {}
    for run in runs:
        mine.setdefault(head(run), []).append(run)
    places = {method: i for i, method in enumerate(dict.fromkeys(run.method for run in runs))}
    ordered = sorted(mine, key=lambda head: (head[1], places[head[0]], head[2]))
    return [_series(mine[head]) for head in ordered]


def _series(runs: Sequence[Run]) -> Series:
    """The largest Courant number is that of the refinement in space; the others are of the finest cells."""
    courant = max(run.courant for run in runs)
    usual = [run for run in runs if run.offset == CENTRED]
    refined = sorted((run for run in usual if run.courant == courant), key=lambda run: run.cells)
    shifted = [run for run in runs if run.offset != CENTRED and run.courant == courant]
    replicates = tuple((run, *(r for r in shifted if r.cells == run.cells)) for run in refined)
    times = [run for run in usual if refined and run.cells == refined[-1].cells]
    return Series(tuple(refined), replicates, tuple(sorted(times, key=lambda run: -run.courant)))
