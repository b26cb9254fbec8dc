"""Where orders fall, and why, in words: one entry a series whose displacement stalls."""

from dataclasses import dataclass

from mpm_verify.cases.harness.verdicts import STALLS, Finding
from mpm_verify.cases.judging.stall import Stall
from mpm_verify.reports.components import words
from mpm_verify.reports.frames import Record
from mpm_verify.solver.plugins import on_screen


@dataclass(frozen=True)
class Told:
    """What is said of one stall: its series, where it is, what is named as its cause, and the numbers in sentences."""

    title: str
    where: str
    cause: str
    sentences: tuple[str, ...]


def stalls(record: Record) -> list[Told]:
    """The stalls of the study in the order of its declarations."""
    return [_told(record, f, f.stall) for f in record.findings if f.stall]


def short(found: Finding) -> str:
    """One sentence for the card of a finding; empty without a stall."""
    if not found.stall:
        return ""
    return f"{words.prose(found.stall.where[:1].upper() + found.stall.where[1:])}. {_cause(found.stall)}"


def looked(record: Record) -> bool:
    """Whether any series has the two orders that a fall needs."""
    return any(len(f.verdict.local_orders) > 1 for f in record.findings if (f.plan.quantity, f.plan.norm) == STALLS)


def _cause(stall: Stall) -> str:
    names = [cause.name for cause in stall.named]
    return f"By the numbers: {' and '.join(names)}." if names else "The numbers name no cause."


def _told(record: Record, found: Finding, stall: Stall) -> Told:
    title = words.series(found.plan) + (f", {on_screen(found.plan.solution)}" if len(record.solutions) > 1 else "")
    sentences = tuple(words.prose(_names(text)) for text in stall.why)
    return Told(title, words.prose(stall.where), _cause(stall), sentences)


def _names(text: str) -> str:
    """Methods as people write them, where a sentence compares with one."""
    for name, written in words.METHODS.items():
        text = text.replace(f"; {name} ", f"; {written} ")
    return text
