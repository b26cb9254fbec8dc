"""Execution of one exactness battery."""

import time
from collections.abc import Callable

from mpm_verify.cases.exact.battery import run as battery
from mpm_verify.cases.exact.run import Result, Run
from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.harness.study import Arrays, parameters
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.plugins import MATERIALS, METHODS, create


def execute(run: Run, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Result, Arrays]:
    """Make all tests of a method with a material; a test whose run ends has failed, and the others go on."""
    use_threads(1)
    started, used = time.perf_counter(), time.process_time()
    tested = battery(run.method, run.material)
    tick(1.0)
    result = Result(
        run=run,
        digest=run.digest,
        status="finished",
        wall_s=time.perf_counter() - started,
        cpu_s=time.process_time() - used,
        particles=run.particles,
        environment=environment(),
        parameters=parameters("material", create(MATERIALS, run.material))
        | parameters("method", create(METHODS, run.method)),
        tested=tested,
    )
    return result, {}
