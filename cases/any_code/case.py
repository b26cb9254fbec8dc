"""Numbers of any code, as a table: errors, or values of a quantity, on several cell sizes.

`verify judge FILE` reads the table. Each row is a run that is not computed, since its number is there; so refinements,
replicates, the run with half the time step, verdicts and pages are those of any study.

Without an exact solution the numbers are values f(h) of a quantity. Then the error of a level is Richardson's estimate
|f(h) - f(r h)| / (r^p - 1) from the next coarser level, p the expected order, which is the true error where
f = f0 + C h^p; the coarsest level has none. The order rule judges these, and the grid convergence index of the finest
three levels stands beside (Celik et al. 2008, doi:10.1115/1.2960953).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

from mpm_verify.cases.any_code.run import Result, Run
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.refinement import collect
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study, head
from mpm_verify.cases.judging.richardson import FORMAL, Extrapolation, Index, celik, extrapolate

__all__ = ["Result", "Run"]


@dataclass(frozen=True)
class Extrapolated:
    """Three consecutive levels of a refinement of values, finest first.

    Parameters
    ----------
    method, measured
        Which refinement.
    h, f
        Cell sizes and values (3,).
    index
        By the procedure of Celik et al.
    ours
        By the stricter rule, which names no order for values that go to and fro or that have not settled, and uses the
        expected order where a larger one is observed.
    formal
        The expected order, 2 where none is given.
    """

    method: str
    measured: str
    h: tuple[float, ...]
    f: tuple[float, ...]
    index: Index
    ours: Extrapolation
    formal: float


@dataclass(frozen=True)
class Examined:
    """Analysis beside the verdicts: no checks, and of values what three levels say."""

    checks: tuple[Check, ...] = ()
    extrapolated: tuple[Extrapolated, ...] = ()


def title(runs: Sequence[Run]) -> str:
    """Title of a study of given numbers."""
    return f"Refinement of {', '.join(dict.fromkeys(run.method for run in runs))}"


def check(runs: Sequence[Run]) -> None:
    """Raise ValueError: numbers that are given are no product of axes."""
    raise ValueError("any_code has no runs of its own; numbers of any code are judged by: verify judge FILE")


def examine(study: Study[Run], results: Mapping[str, Result], store: Store | None) -> Examined:
    """Extrapolations of each refinement of values, of the finest three levels first."""
    found: list[Extrapolated] = []
    for series in collect(study.runs):
        if not series.runs or series.first.exact:
            continue
        first, formal = series.first, _formal(study, series.first)
        levels = [(first.coarser_h, first.coarser), *((run.h, run.number) for run in series.runs)][::-1]
        for at in range(len(levels) - 2):
            h, f = zip(*levels[at : at + 3], strict=True)
            if all(map(isfinite, f)):
                three = celik(h, f), extrapolate(h, f, formal)
                found.append(Extrapolated(first.method, first.measured, h, f, *three, formal))
    return Examined(extrapolated=tuple(found))


def _formal(study: Study[Run], run: Run) -> float:
    """Expected order of the refinement of a run."""
    orders = [plan.expectation.order for plan in study.plans if plan.head == head(run) and plan.expectation]
    return orders[0] if orders and orders[0] is not None else FORMAL
