"""Page of a study of the column: runs, the paper's sentences, fronts and profiles, energies, refinement, films."""

from collections.abc import Sequence
from pathlib import Path

from mpm_verify.cases.column.claims import FinishedRun
from mpm_verify.cases.column.exam import ColumnAnalysis, curves
from mpm_verify.cases.column.run import ColumnResult, ColumnRun
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.reports.components.examined import Section, checks_table, render
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.components.show import Table
from mpm_verify.reports.export.column_files import files, tables
from mpm_verify.reports.figures import column as draw
from mpm_verify.reports.frames import Record
from mpm_verify.reports.pages._column_aspect import aspects
from mpm_verify.reports.pages._column_more import alive, books, films, refinement, set_up
from mpm_verify.reports.sentences import column as words
from mpm_verify.reports.sentences import failures
from mpm_verify.reports.words import DASH, percent


def page(record: Record, vtk: bool = False) -> Path:
    """Write the page of a study, its tables, and with `vtk` the files of its snapshots. Raises StoreError."""
    analysis, store, folder = record.analysis.more, record.store, record.store.folder
    made = render(folder, analysis.examination, lambda _, add: sections(analysis, store, add))
    try:
        tables(analysis, store, folder / "tables")
        if vtk:
            files(analysis, store, folder / "vtk")
    except OSError as error:
        raise StoreError(f"cannot write into {folder}: {error.strerror}; the results are kept") from error
    return made


def sections(analysis: ColumnAnalysis, store: Store, add: Add) -> Sequence[Section]:
    """Sections; figures only where a run came to its end."""
    found = [summary(analysis, add)]
    if analysis.claims:
        found.append(said(analysis))
    if drawn := [one for one in analysis.ran if one.curves]:
        labels = [words.label(analysis.study, one.run) for one in drawn]
        found += [motion(drawn, labels, add), energy(drawn, labels, add), budget(drawn, labels, add)]
    if analysis.lines:
        found.append(aspects(analysis.lines, add))
    if analysis.refined or analysis.scattered:
        found.append(refinement(analysis, add))
    kept = [
        (run, analysis.results[run.digest]) for run in analysis.study.runs
        if run.digest in analysis.results and curves(store, analysis.results[run.digest])
    ]  # fmt: skip
    if kept:
        found += [set_up(store, add, *kept[0]), films(analysis, store, add, kept)]
    if analysis.results:
        found.append(alive(analysis))
    if any(one.run.pooling for one in analysis.ran):
        found.append(books(analysis))
    return [*found, Section("checks", "Invariants, whatever the experiment says", tables=[
        checks_table("Checks", analysis.examination.checks, group=True)])]  # fmt: skip


def summary(analysis: ColumnAnalysis, add: Add) -> Section:
    """Section of what each run came to."""
    head = ("run", "front 99 %", "99.9 %", "toe", "height", "rest [√(h₀/g)]", "height falls", "area", "outcome")
    rows = []
    for run in analysis.study.runs:
        result = analysis.results.get(run.digest)
        rows.append((words.label(analysis.study, run), *numbers(run, result)))
    notes = (
        "Front and toe are distances from the wall in m: 99 or 99.9 % of the mass lie within the front, and the heap "
        "that is connected to the wall ends at its toe. The height is that of the heap next to the wall; “height "
        "falls” is by how much it still fell in the last fifth of the time. A run rests once the kinetic energy that "
        "the grid sees stays below a ten-thousandth of the initial potential energy; grains of the experiment came "
        "to rest after 2.5 to 3.3 √(h₀/g). Area: that below the surface over that of the column; as the surface is "
        "that of 99 % of the mass, by its centres, it is a little too low."
    )
    return Section("runs", "Runs", [*analysis.study.words, notes], tables=[
        Table("Results of the runs", head, tuple(rows), texts=("outcome",))])  # fmt: skip


