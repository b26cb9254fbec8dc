"""Page of an Examination: sections with words, figures and tables, and every check beside what it is held against."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import pandas as pd

from mpm_verify.cases.harness.checks import Check, Examination
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.reports import words
from mpm_verify.reports.components.badges import Badge, of_checks, shortened
from mpm_verify.reports.components.film import Film
from mpm_verify.reports.components.logs import Log
from mpm_verify.reports.components.page import ALL, Add, Image, adder, whole
from mpm_verify.reports.components.references import Cited
from mpm_verify.reports.components.run_cards import RunCard
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.sentences import failures, unjudged
from mpm_verify.reports.sentences.remarks import lead, parameters

WAYS = {"relative": "± {} of it", "absolute": "± {}", "at_least": "or more", "at_most": "or less"}


@dataclass(frozen=True)
class Section:
    """Section of the page: paragraphs, figures with their captions, tables, animations."""

    key: str
    heading: str
    text: Sequence[str] = ()
    figures: Sequence[tuple[Image, str]] = ()
    tables: Sequence[Table] = ()
    films: Sequence[Film] = ()
    wide: bool = False  # a single figure as wide as the page
    runs: Sequence[RunCard] = ()


Sections = Callable[[Examination, Add], Sequence[Section]]


def render(
    folder: Path,
    examination: Examination,
    sections: Sections,
    kinds: Sequence[str] = ALL,
    outcome: str = "",
    said: str = "",
    logs: Sequence[Log] = (),
    found: Sequence[Badge] = (),
    told: Mapping[str, str] | None = None,
    cite: Cited | None = None,
) -> Path:
    """Write report.html, figures/ in these kinds, tables/checks.csv; `sections` draws what is special.

    `outcome` and `said` stand on top: usual are those of the examination's checks, and what came out of it in words.
    `logs` are those of runs of somebody else's solver that failed.

    Raises StoreError.
    """
    try:
        for name in ("figures", "tables"):
            (folder / name).mkdir(parents=True, exist_ok=True)
        if examination.checks:
            _write_csv(folder / "tables" / "checks.csv", examination.checks)
        missed = [check for check in examination.checks if check.outcome != "PASS"]
        text = whole(
            "examination.html.j2",
            examination.title,
            examination=examination,
            found=shortened([*found, *of_checks(examination.checks)]),
            lead=said or lead(examination),
            outcome=outcome or str(examination.outcome),
            logs=logs,
            missed=checks_table("Found and expected", missed, group=True) if missed else None,
            sections=figures_first(sections(examination, adder(folder / "figures", kinds=kinds, told=told))),
            parameters=Table(
                "Parameters", ("parameter", "value"), tuple(parameters(examination).items()), texts=("value",)
            ),
            cite=cite,
            environment=Table(
                "What computed it", ("", "version"), tuple(examination.environment.items()), texts=("version",)
            ),
        )
        Store.write(folder / "report.html", text.encode())
        return folder / "report.html"
    except OSError as error:
        raise StoreError(f"cannot write the report into {folder}: {error.strerror}; the results are kept") from error


def figures_first(sections: Sequence[Section]) -> Sequence[Section]:
    """Sections, the first that has figures in front of all."""
    first = next((one for one in sections if one.figures), None)
    return sections if first is None else [first, *(one for one in sections if one is not first)]


def checks_table(caption: str, checks: Sequence[Check], group: bool = False) -> Table:
    """Table of checks: found beside expected, how close it has to be, and where the expectation comes from."""
    head = (*(("part",) if group else ()), "check", "outcome", "found", "expected", "allowed", "miss", "source")
    rows = tuple((*((check.group,) if group else ()), *row(check)) for check in checks)
    return Table(caption, head, rows, texts=("check", "outcome", "allowed", "source"))


def row(check: Check) -> tuple[str, ...]:
    """Cells of a check as text; a bound has no distance from it worth showing."""
    bound = check.way in words.BOUNDS
    allowed = WAYS[check.way].format(f"{check.within:.3g}")
    miss = "" if bound else f"{check.miss:.2g}"
    return (
        failures.check(check.name, check.failure),
        str(check.outcome),
        digits(check.found),
        digits(check.expected),
        allowed,
        miss,
        unjudged.source(check),
    )


def digits(value: float) -> str:
    """Number with eight digits, so that a reference value can be recognised; powers of ten where it is tiny or huge."""
    return f"{value:.8g}".replace("-", "\N{MINUS SIGN}", 1) if value < 0 else f"{value:.8g}"


def _write_csv(path: Path, checks: Sequence[Check]) -> None:
    """Write all checks with full digits."""
    rows = [
        {**asdict(check), "miss": check.miss, "outcome": str(check.outcome)}
        | {"failure": str(check.failure.kind) if check.failure else None}
        for check in checks
    ]
    pd.DataFrame(rows).to_csv(path, index=False)
