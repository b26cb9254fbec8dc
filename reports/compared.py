"""Two stored studies compared run by run: errors and values, how runs ended, observed orders, and verdicts."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isclose, isfinite, nan
from typing import Any, Literal

from mpm_verify.reports.frames import Record

Kind = Literal["verdict", "order", "status", "number", "run"]


@dataclass(frozen=True)
class Change:
    """Change: a run or a refinement, which of its numbers or words, both values, and what kind of change it is."""

    of: str
    what: str
    before: Any
    after: Any
    kind: Kind = "number"

    @property
    def ratio(self) -> str:
        """Ratio of two numbers as text; empty of anything else."""
        if all(isinstance(value, float) and isfinite(value) for value in (self.before, self.after)) and self.before:
            return f"{self.after / self.before:.6g} times"
        return ""

    def __str__(self) -> str:
        return f"{self.of}: {self.what} {self.before} -> {self.after}{f' ({self.ratio})' if self.ratio else ''}"


def changes(a: Record, b: Record, tolerance: float) -> tuple[list[Change], int]:
    """Changes from a to b, verdicts first, and the number of runs that both have.

    Numbers differ where they are further apart than `tolerance`, as a fraction of the larger one. Runs that one study
    asks for and the other does not are no change.

    Raises ValueError where they are of two cases, or have no run in common.
    """
    if a.study.case != b.study.case:
        raise ValueError(f"{a.store.folder} holds the case {a.study.case}, {b.store.folder} the case {b.study.case}")
    first, second = ({result.run: result for result in record.results.values()} for record in (a, b))
    both = [run for run in first if run in second]
    if not both:
        raise ValueError(f"{a.store.folder} and {b.store.folder} have no run in common")
    found = [change for run in both for change in of_run(first[run], second[run], tolerance)]
    return [*of_verdicts(a, b), *of_orders(a, b, tolerance), *found], len(both)


def alone(a: Record, b: Record) -> tuple[list[Any], list[Any]]:
    """Stored runs that only the first has, and only the second."""
    first, second = ([result.run for result in record.results.values()] for record in (a, b))
    return [run for run in first if run not in second], [run for run in second if run not in first]


def of_run(before: Any, after: Any, tolerance: float) -> Iterator[Change]:
    """Changes of one run."""
    name = f"{before.run}, {differs(before.run)}"
    if before.status != after.status:
        yield Change(name, "status", before.status, after.status, "status")
    for key, (x, y) in numbers(before, after).items():
        if not near(x, y, tolerance):
            yield Change(name, key, x, y)


def near(x: float, y: float, tolerance: float) -> bool:
    """Whether two numbers are alike: as near as the tolerance, or neither is a number."""
    return x == y or isclose(x, y, rel_tol=tolerance, abs_tol=0.0) or (x != x and y != y)


def numbers(before: Any, after: Any) -> dict[str, tuple[float, float]]:
    """Pairs of numbers by name; NaN where one of the two lacks it."""
    flat = [
        {f"{q} {norm}": value for q, norms in result.errors.items() for norm, value in norms.items()} | result.values
        for result in (before, after)
    ]
    return {key: (flat[0].get(key, nan), flat[1].get(key, nan)) for key in dict.fromkeys([*flat[0], *flat[1]])}


def differs(run: Any) -> str:
    """Fields of a run that are not as usual."""
    return ", ".join(
        f"{name}={getattr(run, name)}"
        for name, item in type(run).__dataclass_fields__.items()
        if name not in ("case", "given") and item.compare and getattr(run, name) != item.default
    )


def of_verdicts(a: Record, b: Record) -> Iterator[Change]:
    """Judged quantities and checks whose outcome is another one."""
    first, second = (outcomes(record) for record in (a, b))
    for key in first:
        if key in second and first[key] != second[key]:
            yield Change(key, "verdict", first[key], second[key], "verdict")


def outcomes(record: Record) -> dict[str, str]:
    """Outcome by what is judged."""
    found = {judged(record, f): str(f.verdict.outcome) for f in record.findings if f.counts}
    return found | {f"{check.group}: {check.name}": str(check.outcome) for check in record.analysis.checks}


def judged(record: Record, finding: Any) -> str:
    """Name of a judged quantity."""
    return f"{record.label(finding.plan.run)}, {finding.plan.quantity} {finding.plan.norm}"


def of_orders(a: Record, b: Record, tolerance: float) -> Iterator[Change]:
    """Judged quantities whose observed order is another one."""
    first, second = (
        {judged(record, f): nan if f.verdict.observed is None else f.verdict.observed
         for f in record.findings if f.counts} for record in (a, b)
    )  # fmt: skip
    for key in first:
        if key in second and not near(first[key], second[key], tolerance):
            yield Change(key, "observed order", first[key], second[key], "order")
