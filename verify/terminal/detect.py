"""Campaign of planted defects on a terminal: rates, and what noticed each one where there are few."""

from pathlib import Path

from mpm_verify.cases.detect.defect import NONE
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.detect import said
from mpm_verify.verify.terminal import checks

FEW = 12  # defects that are told one by one


def show(record: Record, page: Path | None) -> None:
    """Print the rates, and for each of few defects what noticed it."""
    rows = [row for row in record.analysis.more.rows if row.name != NONE]
    lines = [f"{row.name}, {row.method}: {said(row)}" for row in rows]
    checks.show(record, page, "\n".join(lines) if len(rows) <= FEW else "")
