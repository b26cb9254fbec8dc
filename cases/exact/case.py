"""Exactness battery: what a step, a basis, a wall and a constitutive model keep to round-off, and what that points to.

Orders of errors see what is wrong in proportion to the cell size. These tests see the rest, in seconds: each holds an
answer that is known exactly, of bodies of a few cells in generic states, with every transfer and stress update. Bounds
are those of round-off (cases/exact/tested.py). A test that a method or material does not promise is told with the
reason. The contract of a case is told in cases/harness/contract.py.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from math import nan
from typing import Any

from mpm_verify.cases.exact.groups import group_of
from mpm_verify.cases.exact.others.names import TESTS
from mpm_verify.cases.exact.run import AXES, OTHERS, QUICK, Result, Run
from mpm_verify.cases.harness.build import Asked
from mpm_verify.cases.harness.checks import Check, Examination, Remark
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.solvers import column_map
from mpm_verify.cases.solvers.command import PYTHON, program
from mpm_verify.cases.solvers.naming import method_of, version_of
from mpm_verify.mms.constitutive.tested import Tested
from mpm_verify.mms.energy import check_energy
from mpm_verify.solver.plugins import MATERIALS, METHODS, create, label
from mpm_verify.solver.plugins import canonical as canonical_name

__all__ = ["AXES", "QUICK", "ExactAnalysis", "Result", "Run", "canonical", "check", "examine", "parts", "title"]

ALONE = ("test", "columns", "precision", "flip")  # fields that the reference solver does not take
FEW_DIGITS = 1e-14  # rounding of the numbers in a file, over their scale, that is told


class ExactRemark(StrEnum):
    """Remarks on what came out, on the tests of each group, and on what is not asked."""

    HOLDS = "exact.holds"
    FAILS = "exact.fails"
    POINTS = "exact.points"  # the part of the solver that a failed test points to
    NOT_ASKED = "exact.not_asked"  # a test, how often, and the reason
    ENDED = "exact.ended"  # how many runs of a solver of somebody else failed
    DIGITS = "exact.digits"  # of the numbers in its files, where they make the bounds wider
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
    if any(run.solver for run in runs):
        return f"Exactness battery: {' and '.join(dict.fromkeys(program(run.solver) for run in runs))}"
    names = [list(dict.fromkeys(label(getattr(run, axis)) for run in runs)) for axis in ("method", "material")]
    few = [", ".join(one) if len(one) <= 3 else "" for one in names]
    told = [few[0] or f"{len(names[0])} methods", few[1] or f"{len(names[1])} materials"]
    return f"Exactness battery: {' with '.join(told)}"


def canonical(values: dict[str, Any]) -> dict[str, Any]:
    """Specifications with only the parameters that differ from their defaults."""
    if values.get("columns"):
        values["columns"] = column_map.read(values["columns"])
    if values.get("solver"):
        values["solver_version"] = values.get("solver_version") or version_of(values["solver"])
        values["method"] = method_of(values["solver"])
        values["material"] = canonical_name(MATERIALS, values.get("material", Run.material))
        return values
    for key, package in {"method": METHODS, "material": MATERIALS}.items():
        values[key] = canonical_name(package, values.get(key, getattr(Run, key)))
    return values


def parts(asked: Asked) -> list[Asked]:
    """Request with all tests and one material of a solver of somebody else, where none are asked for."""
    if not any(asked.values.get("solver", ())):
        return [asked]
    if any(method != Run.method for method in asked.values.get("method", ())):
        raise ValueError("--method is one of the reference solver; leave it out beside --solver")
    return [replace(asked, values={"method": (Run.method,), **OTHERS, **asked.values}, quick=False)]


def check(runs: Sequence[Run]) -> None:
    """Raise ValueError with one line for options that belong to the other kind of solver, and for a material."""
    for name in ALONE:
        if any(getattr(run, name) != getattr(Run, name) and not run.solver for run in runs):
            raise ValueError(f"--{name.replace('_', '-')} is for a solver of your own; give --solver too")
    if any(run.columns and run.solver.startswith(PYTHON) for run in runs):
        raise ValueError("--columns is for files; a Python function returns arrays by our names")
    for name in dict.fromkeys(run.material for run in runs if run.solver):
        material = create(MATERIALS, name)
        check_energy(material)
        if material.small_strain:
            raise ValueError(f"{label(name)} is one of small strains; the tests of --solver are of finite strain")


def examine(study: Study[Run], results: Mapping[str, Result], store: Store) -> ExactAnalysis:
    """Check of each test of each run, the worst of its transfers and stress updates."""
    done = [results[run.digest] for run in study.runs if run.digest in results]
    if not done:
        return ExactAnalysis({})
    checks = tuple(check for result in done for check in checked(result))
    found = (*remarks(done, checks), *of_answers(done), *held(done))
    one = Examination(study.name, study.title, study.command, found, checks, environment=done[0].environment)
    return ExactAnalysis({study.name: one})


def checked(result: Result) -> list[Check]:
    """Checks of one run: the worst of each test that was asked; of an answer of somebody else each quantity."""
    if result.failure:
        return [Check(group(result.run.test), str(result.run), nan, 0.0, "at_most", "", failure=result.failure)]
    worst = dict[str, Tested]()
    for one in result.tested:
        key = one.name if result.run.solver else one.test
        if not one.reason and (key not in worst or one.over > worst[key].over):
            worst[key] = one
    return [
        Check(
            group(one.test), f"{one.name}: {told(result.run)}", one.residual, one.bound, "at_most", str(one.points_to)
        )
        for one in worst.values()
    ]


def told(run: Run) -> str:
    """Run as a test of it tells it: without the test."""
    return str(run).replace(f", {run.test}", "") if run.test else str(run)


def group(test: str) -> str:
    """Group of a test, of the reference solver or of somebody else's."""
    return TESTS[test] if test in TESTS else group_of(test)