def numbers(run: ColumnRun, result: ColumnResult | None) -> tuple[str, ...]:
    """Numbers of one run, as text."""
    if result is None:
        return (*[DASH] * 7, "not run")
    if result.failure:
        at = result.failure.step * result.dt
        where = f"failed at {at:.3f} s (step {result.failure.step}): {failures.cause(result.failure)}"
        return (*[DASH] * 7, where)
    v = result.values
    rest = f"{v['rest'] / run.tau:.2f}" if v["rest"] < float("inf") else "not yet"
    lengths = (f"{v[name]:.3f}" for name in ("front_99", "front_999", "toe", "height"))
    return (*lengths, rest, percent(v["creep"]), f"{v['area']:.2f}", "finished")


def said(analysis: ColumnAnalysis) -> Section:
    """Section of the paper's sentences."""
    several = any(claim.shared for claim in analysis.claims)
    head = ("the paper says", *(("runs with",) if several else ()), "here", "what was found")
    rows = tuple(
        (
            words.says(claim),
            *((words.listed(claim.shared),) if several else ()),
            words.answer(claim),
            words.found(claim),
        )
        for claim in analysis.claims
    )
    return Section("paper", "What the paper says, and what is found here", tables=[
        Table("Sentences of the paper on this axis", head, rows, texts=head[1:])])  # fmt: skip


def motion(ran: Sequence[FinishedRun], labels: Sequence[str], add: Add) -> Section:
    """Section of fronts and final profiles."""
    return Section("motion", "Run-out", figures=[
        (add("front", draw.fronts(ran, labels), "Front against time; its final values are in the table of runs."),
         "Front against normalised time. Shaded: where the experiment's front rests; dashes: the times of that."),
        (add("profiles", draw.profiles(ran, labels), "Surface of the heap at the end of each run."),
         "The surface at the end. Shaded: front and height of the experiment; dashed: the column's free side."),
    ])  # fmt: skip


def budget(ran: Sequence[FinishedRun], labels: Sequence[str], add: Add) -> Section:
    """Section of the energy budgets of the first run and of the last."""
    figures = []
    for number, key in {0: "first", len(ran) - 1: "last"}.items():
        label = labels[number]
        image = add(f"budget_{key}", draw.budget(ran[number]), f"Layers of the energy budget over time, {label}.")
        figures.append((image, f"Run: {label}. The line on top stays at 1 as the budget closes."))
    return Section("budget", "Where the energy goes", figures=figures)


def energy(ran: Sequence[FinishedRun], labels: Sequence[str], add: Add) -> Section:
    """Section of the energies of all runs."""
    figures = [
        (add(name, draw.energy(ran, labels, name), f"{name.capitalize()} energy of each run over time."),
         f"The paper's Figure 6: {name} energy.")
        for name in ("potential", "kinetic")
    ]  # fmt: skip
    rubs = any(one.values.get("friction") for one in ran)
    pools = any(one.run.pooling for one in ran)
    columns = ("potential", "kinetic", "on the grid", "elastic", "plastic", *["pooling"] * pools, "damping", "walls",
               *["slip on walls"] * rubs, "transfer", "convection", "residual")  # fmt: skip
    rows = []
    for one, label in zip(ran, labels, strict=True):
        start, v = float(one.curves["potential"][0]), one.values
        parts = [v[name] / start for name in ("potential", "kinetic", "on_grid", "elastic", "plastic")]
        parts += [*[v.get("pooled", 0.0) / start] * pools, v["damping"] / start]
        parts += [-v["walls"] / start, *[v["friction"] / start] * rubs]
        parts += [v["transfer"] / start, v["convection"] / start]
        rows.append((label, *(f"{100 * part:.2f}" for part in parts), f"{v['unbalanced']:.1e}"))
    text = (
        "Kinetic energy of the particles includes velocities that the grid does not see and that move nothing; at rest "
        "it is all that is left. Two columns are what the method loses: transfer, on the way of velocities between "
        "particles and grid, and convection, the work of the forces at the nodes less that of the stress in the "
        "particles. Each term is computed apart from the others; the residual is what their sum misses. Where the "
        "gradients of weights jump, as those of classical MPM do, convection is not small."
    )
    text += " Pooling is elastic energy that it has taken from the particles of cells." * pools
    text += " Slip on walls is the part of walls that friction takes, by velocities at the end of each step." * rubs
    return Section("energy", "Energy", [text], figures, [
        Table("Energies at the end, % of the initial potential energy; residual: largest at any time",
              ("run", *columns), tuple(rows))])  # fmt: skip
