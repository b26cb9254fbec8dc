"""One test of somebody else's solver: a case folder is written, the program reads it, its answer is held."""

import time
from collections.abc import Callable

from mpm_verify.cases.exact.others.judge import Answered, judged
from mpm_verify.cases.exact.others.state import asked
from mpm_verify.cases.exact.run import Result, Run
from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.harness.study import Arrays, parameters
from mpm_verify.cases.solvers.asking import ask
from mpm_verify.solver.plugins import MATERIALS, create


def execute(run: Run, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Result, Arrays]:
    """Run the program to its end, or to where it fails: that is a Result too. `tick` hears the fraction of frames."""
    used = time.process_time()
    case = asked(run.test, run.material, run.precision)  # type: ignore[arg-type]
    answer = ask(run, case.exported, case.motion.b, tick)
    held = Answered(case, answer.frames, answer.told, run.flip)
    record = case.exported.record
    result = Result(
        run=run,
        digest=run.digest,
        status="failed" if answer.failure else "finished",
        steps=record.steps,
        particles=record.particles,
        dt=record.dt,
        wall_s=answer.wall_s,
        cpu_s=time.process_time() - used,
        failure=answer.failure,
        values={"rounding": held.rounding} | answer.told.numbers,
        environment=environment(),
        parameters=parameters("material", create(MATERIALS, run.material)),
        tested=() if answer.failure else tuple(judged(run.test, held)),
        log=answer.log.lines,
        exit_code=answer.exit_code,
        told=answer.told.version,
    )
    return result, answer.log.kept
