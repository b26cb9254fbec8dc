"""Ledger of the paper as files: ledger.json with all there is, ledger.csv with a row a claim, ledger.md to read."""

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from mpm_verify.cases.harness.store import Store, make
from mpm_verify.reports.export.document import finite
from mpm_verify.reports.paper.evidence import Evidence
from mpm_verify.reports.paper.ledger import counts, readings
from mpm_verify.reports.paper.records import Entry, NotStoredError
from mpm_verify.reports.paper.registered import Change
from mpm_verify.reports.sentences import paper as words

VERSION = 1
COLUMNS = ("claim", "where", "part", "status", "parts", "numbers", "crowded", "hangs on", "missing", "text")


def write(folder: Path, mode: str, entries: Sequence[Entry], changes: Sequence[Change]) -> list[Path]:
    """Write the three files into the folder; their paths. Raises StoreError."""
    make(folder)
    texts = {
        "ledger.json": json.dumps(document(mode, entries, changes), indent=1, ensure_ascii=False, allow_nan=False)
        + "\n",
        "ledger.csv": table(entries),
        "ledger.md": markdown(mode, entries, changes),
    }
    for name, text in texts.items():
        Store.write(folder / name, text.encode())
    return [folder / name for name in texts]


TABLES = {"table1": "figure3", "table2": "ubcsand"}  # of the paper, and the study whose parameters it has


def tables(folder: Path, seen: Evidence) -> list[Path]:
    """Write table1.csv and table2.csv, the parameters that runs had, as far as these are stored; their paths."""
    paths = []
    for name, study in TABLES.items():
        try:
            result = seen.one(study)
        except NotStoredError:
            continue
        own = {key.removeprefix("material "): value for key, value in result.parameters.items()}
        rows = {**({"width": result.run.width, "height": result.run.height} if name == "table1" else {}), **own}
        text = "".join(f"{key},{value}\n" for key, value in {"parameter": "value", **rows}.items())
        paths.append(folder / f"{name}.csv")
        Store.write(paths[-1], text.encode())
    return paths


def document(mode: str, entries: Sequence[Entry], changes: Sequence[Change]) -> Mapping[str, Any]:
    """Content of ledger.json."""
    return {
        "version": VERSION,
        "mode": mode,
        "counts": {str(status): count for status, count in counts(entries).items()},
        "claims": [finite({**asdict(one), "hangs": list(one.hangs)}) for one in entries],
        "readings": [asdict(one) for one in readings()],
        "changes": [finite(asdict(one)) for one in changes],
    }


def table(entries: Sequence[Entry]) -> str:
    """Content of ledger.csv; numbers with all digits."""
    out = io.StringIO()
    rows = csv.writer(out, lineterminator="\n")
    rows.writerow(COLUMNS)
    for one in entries:
        parts = "; ".join(f"{name}: {words.ANSWERS[answer]}" for name, answer in one.parts.items())
        numbers, crowded = ("; ".join(f"{name} = {value!r}" for name, value in of.items())
                            for of in (one.numbers, one.crowded))  # fmt: skip
        rows.writerow((one.claim.id, one.claim.where, one.claim.part, str(one.status), parts, numbers, crowded,
                       " ".join(one.hangs), one.missing, one.claim.claim))  # fmt: skip
    return out.getvalue()


def markdown(mode: str, entries: Sequence[Entry], changes: Sequence[Change]) -> str:
    """Content of ledger.md: statuses at a glance, then each claim, then readings."""
    lines = [f"# {words.TITLE}", "", words.lead(mode, entries), ""]
    if changes:
        lines += ["## Changed against what is registered", "", *(f"- {words.change(one)}" for one in changes), ""]
    lines += ["| claim | where | status | hangs on |", "| --- | --- | --- | --- |"]
    lines += [f"| [{one.claim.id}](#{one.claim.id.lower()}) | {one.claim.where} | {one.status} | "
              f"{', '.join(one.hangs)} |" for one in entries]  # fmt: skip
    for one in entries:
        lines += ["", f"## {one.claim.id}", "", f"{one.claim.claim} ({one.claim.where})", ""]
        lines += [f"- {text}" for text in words.told(one)]
    lines += ["", "## Readings", "", "| reading | what | the paper | here | tried, or what would change |",
              "| --- | --- | --- | --- | --- |"]  # fmt: skip
    lines += [f"| {one.id} | {one.name} | {one.paper} | {one.ours} | {one.changes} |" for one in readings()]
    return "\n".join(lines) + "\n"
