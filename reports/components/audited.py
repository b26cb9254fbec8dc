"""Audit of a solution, as stored with the runs on it: what they cannot see, and what they can."""

from collections.abc import Sequence

from mpm_verify.mms.blind_spots import ALWAYS, BlindSpot, BlindSpotCode
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import blind_spots as words


def blind_spots(record: Record, solution: str) -> tuple[BlindSpot, ...]:
    """Findings of the audit; where no run has stored any, those that hold for every solution."""
    found = (r.audit for run in record.study.runs if run.solution == solution and (r := record.result(run)) and r.audit)
    return next(found, ALWAYS)


def blind(record: Record, solution: str) -> list[str]:
    """Sentences on what a study of the solution cannot see."""
    return [words.sentence(spot) for spot in blind_spots(record, solution) if spot.blind]


def seen(record: Record, solution: str) -> list[str]:
    """Sentences on what it can, and how strong it is."""
    return [words.sentence(spot) for spot in blind_spots(record, solution) if not spot.blind]


def short(record: Record, solution: str) -> str:
    """Text on what cannot be seen, for a card: empty if nothing but what always holds, which is said once."""
    return " ".join(words.unseen(spot) for spot in blind_spots(record, solution) if spot.blind and spot not in ALWAYS)


def unseen(record: Record) -> str:
    """Text on what no solution of the study can see: one may see what another does not."""
    audits = [blind_spots(record, solution) for solution in record.solutions]
    codes = [{spot.code for spot in spots if spot.blind} for spots in audits]
    common = set.intersection(*codes) if codes else set()
    told = {spot.code: words.unseen(spot) for spots in audits for spot in spots if spot.code in common}
    return " ".join(told.values())


def edges(record: Record, solutions: Sequence[str]) -> str:
    """Text on the edges of solutions that are pulled or driven; empty where there are none."""
    spots = [spot for solution in solutions for spot in blind_spots(record, solution)]
    return " ".join(dict.fromkeys(words.sentence(spot) for spot in spots if spot.code is BlindSpotCode.EDGES))
