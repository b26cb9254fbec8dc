"""Error of u against the particles per cell, log-log, a figure for each method, a line for each cell size.

Where the lines fall to the right, the sums over particles are the error; where they are flat, the grid is.
"""

from dataclasses import replace
from itertools import pairwise
from math import log10

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from mpm_verify.cases.harness.axes import ParticleAxis, particle_axes
from mpm_verify.reports import words
from mpm_verify.reports.figures import drawn, style
from mpm_verify.reports.figures.convergence import methods
from mpm_verify.reports.frames import Record

SIZE = (4.8, 4.2)
APART = 0.05  # of the height of the panel: least distance of two labels


def particles(record: Record, solution: str, quantity: str = "u", norm: str = "rms") -> dict[str, Figure]:
    """A figure for each method of one solution that has two particle counts, on one scale of errors."""
    axes = particle_axes(record.study.runs, record.results, quantity, norm)
    found = [a for a in axes if a.run.solution == solution and min(a.errors) > 0]
    figures = {}
    with rc_context(style.RC):
        for method in dict.fromkeys(a.run.method for a in found):
            figures[method] = figure = Figure(figsize=SIZE, layout="constrained")
            panel = figure.subplots()
            every = [e for a in found for e in a.errors]
            panel.set(xscale="log", yscale="log", ylim=(min(every) / 1.6, max(every) * 1.6))
            _draw(panel, record, [a for a in found if a.run.method == method])
            style.error_axis(panel)
            panel.set_xlabel("particles per cell")
            panel.set_ylabel(f"error of {words.quantity(quantity)}, {norm}")
            panel.set_title(words.method(method), loc="left", fontweight="bold")
    return figures


def _apart(heights: list[float], least: float) -> list[float]:
    """Heights, those closer than `least` moved up."""
    moved = list(heights)
    order = sorted(range(len(heights)), key=lambda i: heights[i])
    for below, above in pairwise(order):
        moved[above] = max(moved[above], moved[below] + least)
    return moved


def _draw(panel: Axes, record: Record, found: list[ParticleAxis]) -> None:
    """Draw the lines of one method, the finest the darkest, each with its cell size at its end."""
    look = style.look(methods(record), found[0].run.method, 9)
    counts = sorted({count for a in found for count in a.ppc})
    found = sorted(found, key=lambda a: a.run.cells)
    heights = _apart([log10(a.errors[-1]) for a in found], APART * float(np.ptp(np.log10(panel.get_ylim()))))
    for number, (a, height) in enumerate(zip(found, heights, strict=True)):
        depth = 0.35 + 0.65 * (number + 1) / len(found)
        colour = tuple(1 - depth * (1 - part) for part in to_rgb(look.colour))
        lines = panel.plot(a.ppc, a.errors, color=colour, marker=look.marker, label=words.cell_size(a.run.cells))
        drawn.of_runs(lines, [replace(a.run, ppc=count) for count in a.ppc])
        panel.annotate(
            words.cell_size(a.run.cells), (a.ppc[-1], 10**height), (8, 0), textcoords="offset points",
            va="center", fontsize=9.5, color=style.GREY,
        )  # fmt: skip
    panel.set_xticks(counts, [str(count) for count in counts])
    panel.xaxis.set_minor_locator(NullLocator())
    panel.set_xlim(counts[0] / 1.25, counts[-1] * (counts[-1] / counts[0]) ** 0.2)
