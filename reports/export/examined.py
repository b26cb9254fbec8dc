"""Additions of Examinations to their JSON document: what came out, and parameters."""

from dataclasses import asdict
from typing import Any

from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.remarks import lead, parameters


def more(record: Record) -> dict[str, Any]:
    """Additions by name of the examination: `lead`, `findings` and `parameters`."""
    return {
        name: {
            "lead": lead(one),
            "findings": [asdict(finding) for finding in one.findings],
            "parameters": parameters(one),
        }
        for name, one in record.analysis.more.examinations.items()
    }
