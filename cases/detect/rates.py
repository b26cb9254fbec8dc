"""Rates of a campaign: how many of a kind were noticed, with the exact interval of a fraction.

Intervals are those of Clopper & Pearson 1934, doi:10.1093/biomet/26.4.404.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from mpm_verify.cases.detect.defect import NONE
from mpm_verify.cases.detect.run import EXACT, ORDERS, one
from mpm_verify.cases.detect.survivors import equivalent

CONFIDENCE = 0.95
STOPPED = ("CRASH", "HANG", "ERROR")
QUICKLY = "mms --quick and exact"  # of what computes: these ask nothing of what judges


@dataclass(frozen=True)
class Row:
    """One planted copy: its kind, who would make it, and for each check the outcome where it is not that of sound code.

    `equivalent`: why nothing can see it; empty of a defect that something should see.
    """

    name: str
    method: str
    kind: str
    by: str
    file: str
    listed: bool
    equivalent: str
    changed: dict[str, str]
    evidence: str = ""

    def noticed(self, checks: Sequence[str] | None = None) -> bool:
        """Whether one of the checks, or of all, has noticed it."""
        return any(check in self.changed for check in checks) if checks is not None else bool(self.changed)

    def failed(self) -> bool:
        """Whether a check says FAIL."""
        return "FAIL" in self.changed.values()

    def stopped(self) -> bool:
        """Whether a check ended in an error, a crash or a hang."""
        return any(outcome in STOPPED for outcome in self.changed.values())


@dataclass(frozen=True)
class Rate:
    """Number noticed of a number of defects, and the 95 % interval of the fraction."""

    name: str
    noticed: int
    total: int
    low: float
    high: float

    @property
    def fraction(self) -> float:
        """Fraction noticed."""
        return self.noticed / self.total if self.total else float("nan")


def rate(name: str, held: Sequence[bool]) -> Rate:
    """Rate of what holds."""
    from scipy.special import betaincinv

    k, n, tail = sum(held), len(held), (1 - CONFIDENCE) / 2
    low = float(betaincinv(k, n - k + 1, tail)) if k else 0.0
    high = float(betaincinv(k + 1, n - k, 1 - tail)) if k < n else 1.0
    return Rate(name, k, n, low, high)


def rows(results: Sequence[Any]) -> list[Row]:
    """Rows of Results; outcomes count where they are not those of the sound package with the same method and checks."""
    sound = {(r.run.method, r.run.checks): r.outcomes for r in results if r.run.defect == NONE}
    found = []
    for result in results:
        planted, usual = one(result.run.defect), sound.get((result.run.method, result.run.checks), {})
        changed = {
            check: outcome
            for check, outcome in result.outcomes.items()
            if outcome not in ("PASS", "NOT_RUN", usual.get(check) if result.run.defect != NONE else "")
        }
        first = next((result.evidence[check] for check in changed if check in result.evidence), "")
        found.append(
            Row(
                planted.name,
                result.run.method,
                planted.kind,
                planted.by,
                planted.file,
                planted.listed,
                equivalent(planted),
                changed,
                first,
            )
        )
    return found


def real(found: Sequence[Row]) -> list[Row]:
    """Rows of defects that a check should see."""
    return [row for row in found if row.kind != "placebo" and not row.equivalent]


def rates(found: Sequence[Row]) -> list[Rate]:
    """Rates by kind, by who would make it, of all, and of the quick set."""
    mine = real(found)
    kinds = [(kind, [row for row in mine if row.kind == kind]) for kind in ("order", "robustness", "judge")]
    makers = [(by, [row for row in mine if row.by == by]) for by in sorted({row.by for row in mine})]
    lists = [("listed", [row for row in mine if row.listed]), ("not listed", [row for row in mine if not row.listed])]
    made = [rate(name, [row.noticed() for row in some]) for name, some in [*kinds, *lists, *makers] if some]
    made.append(rate("all", [row.noticed() for row in mine]))
    made.append(rate(QUICKLY, [row.noticed((*ORDERS, *EXACT)) for row in mine if row.kind != "judge"]))
    made.append(rate("as FAIL", [row.failed() for row in mine if row.noticed()]))
    return made


def alone(found: Sequence[Row], check: str) -> int:
    """Number of defects that this check alone notices."""
    return sum(set(row.changed) == {check} for row in real(found))


def redundant(found: Sequence[Row], checks: Sequence[str]) -> tuple[str, ...]:
    """Checks that could go, the one that notices least first, without a defect being missed."""
    kept = list(checks)
    for check in sorted(checks, key=lambda c: sum(c in row.changed for row in real(found))):
        rest = [one_ for one_ in kept if one_ != check]
        if all(row.noticed(rest) for row in real(found) if row.noticed(kept)):
            kept = rest
    return tuple(check for check in checks if check not in kept)
