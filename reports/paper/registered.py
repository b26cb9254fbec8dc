"""Registered statuses and numbers of the ledger, a file for each mode, and what has changed against them.

Numbers of manufactured solutions and of the block are held to round-off of their sums; those of columns, whose motion
magnifies the last bit, to some hundredths. Numbers that are times are not held.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpm_verify.reports.paper.records import Entry, Status

FOLDER = Path(__file__).with_name("registered")
EXACT, FLOOR = 1e-6, 1e-12  # relative, and what is round-off
LOOSE = 0.02  # of columns, relative, and absolute below 1
COLUMNS = ("3", "4", "5", "6", "7", "8", "methods")  # parts of the paper whose runs are columns
Row = dict[str, Any]


@dataclass(frozen=True)
class Change:
    """Change of a claim against what is registered: of its status, of one under another reading, or of a number."""

    claim: str
    what: str
    registered: Any
    found: Any


def file_of(mode: str) -> Path:
    """File of a mode."""
    return FOLDER / f"{mode}.json"


def registered(mode: str) -> dict[str, Row]:
    """Rows by claim; none where nothing is registered."""
    path = file_of(mode)
    rows: dict[str, Row] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return rows


def row(entry: Entry) -> Row:
    """Row of an entry as it is registered."""
    tried = (one for one in entry.under if one.status is not Status.NOT_RUN)
    under = {f"{one.reading} {one.value}": str(one.status) for one in tried}
    numbers = {} if entry.claim.timed else {name: float(f"{value:.9g}") for name, value in entry.numbers.items()}
    return {"status": str(entry.status), "under": under, "numbers": numbers}


def register(entries: Sequence[Entry], mode: str) -> Path:
    """Write the rows of all entries that have come to something, and keep the others as they were."""
    rows = registered(mode) | {one.claim.id: row(one) for one in entries if one.status is not Status.NOT_RUN}
    order = [one.claim.id for one in entries]
    kept = {name: rows[name] for name in order if name in rows}
    FOLDER.mkdir(exist_ok=True)
    file_of(mode).write_text(json.dumps(kept, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return file_of(mode)


def changes(entries: Sequence[Entry], rows: Mapping[str, Row], complete: bool) -> list[Change]:
    """Changes of entries against registered rows; what is not run is one where all studies were asked for."""
    found: list[Change] = []
    for entry in entries:
        if entry.claim.id in rows and (complete or entry.status is not Status.NOT_RUN):
            found += changed(entry, rows[entry.claim.id], complete)
    return found


def changed(entry: Entry, known: Row, complete: bool) -> Iterator[Change]:
    """Changes of one entry."""
    now, name = row(entry), entry.claim.id
    if now["status"] != known["status"]:
        yield Change(name, "status", known["status"], now["status"])
    for reading, before in known["under"].items():
        after = now["under"].get(reading, str(Status.NOT_RUN))
        if before != after and (complete or reading in now["under"]):
            yield Change(name, f"status under {reading}", before, after)
    for what in dict.fromkeys([*known["numbers"], *now["numbers"]]):
        one, other = known["numbers"].get(what), now["numbers"].get(what)
        if one is None or other is None or not near(one, other, entry.claim.part in COLUMNS):
            yield Change(name, what, one, other)


def near(one: float, other: float, column: bool) -> bool:
    """Whether a number is the registered one."""
    if column:
        return abs(other - one) <= LOOSE * max(1.0, abs(one))
    return abs(other - one) <= max(FLOOR, EXACT * abs(one))
