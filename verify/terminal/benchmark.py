"""Benchmarks on a terminal: errors with their orders, then numbers beside what they are held against."""

from pathlib import Path

from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.benchmark import control
from mpm_verify.verify.terminal import checks, table


def show(record: Record, page: Path | None) -> None:
    """Print verdicts and checks, as far as there are some."""
    if record.study.plans:
        table.show(record, None)
    checks.show(record, page, control(record), titled=not record.study.plans)
