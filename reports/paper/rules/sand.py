"""Rules of the claims on UBCSAND and Table 2."""

from collections.abc import Mapping
from typing import Any

from mpm_verify.cases.column.records import FinishedRun
from mpm_verify.cases.element.exam import ElementRemark
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.reports.paper.evidence import Evidence
from mpm_verify.reports.paper.records import Answer, NotFinishedError

At = Mapping[str, Any]
CLOSE = 0.05  # of the front


def u1(seen: Evidence, at: At) -> Answer:
    """Element tests of the model pass; the table has no failure ratio, and its calibration factors do nothing here."""
    parameters = seen.one("ubcsand").parameters
    checks: tuple[Check, ...] = seen.checks("ubcsand")
    if not checks:
        raise NotFinishedError("ubcsand")
    passed = sum(check.outcome is Outcome.PASS for check in checks)
    ratio = next(float(value) for name, value in parameters.items() if name.split()[-1] == "Rf")
    origins = [one.origins for one in seen.record("ubcsand").analysis.more.examinations.values()]
    printed = all(one.get("Rf") != ElementRemark.CORRELATION for one in origins)
    return Answer({"element tests": passed == len(checks), "table is complete": printed},
                  {"checks": len(checks), "pass": passed, "failure ratio taken": ratio})  # fmt: skip


def of(seen: Evidence, material: str) -> FinishedRun:
    """Column of a material in Figure 8. Raises NotFinishedError."""
    for one in seen.columns("figure8"):
        if one.run.material.partition(":")[0] == material:
            return one
    raise NotFinishedError("figure8")


def u7(seen: Evidence, at: At) -> Answer:
    """Hardening alters the run-out by more than little; the stiffness of the collapse is told by how far it goes."""
    sand, plain = of(seen, "ubcsand"), of(seen, "mohr_coulomb")
    apart = sand.values[at["front"]] / plain.values[at["front"]] - 1
    return Answer({"is seen in the run-out": abs(apart) > CLOSE, "alters the stiffness": None}, {"apart": apart})


RULES = {"U1": u1, "U7": u7}
