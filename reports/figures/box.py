"""Figures of sand in a box: what each particle carries, what the rows carry, and how it came to rest."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure

from mpm_verify.cases.box.case import AROUND, FREE, TOP, WEIGHT, K, known
from mpm_verify.cases.box.run import LOW, ROWS, Run
from mpm_verify.reports.figures import style

Drawn = tuple[str, Run, dict[str, Any]]  # label, run, and arrays of a run
BAND = "#e8d5a3"
EMPTY = "#ffffff"
MAP = LinearSegmentedColormap.from_list("stress", ["#f3e6c4", "#e69f00", "#d55e00", "#5a1f00"])
MOST = 3.0  # of the weight of the column: where the colours end


def sand(runs: Sequence[Drawn]) -> Figure:
    """Domains, or particles, of each run at its end by their sigma_yy; white where a particle has no stress."""
    with rc_context(style.RC):
        wide = max(4.4, 2.0 * len(runs) + 1.0)
        figure = Figure(figsize=(wide, 5.2), layout="constrained")
        panels = figure.subplots(1, len(runs), squeeze=False)[0]
        for axes, (label, run, arrays) in zip(panels, runs, strict=True):
            colours = norm_of(run, arrays)
            tall = 1.12 * run.height
            axes.set(xlim=(-0.02 * run.width, 1.02 * run.width), ylim=(-0.02 * run.height, tall), aspect="equal",
                     xticks=[], yticks=[])  # fmt: skip
            drawn(axes, run, arrays, colours)
            axes.plot([0, 0, run.width, run.width], [tall, 0, 0, tall], color=style.INK, linewidth=2.0)
            axes.axhline(run.height, color=style.GREY, linewidth=1.0, linestyle=(0, (2, 2)))
            axes.grid(False)
            axes.spines[:].set_visible(False)
            axes.set_title(label, fontsize=10.5)
        image = axes.collections[0]
        figure.colorbar(image, ax=list(panels), label=r"$\sigma_{yy}$ / weight of the column", shrink=0.7, extend="max")
    return figure


def norm_of(run: Run, arrays: dict[str, Any]) -> Any:
    """Stress sigma_yy (P,) over the weight of the column; masked where a particle has no stress."""
    sigma = np.asarray(arrays["end_sigma"], float)
    idle = (sigma == 0).all(axis=1)
    return np.ma.masked_array(-sigma[:, 1] / float(arrays["bottom"]), idle)


def drawn(axes: Axes, run: Run, arrays: dict[str, Any], values: Any) -> None:
    """Draw quadrilaterals, or points where there are none."""
    colours = MAP.with_extremes(bad=EMPTY)
    norm: Any = Normalize(0, MOST)
    line: dict[str, Any] = {"edgecolors": style.GREY, "linewidths": 0.25, "rasterized": True}
    if "end_corners" in arrays:
        shapes = PolyCollection(list(np.asarray(arrays["end_corners"], float)), cmap=colours, norm=norm, **line)
        shapes.set_array(values)
        axes.add_collection(shapes)
        return
    x = np.asarray(arrays["end_x"], float)
    axes.scatter(x[:, 0], x[:, 1], s=9.0, c=values, cmap=colours, norm=norm, plotnonfinite=True, **line)


def rows(runs: Sequence[Drawn]) -> Figure:
    """Weight that each row carries, and K, against height; bands are what is asked, where it is judged."""
    with rc_context(style.RC):
        figure = Figure(figsize=(7.6, 4.6), layout="constrained")
        weight, ratio = figure.subplots(1, 2, sharey=True)
        weight.axvspan(1 - WEIGHT, 1 + WEIGHT, color=BAND, linewidth=0)
        if judged(runs)[1]:
            ratio.axvspan(K - AROUND, K + AROUND, ymax=LOW / ROWS, color=BAND, linewidth=0)
        middles = (np.arange(ROWS) + 0.5) / ROWS
        for number, (label, _, arrays) in enumerate(runs):
            for axes, key in ((weight, "weight"), (ratio, "K")):
                axes.plot(arrays["rested"][key], middles, label=label, **mark(number))
        weight.set(xlabel=r"$\Sigma V \sigma_{yy}$ / weight above", ylabel="height / height of the column", ylim=(0, 1))
        ratio.set(xlabel=r"$\Sigma V \sigma_{xx}$ / $\Sigma V \sigma_{yy}$")
        below(figure, weight)
    return figure


def times(runs: Sequence[Drawn]) -> Figure:
    """Particles without stress, and the top, against time; bands are what is asked, where it is judged."""
    with rc_context(style.RC):
        figure = Figure(figsize=(7.6, 4.0), layout="constrained")
        free, top = figure.subplots(1, 2)
        stressed, band = judged(runs)
        if stressed:
            free.axhspan(0, FREE, color=BAND, linewidth=0)
        if band:
            top.axhspan(1 - TOP, 1 + TOP, color=BAND, linewidth=0)
        for number, (label, _, arrays) in enumerate(runs):
            look = {key: value for key, value in mark(number).items() if key in ("color", "linestyle")}
            free.plot(arrays["curve_t"], arrays["curve_free"], label=label, linewidth=1.2, **look)
            top.plot(arrays["curve_t"], arrays["curve_top"], linewidth=1.2, **look)
        free.set(xlabel="time [s]", ylabel="fraction of particles without stress", ylim=(0, 1.02))
        top.set(xlabel="time [s]", ylabel="top / height of the column", ylim=(0.9, None))
        below(figure, free)
    return figure


def judged(runs: Sequence[Drawn]) -> tuple[bool, bool]:
    """Whether particles without stress are judged of any run, and whether K and top are."""
    marks = [known(run) for _, run, _ in runs]
    return any(not free for free, _ in marks), any(not band for _, band in marks)


def mark(number: int) -> dict[str, Any]:
    """Colour, mark and line of a run by its number."""
    colours, marks, lines = style.COLOURS, style.MARKERS, ("-", "--", ":")
    return {
        "color": colours[number % len(colours)],
        "marker": marks[number % len(marks)],
        "linestyle": lines[number % len(lines)],
        "markerfacecolor": "white",
    }


def below(figure: Figure, axes: Axes) -> None:
    """Draw a legend below, where there are several runs."""
    handles, labels = axes.get_legend_handles_labels()
    if len(labels) > 1:
        figure.legend(handles, labels, loc="outside lower center", ncols=2 if max(map(len, labels)) < 34 else 1)
