"""Page of `verify benchmark`: each problem as it is stated, with its figures, then verdicts, errors and checks."""

from pathlib import Path
from typing import Any

from mpm_verify.cases.benchmark.problem import FIGURE, Problem
from mpm_verify.cases.harness.refinement import Series
from mpm_verify.cases.harness.store import StoreError
from mpm_verify.reports import words
from mpm_verify.reports.components.examined import Section
from mpm_verify.reports.components.page import Add, adder
from mpm_verify.reports.figures import benchmark as figures
from mpm_verify.reports.frames import Record
from mpm_verify.reports.pages import _plain
from mpm_verify.reports.sentences.benchmark import control, statement
from mpm_verify.solver.plugins import label


def page(record: Record, vtk: bool = False) -> Path:
    """Write the page; its path. There are no snapshots, whatever `vtk` says. Raises StoreError."""
    folder = record.store.folder / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    add = adder(folder)
    named = dict.fromkeys(series.first.problem for series in record.series)
    return _plain.page(record, first=[section(record, add, name, number) for number, name in enumerate(named)],
                       lead=control(record))  # fmt: skip


def section(record: Record, add: Add, name: str, number: int) -> Section:
    """Section of a problem: its statement, and the figures of its finest runs."""
    mine = [series for series in record.series if series.first.problem == name]
    problem: Problem = mine[0].first.stated
    runs = {told(record, series): curves for series in mine if (curves := finest(record, series))}
    images = []
    for key, figure in problem.figures.items():
        found = {label: curves[key] for label, curves in runs.items() if key in curves}
        if found:
            image = add(f"{label(name)}_{key}", figures.drawn(figure, found), f"{figure.y} against {figure.x}.")
            images.append((image, words.sentence(figure.caption)))
    return Section(f"problem-{number}", f"{label(name)}: the problem", statement(problem), images)


def told(record: Record, series: Series) -> str:
    """Name of a refinement in a legend: the method, and what else varies but the problem and what goes with it."""
    run = series.first
    more = [f"{key} {getattr(run, key)}" for key in record.varied if key not in ("problem", "material")]
    return ", ".join([words.series(run), *more])


def finest(record: Record, series: Series) -> dict[str, dict[str, Any]]:
    """Curves of the finest finished run by figure; none where they cannot be read."""
    done = [run for run in series.runs if (one := record.result(run)) and not one.failure]
    try:
        arrays = record.arrays(done[-1]) if done else {}
    except StoreError:
        return {}
    found: dict[str, dict[str, Any]] = {}
    for key, rows in arrays.items():
        if key.startswith(FIGURE):
            figure, _, curve = key.removeprefix(FIGURE).partition("/")
            found.setdefault(figure, {})[curve] = rows
    return found
