"""Page, figures and tables of an MMS study; from what is stored alone, and the same bytes each time."""

import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.cases.harness.study import Arrays
from mpm_verify.cases.mms.run import QUANTITIES, Run
from mpm_verify.reports import words
from mpm_verify.reports.components import audited, run_cards, show, show_axes, show_graded, show_runs
from mpm_verify.reports.components.asides import asides
from mpm_verify.reports.components.badges import of_findings, shortened
from mpm_verify.reports.components.cards import cards, summary
from mpm_verify.reports.components.logs import failed
from mpm_verify.reports.components.page import Add, Image, adder, whole
from mpm_verify.reports.components.references import cited
from mpm_verify.reports.components.show_cost import figure_rows, overview
from mpm_verify.reports.components.stalls import looked, stalls
from mpm_verify.reports.figures import graded
from mpm_verify.reports.figures.convergence import convergence, methods
from mpm_verify.reports.figures.cost import cost_figure
from mpm_verify.reports.figures.error_field import CELLS, PPC, choose, error_field
from mpm_verify.reports.figures.local_orders import local_order_figure, orders
from mpm_verify.reports.figures.particles import particles
from mpm_verify.reports.figures.position import position
from mpm_verify.reports.figures.time_step import time_step
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import controls, norms
from mpm_verify.reports.sentences.headline import headline
from mpm_verify.reports.sentences.remarks import left_out
from mpm_verify.reports.tables import mms as tables
from mpm_verify.reports.tables.cost import compares, costs
from mpm_verify.solver.plugins import label

TIME = "Error of u in rms against the Courant number on the finest cells, both axes logarithmic; numbers in the table."
POSITION = (
    "Error of u in rms over the median of its level, for several positions of the particles; numbers in the tables."
)
COUNT = "error of u in rms against the particles per cell, a line a cell size; numbers in the table."


def page(record: Record, vtk: bool = False, field: tuple[int, int] = (CELLS, PPC)) -> Path:
    """Write report.html, figures/*.svg|pdf|png and tables/*.csv into the folder of a study; the path of the page.

    The error field is that of the run of each method nearest to `field`: cells a side and particles per cell. This
    case has no snapshots, whatever `vtk` says.

    Raises StoreError if the folder cannot be written.
    """
    folder = record.store.folder
    try:
        for name in ("figures", "tables"):
            (folder / name).mkdir(exist_ok=True)
        (folder / "tables" / "now.csv").touch()  # the clock of the file system, which need not be ours
        started = (folder / "tables" / "now.csv").stat().st_mtime_ns
        (folder / "tables" / "now.csv").unlink()
        tables.write(record, folder / "tables")
        text = _page(record, folder / "figures", field)
        for name in ("figures", "tables"):
            _sweep(folder / name, started)
        Store.write(folder / "report.html", text.encode())
        return folder / "report.html"
    except OSError as error:
        raise StoreError(f"cannot write the report into {folder}: {error.strerror}; the results are kept") from error


def _page(record: Record, folder: Path, field: tuple[int, int]) -> str:
    """Text of the page; figures are drawn on the way."""
    told, verdicts = run_cards.told(record), cards(record)
    return whole(
        "report.html.j2",
        record.study.title,
        record=record,
        study=record.study,
        outcome=str(record.analysis.outcome),
        found=shortened(of_findings(record)),
        finding=headline(record),
        summary=summary(record),
        cards=verdicts,
        asides=asides(record, verdicts),
        runs=run_cards.cards(record),
        cite=cited(record),
        meaning=words.MEANING,
        sections=[_solution(record, solution, folder, field, told) for solution in record.solutions],
        show=show,
        show_runs=show_runs,
        show_axes=show_axes,
        stalls=stalls(record),
        logs=failed(record),
        cost=_cost(record, folder, told),
        overview=overview,
        slower=any((s.first.method, s.first.solution) == ("mpm", "axis_aligned") for s in record.series),
        graded=show_graded if graded.found(record) else None,
        looked=looked(record),
        quantities=QUANTITIES,
        controls=controls,
        norms=norms,
        words=words,
    )


