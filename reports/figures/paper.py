"""Figures 1 to 8 of the paper from stored studies, as wide as a column of a journal or as its page, with their data.

They are the figures of the cases' pages, made smaller as a whole: letters and lines with the rest. Letters of the PDF
are TrueType (Type 42), which journals ask for.
"""

import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text

from mpm_verify.cases.column.records import FinishedRun
from mpm_verify.cases.objectivity.block import PRINTED, SMALL
from mpm_verify.reports.figures import column, convergence, drawn, objectivity, style
from mpm_verify.reports.frames import Record
from mpm_verify.reports.paper.evidence import Evidence
from mpm_verify.reports.paper.records import NotStoredError
from mpm_verify.reports.sentences import column as words

NARROW, WIDE = 84.0, 174.0  # mm: a column of a journal, and a page
INCH = 25.4
KINDS = ("pdf", "svg", "png")
ENERGIES = {"potential": "potential energy", "on_grid": "kinetic energy of the grid"}
FEW = 4  # curves of a figure
MATERIALS = {"mohr_coulomb": "Mohr-Coulomb", "ubcsand": "UBCSAND"}


@dataclass(frozen=True)
class PaperFigure:
    """Figure by its number: the study that it is drawn from, its width in mm, and how it is drawn."""

    number: int
    study: str
    width: float
    draw: Callable[[Record], Figure | None]  # None where too little came to its end

    @property
    def name(self) -> str:
        """Name of its files."""
        return f"figure{self.number}"


def finished(record: Record) -> tuple[list[FinishedRun], list[str]]:
    """Columns that came to their end and have their curves, and their names in the study."""
    ran = [one for one in record.analysis.more.ran if one.curves][:FEW]
    named = [words.label(record.study, one.run) for one in ran]
    return ran, [MATERIALS.get(name, name) for name in named]


def errors(record: Record) -> Figure:
    """Error against cell size in both norms, over one period."""
    return convergence.convergence(record, record.solutions[0])["figure1"]


def block(record: Record) -> Figure | None:
    """Mean stress of the block as printed, and of a small one."""
    for one in record.analysis.more.examinations.values():
        runs = {name: one.curves[f"run/{name}"] for name in (PRINTED, SMALL) if f"run/{name}" in one.curves}
        return objectivity.stresses(one.curves["exact"], runs) if runs else None
    return None


def set_up(record: Record) -> Figure | None:
    """Column before it is released."""
    if not finished(record)[0]:
        return None
    run = record.study.runs[0]
    arrays = record.arrays(run)
    x, corners = column.away(run, arrays["snapshot_x"][0]), arrays.get("snapshot_corners")
    return column.set_up(run, x, None if corners is None else column.away(run, corners[0]))


def fronts(record: Record) -> Figure | None:
    """Front and toe against time."""
    ran, labels = finished(record)
    return column.fronts(ran, labels) if ran else None


def energies(record: Record) -> Figure | None:
    """Potential and kinetic energy against time, a panel each."""
    ran, labels = finished(record)
    if not ran:
        return None
    with rc_context(style.RC):
        figure = Figure(figsize=(2 * column.WIDE, column.SIZE[1]), layout="constrained")
        for axes, (name, text) in zip(figure.subplots(1, 2), ENERGIES.items(), strict=True):
            for number, (one, label) in enumerate(zip(ran, labels, strict=True)):
                axes.plot(one.curves["t"] / one.run.tau, one.curves[name] / one.curves["potential"][0], label=label,
                          **column.stroke(number))  # fmt: skip
            axes.set(xlim=(0, None), ylim=(0, None), xlabel=column.TIME, ylabel=f"{text}\n/ initial potential energy")
        column.legend(figure, labels, columns=FEW)
    return figure


FIGURES = (
    PaperFigure(1, "figure1", WIDE, errors),
    PaperFigure(2, "figure2", WIDE, block),
    PaperFigure(3, "figure3", NARROW, set_up),
    PaperFigure(4, "figure4", NARROW, fronts),
    PaperFigure(5, "figure5", NARROW, fronts),
    PaperFigure(6, "figure5", WIDE, energies),
    PaperFigure(7, "figure7", NARROW, fronts),
    PaperFigure(8, "figure8", NARROW, fronts),
)


def shrunk(figure: Figure, width: float) -> Figure:
    """Make a figure so wide, in mm, with all that is on it."""
    size = figure.get_size_inches()
    factor = width / INCH / size[0]
    figure.set_size_inches(*(factor * size))
    for text in figure.findobj(Text):
        text.set_fontsize(factor * text.get_fontsize())
    for line in figure.findobj(Line2D):
        line.set(linewidth=factor * line.get_linewidth(), markersize=factor * line.get_markersize())
    return figure


def write(one: PaperFigure, record: Record, folder: Path) -> list[Path]:
    """Write a figure as PDF, SVG and PNG, and what is drawn as CSV; their paths, none where nothing can be drawn."""
    made = None if record.missing else one.draw(record)
    if made is None:
        return []
    folder.mkdir(parents=True, exist_ok=True)
    figure, paths = shrunk(made, one.width), []
    with rc_context({**style.RC, "pdf.fonttype": 42}):
        for kind in KINDS:
            buffer = io.BytesIO()
            figure.savefig(buffer, format=kind, metadata=style.METADATA[kind], dpi=600)
            paths.append(folder / f"{one.name}.{kind}")
            paths[-1].write_bytes(buffer.getvalue())
    data = drawn.table(figure)
    if len(data):
        paths.append(folder / f"{one.name}.csv")
        data.to_csv(paths[-1], index=False, lineterminator="\n")
    return paths


def write_all(folder: Path, seen: Evidence) -> dict[int, list[Path]]:
    """Write each figure whose study is stored below the folder; files by the number of the figure."""
    found = {}
    for one in FIGURES:
        try:
            found[one.number] = write(one, seen.record(one.study), folder / "figures")
        except NotStoredError:
            continue
    return {number: paths for number, paths in found.items() if paths}
