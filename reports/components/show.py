"""Tables of errors and orders as the page shows them, one row a level; full digits are in the CSV files."""

from collections.abc import Sequence

from mpm_verify.cases.harness.refinement import Series
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.order import Outcome
from mpm_verify.cases.mms.run import NORMS, QUANTITIES, Run
from mpm_verify.reports import words
from mpm_verify.reports.components.table import Row, Table
from mpm_verify.reports.figures.local_orders import orders
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import verdicts
from mpm_verify.reports.tables import mms as tables

NAMES = {"u": "displacement u", "v": "velocity v", "F": "deformation gradient F", "sigma": "Cauchy stress"}
WITH_ORDER = ("rms", "printed")  # norms whose local orders are told


def judged(record: Record) -> Table:
    """Errors, local orders and crossings of what the study judges, and of u in rms in any case."""
    head = ("series", "cell size", "error", "order", "crossings")
    rows: list[Row] = []
    for s in record.series:
        for quantity, norm in dict.fromkeys([*_keys(record, s, "judged"), ("u", "rms")]):
            rows += _block(record, s, quantity, norm)
    return Table("Errors and orders, one row a level", head, tuple(rows), heads=2, grouped=True)


def _block(record: Record, s: Series, quantity: str, norm: str) -> list[Row]:
    """Rows of one quantity of a series, with the fitted order in their name."""
    fitted = {tables.key(f.plan): words.order(f.verdict.observed) for f in record.findings}
    fit = fitted.get((s.head, quantity, norm), words.DASH)
    shown = "" if (quantity, norm) in _keys(record, s, "judged") else "shown only, "
    name = f"{record.label(s.first)}: {words.quantity(quantity)} in {norm}; {shown}fitted order {fit}"
    passed = tables.crossings(record)
    step = {fine: words.order(p) for _, fine, p in orders(record, s, quantity, norm)}
    return [
        (name, words.cell_size(run.cells), text, step.get(run.cells, ""), words.few(passed.get((s.head, run.cells))))
        for run, text in _told(record, s, quantity, norm)
    ]


def shown(record: Record, quantity: str) -> Table:
    """Errors of one quantity in every norm, with the orders of some; what is judged stands in its own table."""
    columns = [name for norm in NORMS for name in ((norm, "order") if norm in WITH_ORDER else (norm,))]
    rows: list[Row] = []
    for s in record.series:
        mine = _keys(record, s, "shown")
        cells: dict[int, list[str]] = {run.cells: [] for run in s.runs}
        for norm in NORMS:
            there = (quantity, norm) in mine
            step = {fine: words.order(p) for _, fine, p in orders(record, s, quantity, norm)}
            for run, text in _told(record, s, quantity, norm):
                more = [step.get(run.cells, "")] if norm in WITH_ORDER else []
                cells[run.cells] += [text, *more] if there else ["judged", *[""] * len(more)]
        rows += [(record.label(s.first), words.cell_size(n), *texts) for n, texts in cells.items()]
    caption = f"Shown only: errors of the {NAMES[quantity]} and their orders"
    return Table(caption, ("series", "cell size", *columns), tuple(rows), heads=2, grouped=True)


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
    return Table("Shown only: fitted orders", head, rows, heads=2, texts=head[4:], grouped=True)


def _keys(record: Record, series: Series, role: str) -> list[tuple[str, str]]:
    """Pairs (quantity, norm) of that role, in the order of the contract."""
    known = tables.roles(record)
    every = [(q, n) for q in QUANTITIES for n in NORMS]
    return [k for k in every if known.get((series.head, *k), "shown") == role]


def _told(record: Record, s: Series, quantity: str, norm: str) -> Sequence[tuple[Run, str]]:
    """Levels of a series with their error as text, or why there is none."""
    means = dict(record.errors(s, quantity, norm))
    return [(run, words.sci(means[run]) if run in means else _without(record, s, run)) for run in s.runs]


def _without(record: Record, series: Series, run: Run) -> str:
    """Reason why a level has no error."""
    return "failed" if run in record.failed(series) else "not run"


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
