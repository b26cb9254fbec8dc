"""Study of Examinations on a terminal: each part with its checks, and what came out in words."""

from pathlib import Path

from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.remarks import leads
from mpm_verify.verify.terminal import checks


def show(record: Record, page: Path | None) -> None:
    """Print the checks and what came out."""
    checks.show(record, page, "\n".join(leads(record.analysis.more.examinations)))
