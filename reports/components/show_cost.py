"""Comparison of many methods for a paper: the table of their orders and errors, and the lines of the cost figure."""

from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.reports import words
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.figures import style
from mpm_verify.reports.figures.convergence import methods
from mpm_verify.reports.figures.cost import Line, Row
from mpm_verify.reports.frames import Record
from mpm_verify.solver.plugins import label


def figure_rows(record: Record) -> list[Row]:
    """Rows of the cost figure: one for each solution, a line for each method and particle count."""
    several = len({s.first.ppc for s in record.series}) > 1
    rows = []
    for solution in record.solutions:
        lines = []
        for s in (s for s in record.series if s.first.solution == solution):
            look = style.look(methods(record), s.first.method, s.first.ppc)
            name = words.series(s.first) if several else words.method(s.first.method)
            lines.append(Line(name, s.runs, look.plot))
        rows.append(Row(label(solution), lines))
    return rows


def overview(record: Record) -> Table:
    """Table for a paper: a row for each method, a column for each solution, last local order of u, relative error."""
    head = ("method", "per cell", *map(label, record.solutions))
    found = {(f.plan.run.method, f.plan.run.ppc, f.plan.run.solution): f for f in record.findings if _is_u(f)}
    keys = list(dict.fromkeys((s.first.method, s.first.ppc) for s in record.series))
    rows = tuple(
        (words.method(m), str(ppc), *(_cell(record, found.get((m, ppc, s))) for s in record.solutions))
        for m, ppc in sorted(keys, key=lambda key: (methods(record).index(key[0]), key[1]))
    )
    caption = "Order of u between the two finest grids that finished, and error there over the exact rms"
    return Table(caption, head, rows, heads=2)


def _is_u(found: Finding) -> bool:
    return (found.plan.quantity, found.plan.norm) == ("u", "rms")


def _cell(record: Record, found: Finding | None) -> str:
    """Cell such as `2.00, 1.2e-4`; `failed` where no run finished."""
    if found is None:
        return words.DASH
    finished = [(run, e) for run, e in record.errors(record.series_of(found.plan), "u", "rms")]
    if not finished:
        return "failed"
    result = record.result(finished[-1][0])
    relative = finished[-1][1] / result.scale["u"] if result and result.scale.get("u") else float("nan")
    orders = found.verdict.local_orders
    text = f"{words.order(orders[-1]) if orders else words.DASH}, {relative:.1e}".replace("e-0", "e-").replace(
        "e+00", ""
    )
    return text if not found.levels[-1].ended else f"{text} at {words.cell_size(finished[-1][0].cells)}, then failed"
