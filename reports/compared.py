"""Two stored studies compared run by run: errors and values, how runs ended, and verdicts."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isclose, nan
from typing import Any

from mpm_verify.reports.frames import Record


@dataclass(frozen=True)
class Change:
    """Change: a run or a refinement, which of its numbers or words, and both values."""

    of: str
    what: str
    before: Any
    after: Any

    def __str__(self) -> str:
        ratio = ""
        if all(isinstance(value, float) for value in (self.before, self.after)) and self.before:
            ratio = f" ({self.after / self.before:.6g} times)"
        return f"{self.of}: {self.what} {self.before} -> {self.after}{ratio}"


def changes(a: Record, b: Record, tolerance: float) -> tuple[list[Change], int]:
    """Changes from a to b, and the number of runs that both have. Raises ValueError where there are none."""
    if a.study.case != b.study.case:
        raise ValueError(f"{a.store.folder} holds the case {a.study.case}, {b.store.folder} the case {b.study.case}")
    first, second = ({result.run: result for result in record.results.values()} for record in (a, b))
    both = [run for run in first if run in second]
    if not both:
        raise ValueError(f"{a.store.folder} and {b.store.folder} have no run in common")
    found = [change for run in both for change in of_run(first[run], second[run], tolerance)]
    return found + list(of_verdicts(a, b)), len(both)


def of_run(before: Any, after: Any, tolerance: float) -> Iterator[Change]:
    """Changes of one run."""
    name = f"{before.run}, {differs(before.run)}"
    if before.status != after.status:
        yield Change(name, "status", before.status, after.status)
    for key, (x, y) in numbers(before, after).items():
        if x != y and not isclose(x, y, rel_tol=tolerance, abs_tol=0.0) and not (x != x and y != y):
            yield Change(name, key, x, y)


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
            yield Change(key, "verdict", first[key], second[key])


def outcomes(record: Record) -> dict[str, str]:
    """Outcome by what is judged."""
    judged = [f for f in record.findings if f.counts]
    found = {f"{record.label(f.plan.run)}, {f.plan.quantity} {f.plan.norm}": str(f.verdict.outcome) for f in judged}
    return found | {f"{check.group}: {check.name}": str(check.outcome) for check in record.analysis.checks}
