"""Tables of the runs: how each ended, with what parameters, on what machine."""

from collections.abc import Sequence
from dataclasses import asdict, replace

from mpm_verify.cases.harness.axes import cell_crossings
from mpm_verify.cases.mms.run import Run
from mpm_verify.reports import words
from mpm_verify.reports.components.table import Row, Table
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import failures
from mpm_verify.solver.plugins import is_file, label, split


def runs(record: Record) -> Table:
    """Table of every run, and how it ended."""
    head = (
        *("method", "cells", "per cell", "status", "Courant", "shift", "steps", "particles", "crossings", "gap"),
        *("wall time", "memory", "reason"),
    )
    rows = tuple(_run(record, run) for run in record.study.runs)
    texts = ("status", "reason", "solution")
    return Table("All runs of the study", _with_solution(record, head), rows, heads=3, texts=texts)


def parameters(record: Record) -> Table:
    """Table of every parameter of every run."""
    names = tuple(asdict(record.study.runs[0])) if record.study.runs else ()
    rows = []
    for run in record.study.runs:
        result = record.result(run)
        ends = (words.sci(result.dt), result.digest) if result else (words.DASH, run.digest)
        values = {**asdict(run), "solution": label(run.solution)}
        rows.append((*(_text(value) for value in values.values()), *ends))
    return Table(
        "Parameters of every run",
        (*names, "dt", "name of the result"),
        tuple(rows),
        heads=0,
        texts=(*names, "name of the result"),
    )


def problem(record: Record) -> Table:
    """Table of every parameter of solution and material, the defaults too, with the runs that it holds for.

    A user's file stands here by its whole path, once.
    """
    files = sorted({split(name)[0] for name in record.solutions if is_file(name)})
    found = _shared(record, "parameters", "The problem")
    rows = tuple(("solution file", file, f"solution {label(file)}") for file in files)
    return replace(found, rows=(*rows, *found.rows))


def environment(record: Record) -> Table:
    """Table of versions, commit and processor, with the number of runs that each holds for."""
    return _shared(record, "environment", "Where it ran")


def _shared(record: Record, field: str, caption: str) -> Table:
    """Table of a dictionary that every Result has: one row for each value."""
    found = [r for run in record.study.runs if (r := record.result(run))]
    rows = []
    for name in sorted({key for result in found for key in getattr(result, field)}):
        values = [_text(getattr(result, field).get(name, words.DASH)) for result in found]
        for value in sorted(set(values)):
            rows.append(
                (
                    name,
                    value,
                    "all stored runs" if values.count(value) == len(found) else words.count(values.count(value), "run"),
                )
            )
    return Table(caption, ("what", "value", "holds for"), tuple(rows), texts=("value", "holds for"))


def _with_solution(record: Record, row: Sequence[str], run: Run | None = None) -> Row:
    """Row with a column for the solution where there is more than one."""
    if len(record.solutions) < 2:
        return tuple(row)
    return (*row, label(run.solution) if run else "solution")


def _run(record: Record, run: Run) -> Row:
    """Row of one run, and how it ended."""
    head, result = (words.method(run.method), str(run.cells), str(run.ppc)), record.result(run)
    point = (f"{run.courant:g}", words.shift(run))
    if result is None:
        return _with_solution(record, (*head, "not run", *point, *(words.DASH,) * 6, "to be done"), run)
    numbers = (f"{result.steps}", f"{result.particles}", words.few(cell_crossings(result)), words.few(result.gap))
    costs = (f"{result.wall_s:.2f} s", f"{result.peak_memory_mb:.0f} MB")
    reason = failures.failure(result.failure) if result.failure else ""
    return _with_solution(record, (*head, result.status, *point, *numbers, *costs, reason), run)


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:g}" if isinstance(value, float) else str(value)
