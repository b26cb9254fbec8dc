"""Scatter of the error of u over the positions of the particles in their cells: smallest to largest replicate.

Errors are over the middle one of their level, so that all levels have one axis.
"""

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpm_verify.cases.harness.axes import PositionAxis, position_axes
from mpm_verify.reports import words
from mpm_verify.reports.figures import style
from mpm_verify.reports.figures.convergence import methods
from mpm_verify.reports.frames import Record

WIDTH = 0.7  # of the room of a cell size, for all series


def position(record: Record, solution: str, quantity: str = "u", norm: str = "rms") -> Figure | None:
    """Figure of one solution, None where nothing has replicates."""
    axes = position_axes(record.study.runs, record.results, quantity, norm)
    found = [a for a in axes if a.run.solution == solution and min(min(e) for e in a.errors) > 0]
    if not found:
        return None
    cells = sorted({n for a in found for n in a.cells})
    with rc_context(style.RC):
        figure = Figure(figsize=style.PANEL, layout="constrained")
        panel = figure.subplots()
        for a, shift in zip(found, _shifts(len(found)), strict=True):
            _draw(panel, record, a, [cells.index(n) + shift for n in a.cells])
        panel.axhline(1, color=style.INK, linewidth=0.9, zorder=0)
        panel.set_xticks(range(len(cells)), [words.cell_size(n) for n in cells])
        panel.set_xlim(-0.5, len(cells) - 0.5)
        panel.set_xlabel("cell size")
        panel.set_ylabel(f"error of {words.quantity(quantity)}, {norm}, over its median")
        style.legend(figure, methods(record), [(a.run.method, a.run.ppc) for a in found])
    return figure


def _shifts(count: int) -> list[float]:
    """Shifts of bars beside each other."""
    return [WIDTH * ((number + 0.5) / count - 0.5) for number in range(count)]


def _draw(panel: Axes, record: Record, axis: PositionAxis, at: list[float]) -> None:
    """Draw a bar from the smallest to the largest error, a marker at the usual position of the particles."""
    look = style.look(methods(record), axis.run.method, axis.run.ppc)
    low, high = ([end[i] / end[1] for end in axis.ends] for i in (0, 2))
    panel.vlines(at, low, high, color=look.colour, linestyle=look.line, linewidth=1.6)
    usual = [errors[0] / end[1] for errors, end in zip(axis.errors, axis.ends, strict=True)]
    panel.plot(at, usual, **{**look.plot, "linestyle": "none", "markersize": 6})
