"""Checks, numbers held against what is known; and Examinations of a case, with curves to draw and remarks."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Any, Literal

from mpm_verify.cases.judging.records import Outcome, worst
from mpm_verify.solver.failure import Failure
from mpm_verify.solver.state import Floats

Unjudged = Literal["", "few_grids", "not_usual", "not_at_rest", "one_thread"]  # why nothing can be held
Way = Literal["relative", "absolute", "at_least", "at_most"]
Curves = dict[str, dict[str, Floats]]


@dataclass(frozen=True)
class Check:
    """A number `found` and what it is held against.

    `way`: found within `within` of `expected`, as a fraction of it or absolutely, or a bound that `expected` is. A
    number that is not finite is an ERROR, one that is `unjudged` INCONCLUSIVE. `source` says where the expectation
    comes from, `group` which part it belongs to.
    """

    group: str
    name: str
    found: float
    expected: float
    way: Way
    source: str
    within: float = 0.0
    failure: Failure | None = None  # what ended the run that has no number to hold
    unjudged: Unjudged = ""

    @property
    def miss(self) -> float:
        """Distance of found from expected, as a fraction of it where the check is relative."""
        distance = abs(self.found - self.expected)
        return distance / abs(self.expected) if self.way == "relative" else distance

    @property
    def outcome(self) -> Outcome:
        """Outcome: PASS, FAIL, ERROR where the value is not a number, or INCONCLUSIVE where nothing can be held."""
        if not isfinite(self.found):
            return Outcome.ERROR
        if self.unjudged:
            return Outcome.INCONCLUSIVE
        if self.way == "at_least":
            return Outcome.PASS if self.found >= self.expected else Outcome.FAIL
        if self.way == "at_most":
            return Outcome.PASS if self.found <= self.expected else Outcome.FAIL
        return Outcome.PASS if self.miss <= self.within else Outcome.FAIL


@dataclass(frozen=True)
class Remark:
    """A finding without words: its code, `case.what`, its numbers and names, and the group of checks that it is of.

    Without a group it is of the whole. reports/sentences makes the words.
    """

    code: str
    numbers: Mapping[str, float | str] = field(default_factory=dict)
    group: str = ""


@dataclass(frozen=True)
class Examination:
    """Examination by one command: checks, and as `findings` what came out and what one should know of each group.

    `origins`: by parameter, a code for where its value comes from or what it does, `case.what` too.
    """

    name: str
    title: str
    command: str
    findings: tuple[Remark, ...]
    checks: tuple[Check, ...]
    parameters: dict[str, float | str] = field(default_factory=dict)
    origins: dict[str, str] = field(default_factory=dict)
    environment: dict[str, str] = field(default_factory=dict)
    curves: dict[str, Any] = field(default_factory=dict, compare=False)  # Curves; pydantic knows no arrays

    @property
    def outcome(self) -> Outcome:
        """The worst of its checks, a FAIL before an ERROR; INCONCLUSIVE where there are none."""
        return worst(check.outcome for check in self.checks)

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the parts, in their order."""
        noted = [finding.group for finding in self.findings if finding.group]
        return tuple(dict.fromkeys([*(check.group for check in self.checks), *noted]))


def gathered(examinations: Mapping[str, Examination]) -> tuple[Check, ...]:
    """Checks of all; where there are several, groups begin with the name of their Examination."""
    if len(examinations) == 1:
        return next(iter(examinations.values())).checks
    return tuple(
        replace(check, group=f"{name}: {check.group}") for name, one in examinations.items() for check in one.checks
    )
