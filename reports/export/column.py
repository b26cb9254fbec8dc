"""What the JSON document of a column has beside that of any study: the paper's sentences, and what refines."""

from dataclasses import asdict
from typing import Any

from mpm_verify.reports.frames import Record


def more(record: Record) -> dict[str, Any]:
    """`lead`, `paper` and `refinement`."""
    found = record.analysis.more
    return {
        "lead": found.examination.lead,
        "paper": [asdict(claim) for claim in found.claims],
        "refinement": [asdict(one) for one in found.refined],
    }
