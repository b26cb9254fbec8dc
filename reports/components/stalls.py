"""Stalls in words, where orders fall and why: one entry for each series whose displacement stalls."""

from dataclasses import dataclass

from mpm_verify.cases.harness.verdicts import STALLS, Finding
from mpm_verify.cases.judging.stall import Stall
from mpm_verify.reports import words
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import stalls as sentences


@dataclass(frozen=True)
class Told:
    """Text of one stall: its series, where it is, what is named as its cause, and the numbers in sentences."""

    title: str
    where: str
    cause: str
    sentences: tuple[str, ...]


def stalls(record: Record) -> list[Told]:
    """Stalls of the study in the order of its plans."""
    return [_told(record, f, f.stall) for f in record.findings if f.stall]


def short(found: Finding) -> str:
    """One sentence for the card of a finding; empty without a stall."""
    if not found.stall:
        return ""
    return f"{words.sentence(sentences.where(found.stall))} {sentences.cause(found.stall)}"


def looked(record: Record) -> bool:
    """Whether any series has the two orders that a fall needs."""
    return any(len(f.verdict.local_orders) > 1 for f in record.findings if (f.plan.quantity, f.plan.norm) == STALLS)


def _told(record: Record, found: Finding, stall: Stall) -> Told:
    title = record.label(found.plan.run)
    return Told(title, sentences.where(stall), sentences.cause(stall), tuple(sentences.why(stall)))
