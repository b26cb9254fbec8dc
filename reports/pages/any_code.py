"""Page of a table of any code: verdicts and errors as of any study, extrapolations of values, the rows as they were."""

from pathlib import Path

from mpm_verify.cases.any_code.case import Extrapolated
from mpm_verify.cases.any_code.run import HALF
from mpm_verify.reports import words
from mpm_verify.reports.components.examined import Section
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.frames import Record
from mpm_verify.reports.pages import _plain
from mpm_verify.reports.sentences import any_code, failures

HEAD = ("refinement", "levels", "order", "extrapolated", "GCI", "here", "\N{PLUS-MINUS SIGN}", "where ours is stricter")
PROCEDURE = (
    "Order, extrapolated value and grid convergence index (GCI) of each three consecutive levels, the finest first, by "
    "the procedure of Celik et al. (2008), doi:10.1115/1.2960953; beside them the value and the uncertainty that are "
    "used here, and where they come from a stricter rule. The verdict rests on the refinement as a whole."
)


def page(record: Record, vtk: bool = False) -> Path:
    """Write the page, figures and tables; its path. Raises StoreError."""
    found = record.analysis.more.extrapolated
    more = [extrapolations(record, found)] if found else []
    return _plain.page(record, vtk, more, rows(record))


def extrapolations(record: Record, found: tuple[Extrapolated, ...]) -> Section:
    """Section of three levels each."""
    made = tuple(
        (
            f"{one.method}, {one.measured}", any_code.sized(one.h, record.by), words.order(one.index.order),
            f"{one.index.limit:.6g}", words.percent(one.index.index, 2), f"{one.ours.finest:.6g}",
            words.short(one.ours.uncertainty), any_code.stricter(one),
        )
        for one in found
    )  # fmt: skip
    table = Table("Three levels each", HEAD, made, texts=("levels", "where ours is stricter"))
    return Section("extrapolated", "Richardson extrapolation and grid convergence index", [PROCEDURE], tables=[table])


def rows(record: Record) -> Section:
    """Section of the rows of the table, in its order."""
    head = ("line", "method", "quantity", record.by, "replicate", "time step", "number", "failed")
    made = []
    coarsest = [s.first for s in record.series if not s.first.exact]  # of values: no error can be estimated of it
    for run in coarsest:
        made.append((words.DASH, run.method, run.measured, record.named(run.coarser_h), "1", words.DASH,
                     f"{run.coarser:.10g}", ""))  # fmt: skip
    for run in sorted(record.study.runs, key=lambda run: (run.line, -run.courant)):
        result = record.result(run)
        why = failures.failure(result.failure) if result and result.failure else ""
        half = "half" if run.courant == HALF else "none" if run.steady else "whole"
        made.append((str(run.line), run.method, run.measured, record.named(run.h), f"{run.offset[0] + 1:.0f}",
                     half, f"{run.number:.10g}", why))  # fmt: skip
    return Section("rows", "Rows", tables=[Table("Rows of the table", head, tuple(made), heads=0, texts=head[1:3])])
