"""Page of a study of the column: runs, the paper's sentences, fronts and profiles, energies, refinement, films."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from mpm_verify.cases.column.exam import ColumnAnalysis, curves
from mpm_verify.cases.column.records import MEASURES, FinishedRun
from mpm_verify.cases.column.run import ColumnResult, ColumnRun
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.reports.components.examined import Section, checks_table, render
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.components.references import cited
from mpm_verify.reports.components.table import Table
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
    made = render(folder, analysis.examination, lambda _, add: sections(analysis, store, add), cite=cited(record))
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
    names = "run, front 99 %, 99.9 %, toe, height, by fit, rest, falls, area, outcome"
    head = tuple(names.split(", "))
    rows: list[tuple[str, ...]] = []
    for run in analysis.study.runs:
        result = analysis.results.get(run.digest)
        rows.append((words.label(analysis.study, run), *numbers(run, result)))
    if len(analysis.ran) == len(rows):  # all finished: a column that is not there fits a printed page
        head, rows = head[:-1], [row[:-1] for row in rows]
    older = any("area_levelled" not in one.values for one in analysis.ran)
    return Section("runs", "Runs", [*analysis.study.words, *words.LENGTHS, *[words.OLDER] * older], tables=[
        Table("Results of the runs", head, tuple(rows), texts=("outcome",))])  # fmt: skip


def numbers(run: ColumnRun, result: ColumnResult | None) -> tuple[str, ...]:
    """Numbers of one run, as text."""
    if result is None:
        return (*[DASH] * 8, "not run")
    if result.failure:
        at = result.failure.step * result.dt
        where = f"failed at {at:.3f} s (step {result.failure.step}): {failures.cause(result.failure)}"
        return (*[DASH] * 8, where)
    v = result.values
    rest = f"{v['rest'] / run.tau:.2f}" if v["rest"] < float("inf") else "not yet"
    lengths = (written(v, name) for names in MEASURES.values() for name in names)
    return (*lengths, rest, percent(v["creep"]), written(v, "area_levelled"), "finished")


def written(values: Mapping[str, float], name: str) -> str:
    """Number of a run; a dash where it was stored before that was measured."""
    return f"{values[name]:.3f}" if name in values else DASH


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
        (add("front", draw.fronts(ran, labels), "Front and toe against time; final values are in the table of runs."),
         "Front and toe against normalised time. Shaded: where the experiment's front rests; dashes: the times of "
         "that."),
        (add("profiles", draw.profiles(ran, labels), "Surface of the heap at the end of each run."),
         "The end, strip by strip: the height below which 99 % of the mass lies, and the volume det F V₀ over the "
         "width, which is above it where particles are crowded. Shaded: front and height of the experiment; dashed: "
         "the column's free side."),
    ])  # fmt: skip


def budget(ran: Sequence[FinishedRun], labels: Sequence[str], add: Add) -> Section:
    """Section of the energy budgets of the first run and of the last."""
    figures = []
    for number, key in {0: "first", len(ran) - 1: "last"}.items():
        label = labels[number]
        image = add(f"budget_{key}", draw.budget(ran[number]), f"Layers of the energy budget over time, {label}.")
        more = " What is above it was given by pooling." * ran[number].run.pooling
        figures.append((image, f"Run: {label}. The line on top stays at 1 as the budget closes.{more}"))
    return Section("budget", "Where the energy goes", figures=figures)


def energy(ran: Sequence[FinishedRun], labels: Sequence[str], add: Add) -> Section:
    """Section of the energies of all runs."""
    figures = [
        (add(name, draw.energy(ran, labels, name), f"{text.capitalize()} of each run over time."),
         f"The paper's Figure 6{', as the grid sees it' * (name == 'on_grid')}: {text}.")
        for name, text in words.ENERGIES.items()
    ]  # fmt: skip
    rubs = any(one.values.get("friction") for one in ran)
    pools = any(one.run.pooling for one in ran)
    columns = ("potential", "kinetic", "on the grid", "elastic", "plastic", *["pooling", "given"] * pools, "damping",
               "walls", *["slip on walls"] * rubs, "transfer", "convection", "residual")  # fmt: skip
    rows = []
    for one, label in zip(ran, labels, strict=True):
        start, v = float(one.curves["potential"][0]), one.values
        parts = [v[name] / start for name in ("potential", "kinetic", "on_grid", "elastic", "plastic")]
        parts += [v.get(name, 0.0) / start for name in ("pooled", "given") * pools] + [v["damping"] / start]
        parts += [-v["walls"] / start, *[v["friction"] / start] * rubs]
        parts += [v["transfer"] / start, v["convection"] / start]
        rows.append((label, *(f"{100 * part:.2f}" for part in parts), f"{v['unbalanced']:.1e}"))
    text = (
        "Kinetic energy of the particles includes velocities that the grid does not see and that move nothing; at rest "
        "it is all that is left. That on the grid is half the sum of m v² over the nodes. "
        "Two columns are what the method loses: transfer, on the way of velocities between "
        "particles and grid, and convection, the work of the forces at the nodes less that of the stress in the "
        "particles. Each term is computed apart from the others; the residual is what their sum misses. Where the "
        "gradients of weights jump, as those of classical MPM do, convection is not small."
    )
    text += (
        " Pooling is elastic energy that it has taken from the particles of cells, given what it put into crowded "
        "ones, by the work of their stress: crowding took it from the fall, and it is on the other side of the sum."
    ) * pools
    text += " Slip on walls is the part of walls that friction takes, by velocities at the end of each step." * rubs
    return Section("energy", "Energy", [text], figures, [
        Table("Energies at the end, % of the initial potential energy; residual: largest at any time",
              ("run", *columns), tuple(rows))])  # fmt: skip
