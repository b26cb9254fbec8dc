"""Ledger of the paper on the terminal: a row a claim, what has changed, where the files are. Numbers are in those."""

from collections.abc import Sequence
from pathlib import Path

from rich.text import Text

from mpm_verify.reports.paper.records import Entry, Status
from mpm_verify.reports.paper.registered import Change
from mpm_verify.reports.sentences import paper as words
from mpm_verify.verify.terminal.table import bare, listened

STYLES = {Status.HOLDS: "green", Status.IN_PART: "yellow", Status.NO: "red", Status.OPEN: "dim", Status.NOT_RUN: "dim"}
NARROW = 120


def show(
    mode: str, entries: Sequence[Entry], changes: Sequence[Change], known: set[str], files: Sequence[Path]
) -> None:
    """Print the ledger."""
    out = listened(NARROW)
    table = bare()
    for name in ("claim", "where", "status", "part by part", "hangs on"):
        table.add_column(name, overflow="fold")
    for one in entries:
        parts = words.missing(one) if one.missing else words.of_parts(one.parts).strip(" ()")
        table.add_row(one.claim.id, one.claim.where, Text(str(one.status), STYLES[one.status]),
                      Text(parts + "; crowded" * bool(one.crowded)), " ".join(one.hangs))  # fmt: skip
    out.print(table)
    out.print(f"\n{words.lead(mode, entries)}")
    for change in changes:
        out.print(Text(f"changed: {words.change(change)}", "red"))
    out.print(words.registered(entries, changes, known))
    for path in files:
        out.print(f"{path.suffix[1:]}: {path}", soft_wrap=True)
