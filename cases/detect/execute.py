"""Plant one defect in a copy of the package, and ask the checks of it there."""

import time
from collections.abc import Callable

from mpm_verify.cases.detect.defect import NONE, defects
from mpm_verify.cases.detect.run import CHECKS, Result, Run, asked, one
from mpm_verify.cases.detect.workshop import warmed, workshop
from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.harness.study import Arrays

ENDS = {"crash": "CRASH", "hang": "HANG", "": "CRASH"}


def execute(run: Run, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Result, Arrays]:
    """Outcomes of all checks; the one at which the child ended has CRASH or HANG, and those behind it NOT_RUN."""
    checks, started = asked(run), time.perf_counter()
    warmed(run.method, CHECKS[run.checks])
    tick(0.5)
    planted = one(run.defect) if run.defect != NONE else defects()[NONE]
    told = workshop().ask(planted, run.method, checks)
    outcomes = {answer.check: answer.outcome for answer in told.answers}
    missing = [check for check in checks if check not in outcomes]
    outcomes |= {check: ENDS[told.ended] if check == missing[0] else "NOT_RUN" for check in missing}
    result = Result(
        run=run,
        digest=run.digest,
        status="finished",
        outcomes=outcomes,
        evidence={answer.check: answer.evidence for answer in told.answers if answer.evidence},
        values={f"seconds {answer.check}": answer.seconds for answer in told.answers},
        wall_s=time.perf_counter() - started,
        cpu_s=told.cpu,
        environment=environment(),
    )
    return result, {}
