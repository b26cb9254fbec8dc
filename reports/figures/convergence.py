"""Figure 1 of the paper: error of u against cell size, log-log, once in `rms` and once in `printed`.

Runs that failed have no error; a strip above the axes marks with a cross at which cell size each of them failed.
"""

from collections.abc import Sequence
from typing import cast

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import NullLocator

from mpm_verify.cases.harness.refinement import Series
from mpm_verify.reports import words
from mpm_verify.reports.figures import drawn, style
from mpm_verify.reports.frames import Record

NORMS = ("rms", "printed")
EXTRA = {"rms": 0.0, "printed": 1.5}  # orders that the norm adds in 2-D with dt ~ h: cases/mms/norms.py
TITLES = {"rms": "rms: what verdicts use", "printed": "printed: shown, never judged"}


def convergence(record: Record, solution: str, quantity: str = "u") -> dict[str, Figure]:
    """The figures `figure1` (both panels, for a paper), `figure1_rms` and `figure1_printed` of one solution."""
    series = [s for s in record.drawn if s.first.solution == solution]
    with rc_context(style.RC):
        figures = {"figure1": Figure(figsize=(10.0, 5.4), layout="constrained")}
        left, right = cast(Sequence[SubFigure], figures["figure1"].subfigures(1, 2))
        for norm, part in zip(NORMS, (left, right), strict=True):
            _panel(part, record, series, quantity, norm)
        heads = [(s.first.method, s.first.ppc) for s in series]
        style.legend(figures["figure1"], methods(record), heads, columns=_columns(len(series)))
        for norm in NORMS:
            alone = figures[f"figure1_{norm}"] = Figure(figsize=style.PANEL, layout="constrained")
            _panel(alone, record, series, quantity, norm)
            style.legend(alone, methods(record), heads)
    return figures


def _columns(series: int) -> int:
    """Number of columns of the legend below both panels."""
    return series if series < 4 else 2 if series <= style.SEVERAL else 5


def cell_axis(axes: Axes, series: Sequence[Series]) -> None:
    """Draw a logarithmic axis of cell sizes with a tick 1/N at each that was asked for."""
    cells = sorted({run.cells for s in series for run in s.runs}, reverse=True)
    axes.set_xscale("log")
    given = any(s.first.given for s in series)
    plain = any(getattr(s.first, "by", "cells") == "h" for s in series)
    axes.set_xticks([1 / n for n in cells], [f"{1 / n:.4g}" if plain else words.size(1 / n) for n in cells])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xlim(0.75 / cells[0], 1.33 / cells[-1])
    axes.set_xlabel("cell size" if given else "cell size (width of the body = 1)")


def methods(record: Record) -> list[str]:
    """Methods of the study in its order: the order of their colours."""
    return list(dict.fromkeys(run.method for run in record.study.runs))


def _panel(part: Figure | SubFigure, record: Record, series: Sequence[Series], quantity: str, norm: str) -> None:
    """Draw one norm: the strip of failed runs if there are any, and the errors below it."""
    failed = [s for s in series if record.failed(s)]
    if failed:
        strip, axes = part.subplots(2, 1, sharex=True, height_ratios=[0.055 * len(failed) + 0.02, 1.0])
        _failures(strip, record, failed)
    else:
        strip = axes = part.subplots()
    for s in series:
        found = [(run, error) for run, error in record.errors(s, quantity, norm) if error > 0]
        h, e = [1 / run.cells for run, _ in found], [error for _, error in found]
        look = style.look(methods(record), s.first.method, s.first.ppc)
        drawn.of_runs(
            axes.plot(h, e, label=record.label(s.first, solution=False), **look.plot), [run for run, _ in found]
        )
    cell_axis(axes, series)
    axes.set_yscale("log")
    if not any(line.get_xdata().size for line in axes.lines):
        axes.set_ylim(1e-4, 1)
        axes.text(0.5, 0.5, "no finished run", transform=axes.transAxes, ha="center", color=style.GREY)
    axes.yaxis.set_major_formatter(style.number)
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_ylabel(f"error of {words.quantity(quantity)}, {norm}")
    _triangle(axes, record, series, quantity, norm)
    strip.set_title(TITLES[norm], loc="left", fontweight="bold")


def _failures(strip: Axes, record: Record, failed: Sequence[Series]) -> None:
    """Draw a row for each series, a cross at each cell size at which its run failed."""
    for row, s in enumerate(failed):
        colour = style.look(methods(record), s.first.method, s.first.ppc).colour
        h = [1 / run.cells for run in record.failed(s)]
        strip.plot(h, [row] * len(h), "x", color=colour, markersize=8, markeredgewidth=2.4, clip_on=False)
    names = [f"{words.method(s.first.method)} {s.first.ppc} failed" for s in failed]
    strip.set_yticks(range(len(failed)), names, fontsize=9)
    strip.set_ylim(len(failed) - 0.4, -0.6)
    strip.tick_params(length=0, labelbottom=False)
    strip.spines[:].set_visible(False)
    strip.set_facecolor("#f4f1ee")


def _triangle(axes: Axes, record: Record, series: Sequence[Series], quantity: str, norm: str) -> None:
    """Draw the slope to compare with, below all errors: the order registered, plus what the norm adds."""
    points = [(1 / run.cells, e) for s in series for run, e in record.errors(s, quantity, norm) if e > 0]
    sizes = sorted({h for h, _ in points})
    if len(sizes) < 2:
        return
    orders = [plan.expectation.order for plan in record.study.plans if plan.expectation and plan.expectation.order]
    order = orders[0] if orders else 2.0
    at = max(0, (len(sizes) - 1) // 2 - (len(sizes) > 4))
    h0, h1, slope = sizes[at], sizes[at + 1], order + EXTRA[norm]
    low = min(e * (h0 / h) ** slope for h, e in points) / 2.5
    x, y = [h0, h1, h1, h0], [low, low, low * (h1 / h0) ** slope, low]
    axes.plot(x, y, color=style.GREY, linewidth=1.3)
    text = f"{slope:g}" if not EXTRA[norm] else f"{slope:g} = {order:g} + {EXTRA[norm]:g}"
    middle = low * (h1 / h0) ** (slope / 2)
    axes.annotate(text, (h1, middle), (5, 0), textcoords="offset points", va="center", color=style.GREY)
    axes.annotate(
        "1", (np.sqrt(h0 * h1), low), (0, -3), textcoords="offset points", va="top", ha="center", color=style.GREY
    )
