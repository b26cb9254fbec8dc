"""Looks of the figures, and files that are the same bytes each time they are written.

Colour and marker tell the method, line and filling the particle count: no statement hangs on colour alone. Colours:
Okabe & Ito (2008), "Color Universal Design". Type is large enough that a panel can be shown 340 px wide.
"""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullLocator

from mpm_verify.reports import words

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#000000", "#56B4E9", "#8C564B")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<")
LINES: dict[int, tuple[Any, bool]] = {1: (":", False), 4: ("--", False), 9: ("-", True), 16: ("-.", True)}
OTHER: tuple[Any, bool] = ((0, (4, 1, 1, 1, 1, 1)), False)  # of any other particle count: line, and whether filled
SEVERAL = 6  # series; with more, a legend names methods and particle counts apart
INK, GREY, LIGHT = "#1b1f24", "#5b6570", "#d8dde2"
RC: dict[Any, Any] = {  # matplotlib types the keys as literals
    "font.family": "DejaVu Sans",  # ships with matplotlib: the same letters on every machine
    "font.size": 11.0,
    "axes.labelsize": 11.5,
    "axes.titlesize": 12.0,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": LIGHT,
    "grid.linewidth": 0.6,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.minor.bottom": False,
    "lines.linewidth": 1.8,
    "lines.markersize": 7.0,
    "legend.frameon": False,
    "svg.hashsalt": "mpm-verify",
    "pdf.fonttype": 3,
}
# Neither a date nor a version: a figure changes when its numbers do.
METADATA: dict[str, dict[str, Any]] = {
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    "png": {"Software": None},
}
PANEL = (4.8, 5.0)  # inches: a panel shown alone


@dataclass(frozen=True)
class Look:
    """Look of a series; `plot` has the arguments for matplotlib."""

    colour: str
    marker: str
    line: Any
    filled: bool

    @property
    def plot(self) -> dict[str, Any]:
        """Keyword arguments for Axes.plot."""
        face = self.colour if self.filled else "white"
        return {
            "color": self.colour,
            "marker": self.marker,
            "linestyle": self.line,
            "markerfacecolor": face,
            "markeredgewidth": 1.5,
        }


def look(methods: Sequence[str], method: str, ppc: int) -> Look:
    """Look of a series; `methods` are those of the study, in its order."""
    number = list(methods).index(method)
    line, filled = LINES.get(ppc, OTHER)
    return Look(COLOURS[number % len(COLOURS)], MARKERS[number % len(MARKERS)], line, filled)


def legend(figure: Figure, methods: Sequence[str], series: Sequence[tuple[str, int]], columns: int = 2) -> None:
    """Draw the legend below the panels, so that it covers no point: each series, or each method and particle count."""
    if len(series) <= SEVERAL:
        handles = [
            Line2D([], [], label=f"{words.method(m)}, {ppc} per cell", **look(methods, m, ppc).plot)
            for m, ppc in series
        ]
    else:
        named = [m for m in methods if m in {method for method, _ in series}]
        handles = [Line2D([], [], label=words.method(m), **look(methods, m, 9).plot) for m in named]
        for ppc in sorted({ppc for _, ppc in series}):
            line, filled = LINES.get(ppc, OTHER)
            drawn = Look(GREY, "o", line, filled)
            handles.append(Line2D([], [], label=f"{ppc} per cell", **drawn.plot))
        columns = max(columns, 3)
    tight = {"fontsize": 10.0, "handlelength": 2.0, "columnspacing": 0.9} if len(series) > SEVERAL else {}
    usual = {"handlelength": 2.6, "columnspacing": 1.4}
    figure.legend(handles=handles, loc="outside lower center", ncols=columns, **{**usual, **tight})


def panel(size: tuple[float, float], **settings: Any) -> tuple[Figure, Axes]:
    """Figure of one panel, and its axes; size in inches."""
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots()
    axes.set(**settings)
    return figure, axes


def error_axis(axes: Axes) -> None:
    """Set the ticks of a logarithmic axis of errors, also where it spans less than a decade."""
    low, high = axes.get_ylim()
    parts = (1.0,) if high / low > 30 else (1.0, 2.0, 5.0) if high / low > 2 else tuple(np.arange(10, 100) / 10)
    axes.yaxis.set_major_locator(LogLocator(subs=parts, numticks=8))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(number)


def number(value: float, _: object = None) -> str:
    """Text of a tick as in the tables: 2e-4, 2.5e-4, 0."""
    digits, exponent = f"{value:.3e}".split("e")
    return f"{digits.rstrip('0').rstrip('.')}e{int(exponent)}" if value else "0"


def save(figure: Figure, folder: Path, name: str, kinds: Sequence[str] = ("svg", "pdf", "png")) -> bytes:
    """Write name.svg, .pdf and .png into `folder` and give the first; the same figure gives the same bytes."""
    with rc_context(RC):
        figure.draw_without_rendering()
        figure.set_layout_engine("none")  # laid out once: three formats would do it three times
        for kind in kinds:
            buffer = io.BytesIO()
            figure.savefig(buffer, format=kind, metadata=METADATA[kind], dpi=200)
            (folder / f"{name}.{kind}").write_bytes(buffer.getvalue())
    return (folder / f"{name}.{kinds[0]}").read_bytes()
