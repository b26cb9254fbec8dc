"""Additions of a column to its JSON document: the paper's sentences, and what refines."""

from dataclasses import asdict
from typing import Any

from mpm_verify.cases.column.records import MEASURES
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import column as words
from mpm_verify.reports.sentences.remarks import lead


def more(record: Record) -> dict[str, Any]:
    """Additions by key: `lead`, `findings`, `measures` (of a length, the usual one first), `paper` and `refinement`."""
    found = record.analysis.more
    return {
        "lead": lead(found.examination),
        "findings": [asdict(finding) for finding in found.examination.findings],
        "measures": {length: list(names) for length, names in MEASURES.items()},
        "paper": [{"says": words.says(claim), **asdict(claim), "found": words.found(claim)} for claim in found.claims],
        "refinement": [asdict(one) for one in found.refined],
    }
