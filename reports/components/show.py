"""Tables of errors and orders as the page shows them: text cells; full digits are in the CSV files."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain, pairwise

from mpm_verify.cases.harness.refinement import Series
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.order import Outcome
from mpm_verify.cases.mms.run import NORMS, QUANTITIES, Run
from mpm_verify.reports import words
from mpm_verify.reports.figures.local_orders import orders
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import verdicts
from mpm_verify.reports.tables import mms as tables

NAMES = {"u": "displacement u", "v": "velocity v", "F": "deformation gradient F", "sigma": "Cauchy stress"}
Row = tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """Table as text. `heads` row-heading columns come first; the others hold numbers, but those named in `texts`."""

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
        "Judged: order between consecutive cell sizes",
        [(s, *k) for s in record.series for k in _keys(record, s, "judged")],
    )


def shown_displacements(record: Record) -> Table:
    """Local orders of u in rms where they are not judged."""
    keys = [(s, "u", "rms") for s in record.series if ("u", "rms") in _keys(record, s, "shown")]
    return _orders(record, "Shown only: order of u between consecutive cell sizes", keys)


def shown_orders(record: Record) -> Table:
    """Local orders of what else is only shown: the other quantities in rms, and u as printed."""
    wanted = {(q, "rms") for q in QUANTITIES if q != "u"} | {("u", "printed")}
    keys = [(s, *k) for k in sorted(wanted, key=_rank) for s in record.series if k in _keys(record, s, "shown")]
    return _orders(record, "Shown only: order between consecutive cell sizes", keys)


def contamination(record: Record) -> Table:
    """Fractions of the finest error, judged quantities first."""
    found = sorted((f for f in record.findings if f.verdict.contamination), key=lambda f: not f.counts)
    rows = []
    for f in found:
        mixed, plan = f.verdict.contamination, f.plan
        if mixed is not None:
            name = f"{words.quantity(plan.quantity)}, {plan.norm}"
            fractions = (words.percent(part) for part in (mixed.lower, mixed.floor, mixed.most))
            rows.append((record.label(plan.run), name, "judged" if f.counts else "shown only", *fractions))
    head = ("series", "quantity", "role", "lower order", "floor", "at most")
    return Table("Fractions of the finest error that are not of the expected order", head, tuple(rows), heads=3)


def shown_verdicts(record: Record) -> Table:
    """Slopes of what is only shown; where something was expected, what the rule would say of it."""
    head = ("series", "quantity", "observed order", "interval", "expected", "the rule would say")
    found = [f for f in record.findings if not f.counts]
    known = [f for f in found if f.plan.expectation or f.verdict.observed is not None]
    rows = tuple(_shown(record, f) for f in known)
    return Table("Shown only: fitted orders", head, rows, heads=2, texts=head[4:])


def _keys(record: Record, series: Series, role: str) -> list[tuple[str, str]]:
    """Pairs (quantity, norm) of that role, in the order of the contract."""
    known = tables.roles(record)
    every = [(q, n) for q in QUANTITIES for n in NORMS]
    return [k for k in every if known.get((series.head, *k), "shown") == role]


def _rank(key: tuple[str, str]) -> tuple[int, int]:
    return NORMS.index(key[1]), QUANTITIES.index(key[0])


def _cells(record: Record) -> list[int]:
    return sorted({run.cells for s in record.series for run in s.runs})


def _errors(record: Record, caption: str, keys: Iterable[tuple[Series, str, str]]) -> Table:
    """Table of errors, a column for each cell size."""
    cells, rows = _cells(record), []
    for s, quantity, norm in keys:
        means = dict(record.errors(s, quantity, norm))
        at = {run.cells: words.sci(means[run]) if run in means else _without(record, s, run) for run in s.runs}
        rows.append(
            (record.label(s.first), f"{words.quantity(quantity)}, {norm}", *(at.get(n, words.DASH) for n in cells))
        )
    return Table(caption, ("series", "error of, in", *(words.cell_size(n) for n in cells)), tuple(rows), heads=2)


def _without(record: Record, series: Series, run: Run) -> str:
    """Reason why a level has no error."""
    return "failed" if run in record.failed(series) else "not run"


def _orders(record: Record, caption: str, keys: Iterable[tuple[Series, str, str]]) -> Table:
    """Table of orders: a column for each pair of cell sizes, crossings per particle beside it, then the fit."""
    cells, rows = _cells(record), []
    passed = tables.crossings(record)
    fitted = {tables.key(f.plan): words.order(f.verdict.observed) for f in record.findings}
    columns = list(pairwise(cells))
    for s, quantity, norm in keys:
        found = {(a, b): words.order(p) for a, b, p in orders(record, s, quantity, norm)}
        fit = fitted.get((s.head, quantity, norm), words.DASH)
        steps = [(found.get((a, b), words.DASH), words.few(passed.get((s.head, b)))) for a, b in columns]
        rows.append((record.label(s.first), f"{words.quantity(quantity)}, {norm}", *chain(*steps), fit))
    pairs = [(f"{words.cell_size(a)} → {words.cell_size(b)}", "crossings") for a, b in columns]
    return Table(caption, ("series", "order of, in", *chain(*pairs), "fitted"), tuple(rows), heads=2)


def _shown(record: Record, found: Finding) -> Row:
    plan, v = found.plan, found.verdict
    says = words.DASH if plan.expectation is None else str(v.outcome)
    if plan.expectation and plan.expectation.order is None and v.outcome is Outcome.PASS:
        says += " (diverges, as expected)"
    name = f"{words.quantity(plan.quantity)}, {plan.norm}"
    return (
        record.label(plan.run),
        name,
        words.order(v.observed),
        words.interval(v.interval),
        verdicts.registered(plan.expectation),
        says,
    )
