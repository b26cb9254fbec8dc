"""Plant one defect in a copy of the package, and ask the checks of it there."""

import time
from collections.abc import Callable

from mpm_verify.cases.detect.defect import NONE, defects
from mpm_verify.cases.detect.run import CHECKS, Result, Run, one
from mpm_verify.cases.detect.workshop import warmed, workshop
from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.harness.study import Arrays

ENDS = {"crash": "CRASH", "hang": "HANG", "": "CRASH"}


def execute(run: Run, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Result, Arrays]:
    """Outcomes of all checks; the one at which the child ended has CRASH or HANG, and those behind it NOT_RUN."""
    checks, started = CHECKS[run.checks], time.perf_counter()
    warmed(run.method, CHECKS["full"] if run.checks == "full" else checks)
    tick(0.5)
    planted = one(run.defect) if run.defect != NONE else defects()[NONE]
    asked = workshop().ask(planted, run.method, checks)
    outcomes = {answer.check: answer.outcome for answer in asked.answers}
    missing = [check for check in checks if check not in outcomes]
    outcomes |= {check: ENDS[asked.ended] if check == missing[0] else "NOT_RUN" for check in missing}
    result = Result(
        run=run,
        digest=run.digest,
        status="finished",
        outcomes=outcomes,
        evidence={answer.check: answer.evidence for answer in asked.answers if answer.evidence},
        values={f"seconds {answer.check}": answer.seconds for answer in asked.answers},
        wall_s=time.perf_counter() - started,
        cpu_s=asked.cpu,
        environment=environment(),
    )
    return result, {}
