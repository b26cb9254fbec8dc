"""Page of a campaign: rates with intervals, the matrix, what nothing noticed, redundant checks, every planted copy."""

from collections.abc import Sequence
from pathlib import Path

from mpm_verify.cases.detect.case import Campaign
from mpm_verify.cases.detect.rates import Row, alone, real, redundant
from mpm_verify.cases.detect.run import CHECKS
from mpm_verify.reports.components.examined import Section
from mpm_verify.reports.components.page import Add, adder
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.figures.detect import matrix
from mpm_verify.reports.frames import Record
from mpm_verify.reports.pages import _plain
from mpm_verify.reports.sentences import detect as words


def page(record: Record, vtk: bool = False) -> Path:
    """Write the page; its path. There are no snapshots, whatever `vtk` says. Raises StoreError."""
    folder = record.store.folder / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    return _plain.page(record, more=sections(record, adder(folder)))


def asked(record: Record) -> tuple[str, ...]:
    """Checks of the study, in their order."""
    sets = {run.checks for run in record.study.runs}
    return CHECKS["full" if "full" in sets else "quick"]


def sections(record: Record, add: Add) -> list[Section]:
    """Sections of a campaign."""
    found: Campaign = record.analysis.more
    checks = asked(record)
    if not real(found.rows):
        return []
    mine = real(found.rows)
    counts = {check: sum(check in row.changed for row in mine) for check in checks}
    most = max(counts, key=lambda check: counts[check])
    alt = f"Fraction of each class of defects that each check notices; {most} most, {counts[most]} of {len(mine)}."
    image = add("matrix", matrix(found.rows, checks), alt)
    told = "Per cent of the defects of a class that a check notices; in brackets how many were planted."
    return [
        Section("rates", "Rates", tables=[rate_table(found)]),
        Section(
            "matrix",
            "Defects by class, and what notices them",
            figures=[(image, told)],
            tables=[check_table(found, checks)],
            wide=True,
        ),
        Section(
            "missed",
            "Not noticed",
            [] if found.missed or found.alarms else ["Every defect was noticed, and no placebo."],
            tables=[rows_of("Not noticed", found.missed)] * bool(found.missed)
            + [rows_of("Placebos that raised an alarm", found.alarms)] * bool(found.alarms),
        ),
        Section("planted", "Every planted copy", tables=[rows_of("Planted", found.rows)]),
    ]


def rate_table(found: Campaign) -> Table:
    """Table of rates with their intervals."""
    rows = tuple(
        (
            words.name(one),
            str(one.noticed),
            str(one.total),
            f"{100 * one.fraction:.1f} %",
            f"{100 * one.low:.1f} to {100 * one.high:.1f} %",
        )
        for one in found.rates
    )
    return Table(
        "Rates", ("defects", "noticed", "planted", "fraction", "95 % interval"), rows, texts=("95 % interval",)
    )


def check_table(found: Campaign, checks: Sequence[str]) -> Table:
    """Table of checks: how many each notices, how many it alone, and whether it could go."""
    mine, spare = real(found.rows), redundant(found.rows, checks)
    rows = tuple(
        (
            check,
            str(sum(check in row.changed for row in mine)),
            str(alone(found.rows, check)),
            "could go" if check in spare else "",
        )
        for check in checks
    )
    return Table(
        "Checks",
        ("check", "notices", "it alone", "without it nothing is missed"),
        rows,
        texts=("without it nothing is missed",),
    )


def rows_of(caption: str, found: Sequence[Row]) -> Table:
    """Table of planted copies."""
    rows = tuple((row.name, row.kind, row.by, row.method, row.file, words.said(row)) for row in found)
    return Table(
        caption,
        ("defect", "kind", "made by", "method", "file", "noticed by"),
        rows,
        texts=("kind", "made by", "method", "file", "noticed by"),
    )
