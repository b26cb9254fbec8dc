"""Sand in a box on a terminal: its checks, and what a failing control said."""

from pathlib import Path

from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.box import control
from mpm_verify.verify.terminal import checks


def show(record: Record, page: Path | None) -> None:
    """Print the checks."""
    checks.show(record, page, control(record))
