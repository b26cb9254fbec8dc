"""Ledger: each claim answered by its rule, under our readings and, one at a time, under the others that it asks for."""

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from mpm_verify.reports.paper.evidence import Evidence
from mpm_verify.reports.paper.records import Answer, Chosen, Claim, Entry, NotStoredError, Reading, Status, Under
from mpm_verify.reports.paper.rules import RULES

TABLE = Path(__file__).with_name("claims.toml")


@cache
def _content() -> dict[str, Any]:
    return tomllib.loads(TABLE.read_text(encoding="utf-8"))


def claims() -> list[Claim]:
    """Claims in the order of the paper."""
    rows: dict[str, dict[str, Any]] = _content()["claim"]
    lists = {name: {key: tuple(row.get(key, ())) for key in ("studies", "readings")} for name, row in rows.items()}
    return [Claim(**{"id": name, **row, **lists[name]}) for name, row in rows.items()]


def readings() -> list[Reading]:
    """Readings of what the paper leaves open."""
    return [Reading(**{**row, "others": tuple(row.get("others", ()))}) for row in _content()["reading"]]


def usual() -> dict[str, Any]:
    """Our values of the readings that rules ask for, by their keys."""
    return {one.key: one.usual for one in readings() if one.key}


def ledger(seen: Evidence, among: Sequence[str] | None = None) -> list[Entry]:
    """Entries of all claims, or of some by their names."""
    return [entry(claim, seen) for claim in claims() if among is None or claim.id in among]


def entry(claim: Claim, seen: Evidence) -> Entry:
    """Entry of a claim: what its rule says, and what it says under each other reading that it asks for."""
    rule = RULES.get(claim.id)
    if rule is None:
        return Entry(claim, Status.OPEN)
    chosen = Chosen(usual())
    try:
        found = rule(seen, chosen)
    except NotStoredError as gone:
        return Entry(claim, gone.status, missing=str(gone))
    under = tuple(each for reading in readings() if reading.key in chosen.asked
                  for each in others(reading, lambda at: rule(seen, at)))  # fmt: skip
    return Entry(claim, found.status, found.parts, found.numbers, found.crowded, under, tuple(sorted(chosen.asked)))


def others(reading: Reading, rule: Any) -> Iterator[Under]:
    """Statuses of a claim under the other values of a reading."""
    for value in reading.others:
        at = usual() | {reading.key: value}
        try:
            found: Answer = rule(at)
        except NotStoredError as gone:
            yield Under(reading.id, reading.name, str(value), gone.status, {})
        else:
            yield Under(reading.id, reading.name, str(value), found.status, found.parts)


def counts(found: Sequence[Entry]) -> Mapping[Status, int]:
    """Number of entries of each status that there is."""
    each = [one.status for one in found]
    return {status: each.count(status) for status in Status if status in each}
