"""Remarks beside the verdicts that hold for several of them, each said once: sources, edges, what is not seen."""

from collections.abc import Sequence
from dataclasses import dataclass

from mpm_verify.reports.components import audited
from mpm_verify.reports.components.cards import Card
from mpm_verify.reports.frames import Record
from mpm_verify.solver.plugins import label

Said = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Asides:
    """Remarks: (source, what it is of), (solution, edges), (solution, what is not seen); a name only of several."""

    sources: Said
    edges: Said
    unseen: Said


def asides(record: Record, cards: Sequence[Card]) -> Asides:
    """Remarks on the cards of a study."""
    of: dict[str, list[str]] = {}
    for card in cards:
        of.setdefault(card.source or "not given", []).append(card.title.partition(": ")[0])
    return Asides(
        tuple((source, "; ".join(titles) if len(of) > 1 else "") for source, titles in of.items()),
        told(record, [(name, audited.edges(record, (name,))) for name in dict.fromkeys(c.solution for c in cards)]),
        told(record, list(dict.fromkeys((card.solution, card.unseen) for card in cards))),
    )


def told(record: Record, texts: Sequence[tuple[str, str]]) -> Said:
    """Texts that say something, each with the solutions that it is of where the study has several."""
    of: dict[str, list[str]] = {}
    for name, text in texts:
        if text:
            of.setdefault(text, []).append(label(name))
    several = len(record.solutions) > 1
    return tuple((f"{', '.join(names)}: " if several else "", text) for text, names in of.items())
