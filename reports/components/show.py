"""The tables of errors and orders as the page shows them: text cells; full digits are in the CSV files."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain, pairwise

from mpm_verify.cases.harness.series import Series
from mpm_verify.cases.harness.study import NORMS, QUANTITIES, QuantityPlan, Run
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.order import Outcome
from mpm_verify.reports.components import words
from mpm_verify.reports.figures.local_orders import orders
from mpm_verify.reports.frames import Record
from mpm_verify.reports.tables import study as tables
from mpm_verify.solver.plugins import on_screen

NAMES = {"u": "displacement u", "v": "velocity v", "F": "deformation gradient F", "sigma": "Cauchy stress"}
Row = tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """A table as text. `heads` row-heading columns come first; the others hold numbers, but those named in `texts`."""

    caption: str
    head: Row
    rows: tuple[Row, ...]
    heads: int = 1
    texts: Row = ()


def judged_errors(record: Record) -> Table:
    """Errors of what the study judges."""
    return _errors(record, "Judged errors", [(s, q, n) for s in record.series for q, n in _keys(record, s, "judged")])


def shown_errors(record: Record, quantity: str) -> Table:
    """Errors of one quantity that are shown only, in all norms."""
    keys = [(s, q, n) for s in record.series for q, n in _keys(record, s, "shown") if q == quantity]
    return _errors(record, f"Shown only: errors of the {NAMES[quantity]}", keys)


def judged_orders(record: Record) -> Table:
    """Local orders of what the study judges, with the fitted order."""
    return _orders(
        record,
        "Judged: order between neighbouring cell sizes",
        [(s, *k) for s in record.series for k in _keys(record, s, "judged")],
    )


def shown_displacements(record: Record) -> Table:
    """Local orders of u in rms where they are not judged."""
    keys = [(s, "u", "rms") for s in record.series if ("u", "rms") in _keys(record, s, "shown")]
    return _orders(record, "Shown only: order of u between neighbouring cell sizes", keys)


def shown_orders(record: Record) -> Table:
    """Local orders of what else is only shown: the other quantities in rms, and u as printed."""
    wanted = {(q, "rms") for q in QUANTITIES if q != "u"} | {("u", "printed")}
    keys = [(s, *k) for k in sorted(wanted, key=_place) for s in record.series if k in _keys(record, s, "shown")]
    return _orders(record, "Shown only: order between neighbouring cell sizes", keys)


def contamination(record: Record) -> Table:
    """Shares of the finest error, judged quantities first."""
    found = sorted((f for f in record.findings if f.verdict.contamination), key=lambda f: not f.plan.judged)
    rows = []
    for f in found:
        shares, d = f.verdict.contamination, f.plan
        if shares is not None:
            name = f"{words.quantity(d.quantity)}, {d.norm}"
            share = (words.percent(s) for s in (shares.lower, shares.floor, shares.most))
            rows.append((named(record, d), name, "judged" if d.judged else "shown only", *share))
    head = ("series", "quantity", "role", "lower order", "floor", "at most")
    return Table("Shares of the finest error that are not of the expected order", head, tuple(rows), heads=3)


def shown_verdicts(record: Record) -> Table:
    """Slopes of what is only shown; where something was expected, what the rule would say of it."""
    head = ("series", "quantity", "observed order", "interval", "expected", "the rule would say")
    found = [f for f in record.findings if not f.plan.judged]
    known = [f for f in found if f.plan.expectation or f.verdict.observed is not None]
    rows = tuple(_shown(record, f) for f in known)
    return Table("Shown only: fitted orders", head, rows, heads=2, texts=head[4:])


def _keys(record: Record, series: Series, role: str) -> list[tuple[str, str]]:
    """(quantity, norm) of that role, in the order of the contract."""
    first, known = series.first, tables.roles(record)
    every = [(q, n) for q in QUANTITIES for n in NORMS]
    return [k for k in every if known.get((first.method, first.solution, first.ppc, *k), "shown") == role]


def _place(key: tuple[str, str]) -> tuple[int, int]:
    return NORMS.index(key[1]), QUANTITIES.index(key[0])


def _cells(record: Record) -> list[int]:
    return sorted({run.cells for s in record.series for run in s.runs})


def named(record: Record, of: Run | QuantityPlan) -> str:
    """The series, with its solution where the study has more than one."""
    return words.series(of) + (f", {on_screen(of.solution)}" if len(record.solutions) > 1 else "")


def _errors(record: Record, caption: str, keys: Iterable[tuple[Series, str, str]]) -> Table:
    """A column a cell size."""
    cells, rows = _cells(record), []
    for s, quantity, norm in keys:
        means = dict(record.errors(s, quantity, norm))
        at = {run.cells: words.sci(means[run]) if run in means else _without(record, s, run) for run in s.runs}
        rows.append(
            (named(record, s.first), f"{words.quantity(quantity)}, {norm}", *(at.get(n, words.DASH) for n in cells))
        )
    return Table(caption, ("series", "error of, in", *(words.cell_size(n) for n in cells)), tuple(rows), heads=2)


def _without(record: Record, series: Series, run: Run) -> str:
    """Why a level has no error."""
    return "failed" if run in record.failed(series) else "not run"


def _orders(record: Record, caption: str, keys: Iterable[tuple[Series, str, str]]) -> Table:
    """A column a pair of cell sizes, the crossings per particle of the finer one beside it, then the fitted order."""
    cells, rows = _cells(record), []
    passed = tables.crossings(record)
    fitted = {tables.key(f.plan): words.order(f.verdict.observed) for f in record.findings}
    columns = list(pairwise(cells))
    for s, quantity, norm in keys:
        found = {(a, b): words.order(p) for a, b, p in orders(record, s, quantity, norm)}
        first = s.first
        fit = fitted.get((first.method, first.solution, first.ppc, quantity, norm), words.DASH)
        steps = [
            (found.get((a, b), words.DASH), words.few(passed.get((first.method, first.solution, first.ppc, b))))
            for a, b in columns
        ]
        rows.append((named(record, first), f"{words.quantity(quantity)}, {norm}", *chain(*steps), fit))
    pairs = [(f"{words.cell_size(a)} → {words.cell_size(b)}", "crossings") for a, b in columns]
    return Table(caption, ("series", "order of, in", *chain(*pairs), "fitted"), tuple(rows), heads=2)


def _shown(record: Record, found: Finding) -> Row:
    d, v = found.plan, found.verdict
    says = words.DASH if d.expectation is None else str(v.outcome)
    if d.expectation and d.expectation.order is None and v.outcome is Outcome.PASS:
        says += " (diverges, as expected)"
    name = f"{words.quantity(d.quantity)}, {d.norm}"
    return named(record, d), name, words.order(v.observed), words.interval(v.interval), words.expected(d), says