def _solution(
    record: Record, solution: str, folder: Path, field: tuple[int, int], told: Mapping[str, str]
) -> dict[str, object]:
    """Figures and blind spots of one solution; figure files carry its name where the study has several."""
    end = "_" + re.sub(r"[^A-Za-z0-9]+", "_", label(solution)) if len(record.solutions) > 1 else ""
    add = adder(folder, end, told=told)
    drawn = convergence(record, solution)
    add("figure1", drawn["figure1"], "")
    chosen = [choose(record, method, solution, *field) for method in methods(record)]
    there, unread = _arrays(record, [run for run in chosen if run])
    fields = [_field(run, arrays, add) for run, arrays in there]
    several = particles(record, solution)
    images = {
        "time": _maybe(add, "time_step", time_step(record, solution), TIME),
        "position": _maybe(add, "position", position(record, solution), POSITION),
        "particles": [
            add(f"particles_{label(m)}", drawn, f"{words.method(m)}: {COUNT}") for m, drawn in several.items()
        ],
    }
    if graded.found(record):
        alt = f"Error of u on {label(solution)} against cost: uniform, graded and thinned layouts."
        images["graded"] = add("graded", graded.figure(record, solution), alt)
    return images | {
        "name": label(solution),
        "panels": [
            add(f"figure1_{norm}", drawn[f"figure1_{norm}"], _alt(record, solution, norm))
            for norm in ("rms", "printed")
        ],
        "orders": add(
            "local_orders",
            local_order_figure(record, solution),
            _orders_alt(record, solution),
        ),
        "fields": [image for image in fields if image],
        "unread": left_out("particles", ", ".join(unread)) if unread else "",
        "blind": audited.blind(record, solution),
        "seen": audited.seen(record, solution),
    }


def _cost(record: Record, folder: Path, told: Mapping[str, str]) -> Image | None:
    """Figure of error against cost, where there are methods enough to compare."""
    if not compares(record):
        return None
    drawn = cost_figure(record, figure_rows(record))
    reached = [(row["relative_error"], words.method(row["method"])) for row in costs(record) if row["relative_error"]]
    least = f" The least on the finest cells: {words.sci(min(reached)[0])} by {min(reached)[1]}." if reached else ""
    alt = f"Error of u over the exact rms, against updates and time.{least}"
    return adder(folder, "", told=told)("cost", drawn, alt)


def _maybe(add: Add, name: str, figure: Figure | None, alt: str) -> Image | None:
    """Image where there is a figure."""
    return add(name, figure, alt) if figure else None


def _arrays(record: Record, runs: Sequence[Run]) -> tuple[list[tuple[Run, Arrays]], list[str]]:
    """Particles of runs, and the files of those that cannot be read, which is said on standard error too."""
    found: list[tuple[Run, Arrays]] = []
    unread: list[str] = []
    for run in runs:
        try:
            found.append((run, record.arrays(run)))
        except StoreError as error:
            unread.append(f"runs/{record.results[run.digest].digest}.npz")
            if sys.stderr is not None:  # print() would take standard output instead
                print(f"verify: {error}", file=sys.stderr)
    return found, unread


def _field(run: Run, arrays: Arrays, add: Add) -> Image | None:
    """Figure of the error field of one run; None where no error of its particles is stored."""
    if not ({"corners"} <= arrays.keys() or {"x", "F", "r0"} <= arrays.keys()) or "error_u" not in arrays:
        return None
    most = words.sci(float(arrays["error_u"].max()))
    grid = f"{run.cells} by {run.cells} cells"
    alt = f"Size of the error of u at the last step, {words.series(run)}, {grid}: at most {most}."
    return add(f"error_field_{label(run.method)}", error_field(run, arrays), alt)


def _alt(record: Record, solution: str, norm: str) -> str:
    """Text of a panel of Figure 1: the ends of each series and its failed runs."""
    parts = [f"Error of u in {norm} against cell size, both axes logarithmic."]
    for s in (s for s in record.drawn if s.first.solution == solution):
        found, failed = record.errors(s, "u", norm), record.failed(s)
        ends = [f"{words.sci(e)} at {words.cell_size(run.cells)}" for run, e in (found[:1] + found[1:][-1:])]
        text = f"{words.series(s.first)}: {' to '.join(ends) or 'no error'}"
        parts.append(text + (f", {words.count(len(failed), 'run')} failed." if failed else "."))
    return " ".join(parts)


def _orders_alt(record: Record, solution: str) -> str:
    """Text of the figure of local orders: the last of each series."""
    found = [(s, orders(record, s, "u", "rms")) for s in record.drawn if s.first.solution == solution]
    last = [f"{words.series(s.first)} {words.order(steps[-1][2])}" for s, steps in found if steps]
    return f"Local orders of u in rms; on the finest cells: {', '.join(last) or 'none'}."


def _sweep(folder: Path, started: float) -> None:
    """Remove figures and tables that an earlier study left in the folder."""
    for file in folder.iterdir():
        if file.suffix in (".svg", ".pdf", ".png", ".csv") and file.stat().st_mtime_ns < started:
            file.unlink()
