"""Page of a case that has none of its own: verdicts, errors and orders, a figure, checks, runs."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib import rc_context
from matplotlib.figure import Figure

from mpm_verify.cases.harness.checks import Examination
from mpm_verify.reports import words
from mpm_verify.reports.components import run_cards
from mpm_verify.reports.components.badges import of_findings
from mpm_verify.reports.components.cards import summary
from mpm_verify.reports.components.examined import Section, checks_table, render
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.components.references import cited
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.figures import drawn, style
from mpm_verify.reports.figures.convergence import cell_axis
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import commands, controls, failures, verdicts
from mpm_verify.reports.sentences.headline import badge, headline, passed
from mpm_verify.reports.tables import plain


def page(
    record: Record, vtk: bool = False, more: Sequence[Section] = (), last: Section | None = None,
    first: Sequence[Section] = (), lead: str = "",
) -> Path:  # fmt: skip
    """Write the page of a study, its figures and tables; its path.

    Sections `first` stand before the verdicts, `more` before the runs, or `last` in place of these.
    `lead` stands before what is said of it on top.

    Raises StoreError.
    """
    study, found = record.study, record.analysis
    one = next(iter(record.results.values()), None)
    examination = Examination(
        study.name, study.title, study.command, (), found.checks, dict(one.parameters) if one else {}, {},
        one.environment if one else {},
    )  # fmt: skip
    made = render(
        record.store.folder, examination, lambda _, add: [*first, *sections(record, add), *more, last or runs(record)],
        outcome=str(found.outcome), said=f"{lead} {said(record)}".strip(),
        found=of_findings(record, "verdicts") if study.plans else (), told=run_cards.told(record), cite=cited(record),
    )  # fmt: skip
    plain.write(record, record.store.folder / "tables")
    return made


def said(record: Record) -> str:
    """Lead: what the order rule says where it is asked, and how many checks pass."""
    judged = [headline(record), summary(record)] if record.study.plans else []
    return " ".join(filter(None, [*judged, passed(record.analysis.checks)]))


def sections(record: Record, add: Add) -> list[Section]:
    """Verdicts with their figure, errors and orders, and checks, as far as there are some."""
    found = []
    if record.study.plans:
        named = {(f.plan.quantity, f.plan.norm): words.measured(f.plan, ", ") for f in record.findings}
        orders = any(plan.expectation and plan.expectation.order is not None for plan in record.study.plans)
        line = "; the dashed line has the expected order" if orders else ""
        images = [(add(f"error_{q}_{n}", errors(record, q, n), alt(record, q, n)),
                   f"Error of the {said} against cell size{line}.".replace("of the error ", ""))
                  for (q, n), said in named.items()]  # fmt: skip
        told = [*record.study.words, *filter(None, [controls.sentence(record.analysis.controls)])]
        found.append(Section("verdicts", "Verdicts", told, images, [verdict_table(record)]))
        found.append(Section("errors", "Errors and orders", tables=[levels(record)]))
    if record.analysis.checks:
        found.append(Section("checks", "Checks", tables=[checks_table("Checks", record.analysis.checks, group=True)]))
    return found


def alt(record: Record, quantity: str, norm: str) -> str:
    """Text of the figure of errors: what came out of each refinement."""
    mine = [f for f in record.findings if (f.plan.quantity, f.plan.norm) == (quantity, norm)]
    told = [f"{record.label(f.plan.run)}: order {words.order(f.verdict.observed)}, {badge(f)}" for f in mine]
    of = "" if quantity == norm else f" of {quantity}"
    return f"Error{of} against cell size, both axes logarithmic. {'; '.join(told)}."


def verdict_table(record: Record) -> Table:
    """Table of what is judged, what came out, and why."""
    head = ("refinement", "quantity", "verdict", "order", "interval", "expected", "reason")
    rows = []
    for f in record.findings:
        plan, v = f.plan, f.verdict
        said = badge(f) if f.counts else "shown"
        rows.append((record.label(plan.run), words.measured(plan, ", "), said, words.order(v.observed),
                     words.interval(v.interval), verdicts.registered(plan.expectation),
                     commands.reason(record.study, f)))  # fmt: skip
    return Table("Verdicts", head, tuple(rows), texts=("quantity", "verdict", "expected", "reason"))


def levels(record: Record) -> Table:
    """Table of the levels of all findings, a row for each cell size."""
    rows = [
        (f"{record.label(found.plan.run)}: {words.measured(found.plan, ', ')}", record.named(level.h),
         words.sci(row["error"]), words.order(row["order"]), str(row["ended"]))
        for found in record.findings
        for level, row in zip(found.levels, plain.levels(record, found), strict=True)
    ]  # fmt: skip
    head = ("refinement", record.by, "error", "order", "failed")
    return Table("Errors and orders, one row a level", head, tuple(rows), heads=2, texts=("failed",), grouped=True)


def runs(record: Record) -> Section:
    """Section of every run: its parameters that vary, how it ended, what it took."""
    names = record.study.axes
    head = (*(name.replace("_", " ") for name in names), "status", "time steps", "particles", "wall time [s]", "failed")
    rows = []
    for run in record.study.runs:
        result = record.result(run)
        ends: tuple[str, ...] = ("not run", *[words.DASH] * 4)
        if result:
            why = failures.failure(result.failure) if result.failure else ""
            ends = (result.status, str(result.steps), str(result.particles), f"{result.wall_s:.2f}", why)
        rows.append((*(str(getattr(run, name)) for name in names), *ends))
    table = Table("All runs", head, tuple(rows), heads=0, texts=("status", "failed"))
    return Section("runs", "Runs", tables=[table], runs=run_cards.cards(record) if record.study.plans else ())


def errors(record: Record, quantity: str, norm: str) -> Figure:
    """Figure of the error of every refinement against cell size, both axes logarithmic."""
    methods = list(dict.fromkeys(getattr(s.first, "method", "") for s in record.series))
    heads = {f.plan.head for f in record.findings if (f.plan.quantity, f.plan.norm) == (quantity, norm)}
    judged = [s for s in record.series if s.head in heads]
    shown = [s for s in record.drawn if s in judged] or judged
    with rc_context(style.RC):
        figure = Figure(figsize=style.PANEL, layout="constrained")
        axes = figure.subplots()
        for s in shown:
            points = [(1 / run.cells, error) for run, error in record.errors(s, quantity, norm) if error > 0]
            look = style.look(methods, getattr(s.first, "method", ""), getattr(s.first, "ppc", 9))
            if points:
                lines = axes.loglog(*zip(*points, strict=True), label=record.label(s.first), **look.plot)
                drawn.of_runs(lines, [run for run, error in record.errors(s, quantity, norm) if error > 0])
        _expected(axes, record, quantity, norm)
        cell_axis(axes, shown)
        axes.set_ylabel("error" if quantity == norm else f"error of the {quantity}, {norm}".removesuffix(", error"))
        if axes.lines:
            axes.legend(frameon=False)
    return figure


def _expected(axes: object, record: Record, quantity: str, norm: str) -> None:
    """Draw a line of the expected order below the finest errors."""
    for f in record.findings:
        e, done = f.plan.expectation, record.errors(record.series_of(f.plan), quantity, norm)
        if (f.plan.quantity, f.plan.norm) == (quantity, norm) and e and e.order is not None and len(done) > 1:
            h = [1 / done[0][0].cells, 1 / done[-1][0].cells]
            low = 0.5 * done[-1][1]
            axes.plot(h, [low * (h[0] / h[1]) ** e.order, low], "--", color=style.INK, linewidth=0.9)  # type: ignore[attr-defined]
            return
