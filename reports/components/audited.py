"""What the auditor said of a solution, as stored with the runs on it: what they cannot see, and what they can."""

from mpm_verify.mms.blind_spots import ALWAYS, BlindSpot
from mpm_verify.reports.frames import Record

ORDERS = {spot.key for spot in ALWAYS}  # these hold for every study, and are said once


def spots(record: Record, solution: str) -> tuple[BlindSpot, ...]:
    """The lines of the auditor; where no run has stored any, those that hold for every solution."""
    found = (r.audit for run in record.study.runs if run.solution == solution and (r := record.result(run)) and r.audit)
    return next(found, ALWAYS)


def blind(record: Record, solution: str) -> list[BlindSpot]:
    """What a study of the solution cannot see."""
    return [spot for spot in spots(record, solution) if spot.blind]


def seen(record: Record, solution: str) -> list[BlindSpot]:
    """What it can, and how strong it is."""
    return [spot for spot in spots(record, solution) if not spot.blind]


def short(record: Record, solution: str) -> str:
    """First sentences of what cannot be seen, for a card: empty if there is nothing but what always holds."""
    sentences = [spot.sentence for spot in blind(record, solution) if spot.key not in ORDERS]
    return " ".join(f"{sentence.split('. ')[0].rstrip('.')}." for sentence in sentences)
