"""Checks on a terminal: each part with how many of its checks pass, and those that do not with their numbers."""

from collections.abc import Sequence
from math import isfinite, nan
from pathlib import Path

from mpm_verify.cases.harness.checks import Check
from mpm_verify.reports import words
from mpm_verify.reports.components.logs import failed
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import failures, unjudged


def show(record: Record, page: Path | None, lead: str = "", titled: bool = True) -> None:
    """Print each part with how many of its checks pass, those that do not with their numbers, and the page's path.

    The title of the study stands before, if it is `titled`.
    """
    every = record.analysis.checks
    from rich.text import Text

    from mpm_verify.verify.terminal import logs
    from mpm_verify.verify.terminal.table import STYLES, bare, listened, where

    out = listened()
    out.print(Text(f"\n{record.study.title}" if titled else "", "bold"))
    table = bare()
    for name in ("", "part", "checks", "pass", "closest to its bound"):
        table.add_column(name, justify="right" if name in ("checks", "pass") else "left")
    for group in dict.fromkeys(check.group for check in every):
        checks = [check for check in every if check.group == group]
        if checks:
            missed = [check for check in checks if check.outcome != "PASS"]
            worst = str(missed[0].outcome) if missed else "PASS"
            table.add_row(
                Text(worst, STYLES[worst]), group, str(len(checks)), str(len(checks) - len(missed)), closest(checks)
            )
    out.print(table)
    for check in every:
        if check.outcome != "PASS":
            out.print(Text.assemble((str(check.outcome), STYLES[check.outcome]), f" {check.group}: {sentence(check)}"))
    logs.show(out, failed(record))
    if lead:
        out.print(Text(f"\n{lead}"))
    where(out, page)


def sentence(check: Check) -> str:
    """Sentence with what was found, and what it is held against."""
    within = f" within {check.within:.3g}" if check.within else ""
    way = f"{words.way(check.way)} " if check.way in words.BOUNDS else ""
    relative = " of it" if check.way == "relative" else ""
    name = failures.check(check.name, check.failure)
    if check.failure and check.failure.step < 0:
        return name
    if not isfinite(check.found):
        return f"{name}: there is no number to hold against {check.expected:.8g}"
    known = f"{way}{check.expected:.8g}{within}{relative}"
    return f"{name} is {check.found:.8g}, expected {known} ({unjudged.source(check)})"


def closest(checks: Sequence[Check]) -> str:
    """Check that uses most of what it is allowed, and its numbers; empty where no check allows anything."""
    fractions = {check: used(check) for check in checks}
    bounded = [check for check in checks if isfinite(fractions[check]) and not check.unjudged]
    if not bounded:
        return ""
    most = max(bounded, key=lambda check: fractions[check])
    if most.way in words.BOUNDS:
        return f"{most.found:.2g}, {words.way(most.way)} {most.expected:.2g}: {most.name}"
    return f"{most.miss:.2g} of {most.within:.2g}: {most.name}"


def used(check: Check) -> float:
    """Fraction of what the check is allowed that it uses, above 1 where it fails; not a number where there is none."""
    if check.within:
        return check.miss / check.within
    over, under = (check.found, check.expected) if check.way == "at_most" else (check.expected, check.found)
    return over / under if check.way in words.BOUNDS and min(over, under) > 0 else nan
