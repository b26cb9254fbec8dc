"""Execution of one CPDI run of the study of frame indifference."""

from collections.abc import Callable

from mpm_verify.cases.harness.stopwatch import Stopwatch
from mpm_verify.cases.harness.study import Arrays, parameters
from mpm_verify.cases.objectivity.axes import Block
from mpm_verify.cases.objectivity.block import numbers
from mpm_verify.cases.objectivity.result import ObjectivityResult
from mpm_verify.cases.objectivity.turning_block import execute as turn


def execute(run: Block, tick: Callable[[float], None] = lambda fraction: None) -> tuple[ObjectivityResult, Arrays]:
    """Run the block to its end, or to where it cannot go on."""
    stopwatch = Stopwatch()
    curves, failure = turn(run, tick)
    result = ObjectivityResult(
        run=run, digest=run.digest, status="failed" if failure else "finished", failure=failure,
        values={} if failure else numbers(run, curves["mean"]), steps=2 * run.steps, particles=run.particles,
        dt=1 / run.steps, parameters=parameters("material", run.material), **stopwatch.told(),
    )  # fmt: skip
    return result, {f"{name}/{key}": values for name, curve in curves.items() for key, values in curve.items()}
