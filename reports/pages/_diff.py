"""Page of two studies compared: how many of what differ, then verdicts, orders, ends of runs and numbers."""

from collections.abc import Sequence
from pathlib import Path

from mpm_verify.cases.harness.store import Store
from mpm_verify.reports import words
from mpm_verify.reports.compared import Change, alone
from mpm_verify.reports.components.badges import Badge
from mpm_verify.reports.components.page import whole
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.frames import Record

KINDS = {
    "verdict": "Verdicts and checks", "order": "Observed orders", "status": "Ends of runs",
    "number": "Errors and values",
}  # fmt: skip
HEAD = ("what", "before", "after", "after / before")


def page(path: Path, a: Record, b: Record, found: Sequence[Change], both: int, tolerance: float) -> Path:
    """Write the page of the changes from a to b; its path. Raises StoreError."""
    mine = {kind: [one for one in found if one.kind == kind] for kind in KINDS}
    text = whole(
        "diff.html.j2",
        f"{a.study.title}: {a.store.folder} against {b.store.folder}",
        study=a.study,
        folders=(a.store.folder, b.store.folder),
        found=[
            Badge("FAIL" if some else "PASS", str(len(some)), f"{KINDS[kind].lower()} differ", kind)
            for kind, some in mine.items()
        ],
        tables=[(kind, KINDS[kind], table(KINDS[kind], some)) for kind, some in mine.items()],
        both=both,
        count=len(found),
        tolerance=tolerance,
        only=[[f"{run}" for run in some] for some in alone(a, b)],
    )
    Store.write(path, text.encode())
    return path


def table(caption: str, found: Sequence[Change]) -> Table:
    """Table of changes of one kind, below what each is of."""
    rows = [(one.of, one.what, words.value(one.before), words.value(one.after), one.ratio) for one in found]
    return Table(caption, ("of", *HEAD), tuple(rows), heads=2, grouped=True)
