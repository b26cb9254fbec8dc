"""Additions of a table of any code to its JSON document."""

from dataclasses import asdict
from typing import Any

from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import any_code


def more(record: Record) -> dict[str, Any]:
    """Record of how the table was read, and each three levels of values, the finest first."""
    rows = [asdict(one) | {"stricter": any_code.code(one)} for one in record.analysis.more.extrapolated]
    return {"read": list(record.study.words), "extrapolated": rows}
