"""One row of a table as a Result: its error as it stands there, or Richardson's estimate of it from two values."""

from collections.abc import Callable
from math import isfinite

from mpm_verify.cases.any_code.run import NORM, Result, Run
from mpm_verify.cases.harness.study import Arrays
from mpm_verify.solver.failure import Failure, FailureKind


def execute(run: Run, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Result, Arrays]:
    """Result of a row; a number that is not finite is a failed run. There are no arrays."""
    error = run.number if run.exact else estimate(run)
    kind = FailureKind.OSCILLATES if run.turns else FailureKind.ERROR_NOT_FINITE
    failed = run.turns or not isfinite(error)
    result = Result(
        run=run,
        digest=run.digest,
        status="failed" if failed else "finished",
        errors={} if failed else {run.measured: {NORM: error}},
        values={} if run.exact else {run.measured: run.number, "coarser": run.coarser},
        floor={run.measured: run.floor},
        failure=Failure(kind, step=-1) if failed else None,
    )
    return result, {}


def estimate(run: Run) -> float:
    """Error C h^p of a value f(h) = f0 + C h^p from the next coarser level, |f - f_coarser| / (r^p - 1).

    The order p is the one that is expected: where the observed order is another one and the ratio r of all levels is
    the same, each estimate is wrong by one factor, and their order is the observed one all the same.
    """
    ratio: float = run.coarser_h * run.cells
    factor: float = ratio**run.order - 1
    return abs(run.number - run.coarser) / factor
