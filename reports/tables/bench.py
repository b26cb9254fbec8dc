"""Table of the speed of methods: what a run of the case bench measured, as text; the same for CSV and Markdown."""

from collections.abc import Mapping, Sequence
from typing import Any

from mpm_verify.reports import words
from mpm_verify.reports.frames import Record
from mpm_verify.reports.tables.markdown import row as row_of
from mpm_verify.solver.plugins import METHODS, create, label

NAMES = ("ns", "ratio", "low", "high", "parallel", "threads")
Rows = Sequence[Mapping[str, Any]]


def rows(record: Record) -> list[dict[str, Any]]:
    """Rows of the runs that came to their end, few support nodes first: what varies, nodes, numbers, processor."""
    found = []
    for run in record.study.runs:
        result = record.result(run)
        if result and not result.failure:
            varied = {name: getattr(run, name) for name in ("method", "over", *record.study.axes)}
            numbers = {name: result.values[name] for name in NAMES}
            nodes = create(METHODS, run.method).support
            found.append(varied | {"nodes": nodes} | numbers | {"processor": processor(result.environment)})
    return sorted(found, key=lambda row: float(row["nodes"]))


def processor(environment: Mapping[str, str]) -> str:
    """Name of the processor, and what compilers call its kind."""
    return f"{environment.get('processor', words.DASH)} ({environment.get('architecture', words.DASH)})"


def head(rows: Rows) -> tuple[str, ...]:
    """Head of the table."""
    over, threads = (list(dict.fromkeys(row[name] for row in rows)) for name in ("over", "threads"))
    than = label(over[0]) if len(over) == 1 else "the other"
    several = words.count(int(float(threads[0])), "thread") if len(threads) == 1 else "threads"
    return (*more(rows), "method", "nodes", "ns", "million/s", f"time over {than}", "quartiles", several)


def more(rows: Rows) -> tuple[str, ...]:
    """Names of what varies beside the method."""
    known = {"method", "nodes", "processor", *NAMES}
    return tuple(name for name in rows[0] if name not in known and len({row[name] for row in rows}) > 1)


def cells(row: Mapping[str, Any], more: Sequence[str]) -> tuple[str, ...]:
    """One row as text."""
    ns, ratio, low, high, parallel, _ = (float(row[name]) for name in NAMES)
    return (*(str(row[name]) for name in more), label(row["method"]), str(row["nodes"]), f"{ns:.0f}",
            f"{1e3 / ns:.1f}", f"{ratio:.2f}", f"{low:.2f}{words.DASH}{high:.2f}", f"{parallel:.2f}")  # fmt: skip


def markdown(rows: Rows) -> str:
    """Table in Markdown."""
    lines = [head(rows), ["---"] * len(head(rows)), *(cells(row, more(rows)) for row in rows)]
    return "".join(f"{line}\n" for line in map(row_of, lines))
