"""Figures of a benchmark: curves of each method, and the known answer as a dark line."""

from collections.abc import Mapping

from matplotlib import rc_context
from matplotlib.figure import Figure

from mpm_verify.cases.benchmark.problem import EXACT, Drawn
from mpm_verify.reports.figures import style
from mpm_verify.solver.state import Floats

Curves = Mapping[str, Floats]  # (2,n) each, by name
SIZE = 5.4, 4.8
DASHES = ("-", "--", ":", "-.")
SMALL = 5.0  # size of marks


def drawn(figure: Drawn, runs: Mapping[str, Curves]) -> Figure:
    """Figure of the curves of each run, by the name that the legend has for it; the known answer is drawn once."""
    with rc_context(style.RC):
        made, axes = style.panel(SIZE, xlabel=figure.x, ylabel=figure.y)
        for number, (label, curves) in enumerate(runs.items()):
            mine = {name: curve for name, curve in curves.items() if name != EXACT}
            for k, (name, (x, y)) in enumerate(mine.items()):
                told = label if len(mine) == 1 else f"{label}, {name}"
                colour = style.COLOURS[(number if figure.lines else number * len(mine) + k) % len(style.COLOURS)]
                if figure.lines:
                    axes.plot(x, y, color=colour, linestyle=DASHES[(number + k) % len(DASHES)], label=told)
                else:
                    axes.plot(x, y, color=colour, linestyle="none", marker=style.MARKERS[k % len(style.MARKERS)],
                              markersize=SMALL, markerfacecolor="white", label=told)  # fmt: skip
        known = next((curves[EXACT] for curves in runs.values() if EXACT in curves), None)
        if known is not None:
            axes.plot(*known, color=style.INK, linewidth=1.0, zorder=3, label="known answer")
        made.legend(loc="outside lower center", ncols=2, fontsize=10.0)
    return made
