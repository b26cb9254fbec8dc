"""Execution of one benchmark: the problem is set up, run until it is at its end, and measured."""

from collections.abc import Callable

from mpm_verify.cases.benchmark.problem import FIGURE, Measured
from mpm_verify.cases.benchmark.run import Result, Run
from mpm_verify.cases.harness.progress import Progress
from mpm_verify.cases.harness.stopwatch import Stopwatch
from mpm_verify.cases.harness.study import Arrays, parameters
from mpm_verify.solver.failure import Failure, RunFailed
from mpm_verify.solver.step import advance, check_time_step


def execute(run: Run, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Result, Arrays]:
    """Run to the end, or to where it cannot go on: a failed run is a Result. Arrays: the curves of its figures."""
    stopwatch = Stopwatch()
    problem = run.stated
    setup = problem.setup(run)
    model, watch = setup.model, setup.watch
    model.watch(watch, Progress(tick, setup.steps))
    failure: Failure | None = None
    found = Measured()
    try:
        check_time_step(model)
        while model.steps < setup.steps and not watch.done:
            advance(model, setup.load)
        found = watch.found(model)
    except RunFailed as ended:
        failure = ended.failure
    result = Result(
        run=run,
        digest=run.digest,
        status="failed" if failure else "finished",
        errors=found.errors,
        values=found.values,
        scale=found.scale,
        floor=found.floor,
        steps=model.steps,
        particles=len(model.particles),
        dt=model.dt,
        crossings=model.crossings,
        failure=failure,
        parameters=parameters("problem", problem)
        | parameters("material", model.material)
        | parameters("method", model.basis),
        **stopwatch.told(),
    )
    curves = {f"{FIGURE}{name}/{curve}": rows for (name, curve), rows in found.curves.items()}
    return result, curves
