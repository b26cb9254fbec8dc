"""Exactness battery: what a step, a basis, a wall and a constitutive model keep to round-off, and what that points to.

Orders of errors see what is wrong in proportion to the cell size. These tests see the rest, in seconds: each holds an
answer that is known exactly, of bodies of a few cells in generic states, with every transfer and stress update. Bounds
are those of round-off (cases/exact/tested.py). A test that a method or material does not promise is told with the
reason. The contract of a case is told in cases/harness/contract.py.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from mpm_verify.cases.exact.groups import group_of
from mpm_verify.cases.exact.run import AXES, QUICK, Result, Run
from mpm_verify.cases.harness.checks import Check, Examination, Remark
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.mms.constitutive.tested import Tested
from mpm_verify.solver.plugins import MATERIALS, METHODS, label
from mpm_verify.solver.plugins import canonical as canonical_name

__all__ = ["AXES", "QUICK", "ExactAnalysis", "Result", "Run", "canonical", "examine", "title"]


class ExactRemark(StrEnum):
    """Remarks on what came out, on the tests of each group, and on what is not asked."""

    HOLDS = "exact.holds"
    FAILS = "exact.fails"
    POINTS = "exact.points"  # the part of the solver that a failed test points to
    NOT_ASKED = "exact.not_asked"  # a test, how often, and the reason
    HELD = "exact.held"  # a test, its largest residual over its bound


@dataclass(frozen=True)
class ExactAnalysis:
    """One Examination, of all methods and materials."""

    examinations: Mapping[str, Examination]

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of all."""
        return tuple(check for one in self.examinations.values() for check in one.checks)


def title(runs: Sequence[Run]) -> str:
    """Title of a study."""
    names = [list(dict.fromkeys(label(getattr(run, axis)) for run in runs)) for axis in ("method", "material")]
    few = [", ".join(one) if len(one) <= 3 else "" for one in names]
    told = [few[0] or f"{len(names[0])} methods", few[1] or f"{len(names[1])} materials"]
    return f"Exactness battery: {' with '.join(told)}"


def canonical(values: dict[str, Any]) -> dict[str, Any]:
    """Specifications with only the parameters that differ from their defaults."""
    for key, package in {"method": METHODS, "material": MATERIALS}.items():
        values[key] = canonical_name(package, values.get(key, getattr(Run, key)))
    return values


def examine(study: Study[Run], results: Mapping[str, Result], store: Store) -> ExactAnalysis:
    """Check of each test of each run, the worst of its transfers and stress updates."""
    done = [results[run.digest] for run in study.runs if run.digest in results]
    if not done:
        return ExactAnalysis({})
    checks = tuple(check for result in done for check in checked(result))
    found = (*remarks(done, checks), *held(done))
    one = Examination(study.name, study.title, study.command, found, checks, environment=done[0].environment)
    return ExactAnalysis({study.name: one})


def checked(result: Result) -> list[Check]:
    """Checks of one run: the worst of each test that was asked."""
    worst: dict[str, Tested] = {}
    for one in result.tested:
        if not one.reason and (one.test not in worst or one.over > worst[one.test].over):
            worst[one.test] = one
    return [
        Check(group_of(test), f"{one.name}: {result.run}", one.residual, one.bound, "at_most", str(one.points_to))
        for test, one in worst.items()
    ]


def remarks(done: Sequence[Result], checks: Sequence[Check]) -> list[Remark]:
    """Remarks on what came out, and what each failed test points to."""
    missed = [check for check in checks if check.outcome != "PASS"]
    tests = [one for result in done for one in result.tested]
    asked = [one for one in tests if not one.reason]
    if not missed:
        return [Remark(ExactRemark.HOLDS, {"asked": len(asked), "runs": len(done), "others": len(tests) - len(asked)})]
    failed = [(result, one) for result in done for one in result.tested if not one.passed]
    found = [Remark(ExactRemark.FAILS, {"failed": len(failed), "asked": len(asked)})]
    for test in dict.fromkeys(one.test for _, one in failed):
        mine = [(result, one) for result, one in failed if one.test == test]
        result, worst = max(mine, key=lambda pair: pair[1].over)
        numbers: dict[str, float | str] = {
            "test": test, "part": worst.points_to, "failed": len(mine), "name": worst.name, "run": str(result.run),
            "residual": worst.residual, "bound": worst.bound,
        }  # fmt: skip
        found.append(Remark(ExactRemark.POINTS, numbers))
    return found


def held(done: Sequence[Result]) -> list[Remark]:
    """Remarks on each test: how often it was asked, its worst residual, and the reasons for which it was not."""
    found = []
    every = [(result, one) for result in done for one in result.tested]
    for test in dict.fromkeys(one.test for _, one in every):
        asked = [(result, one) for result, one in every if one.test == test and not one.reason]
        if asked:
            result, worst = max(asked, key=lambda pair: pair[1].over)
            numbers: dict[str, float | str] = {
                "test": test, "part": worst.points_to, "asked": len(asked), "residual": worst.residual,
                "bound": worst.bound, "name": worst.name, "run": str(result.run),
                "failed": sum(not one.passed for _, one in asked),
            }  # fmt: skip
            found.append(Remark(ExactRemark.HELD, numbers, group_of(test)))
        why = [one.reason for _, one in every if one.test == test and one.reason]
        for reason in dict.fromkeys(why):
            counted: dict[str, float | str] = {"test": test, "reason": reason, "count": why.count(reason)}
            found.append(Remark(ExactRemark.NOT_ASKED, counted, group_of(test)))
    return found
