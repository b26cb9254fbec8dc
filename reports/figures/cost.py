"""Error against cost: particle updates, and processor seconds as measured, both log-log; a line a group of runs.

A row of two panels a title, so that a page shows several solutions. Points of one line are joined by rising cost.
Errors are over the rms of the exact quantity, so that rows can be compared.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpm_verify.cases.mms.run import Run
from mpm_verify.reports import words
from mpm_verify.reports.figures import drawn, style
from mpm_verify.reports.frames import Record

ROW, HEAD = 2.3, 0.9  # inches: height of a row of panels, and of legend and axis names
WIDTH = 8.6


@dataclass(frozen=True)
class Line:
    """Line of runs that belong together, with their name and their look (`style.Look.plot`)."""

    label: str
    runs: Sequence[Run]
    plot: dict[str, Any]


@dataclass(frozen=True)
class Row:
    """Row of panels."""

    title: str
    lines: Sequence[Line]


def cost_figure(record: Record, rows: Sequence[Row], quantity: str = "u", norm: str = "rms") -> Figure:
    """Figure with a row of panels for each Row; a legend of all labels below."""
    with rc_context(style.RC | {"lines.markersize": 5.0, "lines.linewidth": 1.4}):
        figure = Figure(figsize=(WIDTH, HEAD + ROW * len(rows)), layout="constrained")
        panels = figure.subplots(len(rows), 2, squeeze=False, sharey="row")
        for (left, right), row in zip(panels, rows, strict=True):
            for line in row.lines:
                _draw(left, right, record, line, quantity, norm)
            for panel in (left, right):
                if panel.lines:  # else there is nothing to take the range from
                    panel.set(xscale="log", yscale="log")
            left.set_title(row.title, loc="left", fontweight="bold", fontsize=10.5)
            left.set_ylabel(f"error of {words.quantity(quantity)}, relative", fontsize=10)
        panels[-1][0].set_xlabel("particle updates")
        panels[-1][1].set_xlabel("processor seconds")
        labels = {line.label: line for row in rows for line in row.lines}
        handles = [Line2D([], [], label=label, **line.plot) for label, line in labels.items()]
        figure.legend(handles=handles, loc="outside lower center", ncols=min(4, len(handles)), fontsize=10)
    return figure


def _draw(left: Axes, right: Axes, record: Record, line: Line, quantity: str, norm: str) -> None:
    """Draw one line in both panels."""
    points: list[tuple[float, float, float]] = []
    runs: dict[tuple[float, float, float], Run] = {}
    for run in line.runs:
        result, error = record.result(run), record.error(run, quantity, norm)
        if result and error and result.scale.get(quantity):
            points.append((result.updates, result.cpu_s, error / result.scale[quantity]))
            runs[points[-1]] = run
    points.sort()
    for panel, cost in ((left, 0), (right, 1)):
        if paid := [p for p in points if p[cost] > 0]:
            made = panel.plot([p[cost] for p in paid], [p[2] for p in paid], label=line.label, **line.plot)
            drawn.of_runs(made, [runs[p] for p in paid])
