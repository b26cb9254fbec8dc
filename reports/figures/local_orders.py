"""Local orders: the order between consecutive cell sizes, which shows whether the order has settled."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpm_verify.cases.harness.refinement import Series
from mpm_verify.cases.judging.fit import local_orders
from mpm_verify.reports import words
from mpm_verify.reports.figures import drawn, style
from mpm_verify.reports.figures.convergence import methods
from mpm_verify.reports.frames import Record


def orders(record: Record, series: Series, quantity: str, norm: str) -> list[tuple[int, int, float]]:
    """Triples (cells, cells, order) of consecutive finished runs, coarse to fine; none for errors of zero."""
    found = [(run.cells, error) for run, error in record.errors(series, quantity, norm) if error > 0]
    if len(found) < 2:
        return []
    cells, error = np.array([n for n, _ in found]), np.array([e for _, e in found])
    steps = local_orders(1 / cells, error).tolist()
    return [(int(a), int(b), p) for a, b, p in zip(cells[:-1], cells[1:], steps, strict=True)]


def local_order_figure(record: Record, solution: str, quantity: str = "u", norm: str = "rms") -> Figure:
    """Figure of the local orders of one solution with the registered band."""
    series = [s for s in record.drawn if s.first.solution == solution]
    with rc_context(style.RC):
        figure = Figure(figsize=(5.2, 4.8), layout="constrained")
        axes = figure.subplots()
        cells = sorted({run.cells for s in series for run in s.runs})
        shown = [s for s in series if _draw(axes, record, s, cells, quantity, norm)]
        _band(axes, record, solution, quantity, norm)
        axes.axhline(0, color=style.INK, linewidth=0.9)
        axes.set_xticks(range(len(cells) - 1), [f"1/{a} →\n1/{b}" for a, b in pairwise(cells)])
        axes.set_xlim(-0.5, max(len(cells) - 1.5, 0.5))
        axes.set(xlabel="from cell size to cell size", ylabel=f"local order of {words.quantity(quantity)}, {norm}")
        style.legend(figure, methods(record), [(s.first.method, s.first.ppc) for s in shown])
    return figure


def _draw(axes: Axes, record: Record, series: Series, cells: Sequence[int], quantity: str, norm: str) -> bool:
    """Draw a point for each pair of cell sizes; False where there is none."""
    found = orders(record, series, quantity, norm)
    positions = [(cells.index(a) + cells.index(b) - 1) / 2 for a, b, _ in found]
    look = style.look(methods(record), series.first.method, series.first.ppc)
    fine = {run.cells: run for run in series.runs}
    lines = axes.plot(positions, [p for *_, p in found], label=record.label(series.first, solution=False), **look.plot)
    drawn.of_runs(lines, [fine[b] for _, b, _ in found])
    return bool(found)


def _band(axes: Axes, record: Record, solution: str, quantity: str, norm: str) -> None:
    """Draw the band that was registered for the first judged order."""
    for plan in record.study.plans:
        e = plan.expectation
        if (
            e
            and e.order is not None
            and plan.judged
            and (plan.run.solution, plan.quantity, plan.norm) == (solution, quantity, norm)
        ):
            axes.axhspan(e.order - e.below, e.order + e.above, color="#009E73", alpha=0.16, linewidth=0)
            axes.annotate(
                "registered band", (0.02, e.order + e.above), (0, 3), color=style.GREY, fontsize=9.5,
                xycoords=("axes fraction", "data"), textcoords="offset points",
            )  # fmt: skip
            return
