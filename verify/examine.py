"""What a command does that examines one thing: compute, store, make the page, print the checks, say it in the code."""

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from math import isfinite, nan
from pathlib import Path
from typing import Any

import typer

from mpm_verify.cases.harness.checks import Check, Examination
from mpm_verify.verify.terminal.output import printing

CODES = {"PASS": 0, "FAIL": 1, "ERROR": 1, "INCONCLUSIVE": 3}
VERSION = 1


def conduct(
    compute: Callable[[], Examination],
    draw: Callable[[Path, Examination], Path],
    folder: Path,
    json_output: bool = False,
    junit: Path | None = None,
) -> int:
    """Returns the exit code; what is wrong with the input is one line and exit code 2."""
    from mpm_verify.cases.harness.checks import save
    from mpm_verify.reports.export.junit import check_junit, write_checks
    from mpm_verify.verify.conduct import usage

    with usage():
        check_junit(junit)
        with working():
            examination = compute()
        save(folder, examination)
        page = draw(folder, examination)
        if junit:
            write_checks(junit, examination)
    with printing():
        if json_output:
            typer.echo(document(examination, page))
        else:
            show(examination, page)
    return CODES[examination.outcome]


@contextmanager
def working() -> Iterator[None]:
    """Says on a terminal that something is being done: it takes seconds to a minute."""
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console

    with Console(stderr=True).status("computing, and holding it against what is known ..."):
        yield


def document(examination: Examination, page: Path) -> str:
    """One JSON document: the checks with their outcomes; a number that is not finite is null."""
    content = {
        "version": VERSION,
        "examination": examination.name,
        "outcome": str(examination.outcome),
        "lead": examination.lead,
        "notes": list(examination.remarks),
        "parameters": examination.parameters,
        "checks": [told(check) for check in examination.checks],
        "report": str(page),
    }
    return json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False)


def told(check: Check) -> dict[str, Any]:
    """A check for JSON."""
    return {**finite(asdict(check)), "outcome": str(check.outcome)}


def finite(value: Any) -> Any:
    """The same with None for numbers that JSON has no word for."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def show(examination: Examination, page: Path) -> None:
    """Print each part with how many of its checks pass, those that do not with their numbers, and the page's path."""
    from rich.table import Table
    from rich.text import Text

    from mpm_verify.verify.terminal.table import STYLES, Listened

    out = Listened(highlight=False, soft_wrap=False)
    if not out.is_terminal:
        out.width = max(out.width, 100)
    out.print(Text(f"\n{examination.title}", "bold"))
    table = Table(box=None, pad_edge=False, header_style="dim")
    for name in ("", "part", "checks", "pass", "closest call"):
        table.add_column(name, justify="right" if name in ("checks", "pass") else "left")
    for group in examination.groups:
        checks = [check for check in examination.checks if check.group == group]
        if checks:
            missed = [check for check in checks if check.outcome != "PASS"]
            worst = str(missed[0].outcome) if missed else "PASS"
            table.add_row(
                Text(worst, STYLES[worst]), group, str(len(checks)), str(len(checks) - len(missed)), closest(checks)
            )
    out.print(table)
    for check in examination.checks:
        if check.outcome != "PASS":
            out.print(Text.assemble((str(check.outcome), STYLES[check.outcome]), f" {check.group}: {sentence(check)}"))
    out.print(Text(f"\n{examination.lead}"))
    for remark in examination.remarks:
        out.print(Text(f"note: {remark}"))
    out.print(f"\nreport: {page}", soft_wrap=True)


def sentence(check: Check) -> str:
    """What was found, and what it is held against."""
    within = f" within {check.within:.3g}" if check.within else ""
    way = f"{check.way} " if check.way.startswith("at") else ""
    relative = " of it" if check.way == "relative" else ""
    return f"{check.name} is {check.found:.8g}, expected {way}{check.expected:.8g}{within}{relative} ({check.source})"


def closest(checks: list[Check]) -> str:
    """The check that uses most of what it is allowed, and its numbers; nothing where no check allows anything."""
    shares = {check: used(check) for check in checks}
    bounded = [check for check in checks if isfinite(shares[check])]
    if not bounded:
        return ""
    most = max(bounded, key=lambda check: shares[check])
    if most.way.startswith("at"):
        return f"{most.found:.2g}, {most.way} {most.expected:.2g}: {most.name}"
    return f"{most.miss:.2g} of {most.within:.2g}: {most.name}"


def used(check: Check) -> float:
    """Share of what the check is allowed that it uses, above 1 where it fails; NaN where there is no such number."""
    if check.within:
        return check.miss / check.within
    over, under = (check.found, check.expected) if check.way == "at most" else (check.expected, check.found)
    return over / under if check.way.startswith("at") and min(over, under) > 0 else nan