def of_answers(done: Sequence[Result]) -> list[Remark]:
    """Remarks on answers of somebody else: how many runs failed, and digits that make the bounds wider."""
    failed = [result for result in done if result.failure]
    found = [Remark(ExactRemark.ENDED, {"failed": len(failed), "runs": len(done)})] if failed else []
    rounding = max((result.values.get("rounding", 0.0) for result in done), default=0.0)
    return [*found, *([Remark(ExactRemark.DIGITS, {"rounding": rounding})] if rounding > FEW_DIGITS else [])]


def remarks(done: Sequence[Result], checks: Sequence[Check]) -> list[Remark]:
    """Remarks on what came out, and what each failed test points to."""
    missed = [check for check in checks if check.outcome != "PASS"]
    tests = [one for result in done for one in result.tested]
    asked = [one for one in tests if not one.reason]
    others = [one for one in tests if one.reason]
    if not missed:
        numbers: dict[str, float | str] = {"asked": len(asked), "runs": len(done), "others": len(others)}
        return [Remark(ExactRemark.HOLDS, numbers | {"solver": bool(done[0].run.solver)})]
    failed = [(result, one) for result in done for one in result.tested if not one.passed]
    found = [Remark(ExactRemark.FAILS, {"failed": len(failed), "asked": len(asked)})] if failed else []
    own = bool(done[0].run.solver)  # whose tests point to the same part together
    for key in dict.fromkeys(one.points_to if own else one.test for _, one in failed):
        mine = [(result, one) for result, one in failed if key in (one.points_to if own else one.test,)]
        result, worst = max(mine, key=lambda pair: pair[1].over)
        numbers = {
            "test": worst.test, "part": worst.points_to, "failed": len(mine), "name": worst.name,
            "run": told(result.run), "residual": worst.residual, "bound": worst.bound,
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
                "bound": worst.bound, "name": worst.name, "run": told(result.run),
                "failed": sum(not one.passed for _, one in asked),
            }  # fmt: skip
            found.append(Remark(ExactRemark.HELD, numbers, group(test)))
        why = [one.reason for _, one in every if one.test == test and one.reason]
        for reason in dict.fromkeys(why):
            counted: dict[str, float | str] = {"test": test, "reason": reason, "count": why.count(reason)}
            found.append(Remark(ExactRemark.NOT_ASKED, counted, group(test)))
    return found
