"""Figure of the speed of methods: time of a step over that of another method, as bars."""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

from mpm_verify.reports.figures import style


def bars(rows: Sequence[Mapping[str, Any]], labels: Sequence[str], name: str) -> Figure:
    """Bars of the ratios with their quartiles, the first row on top; `name` is that of the axis."""
    with rc_context(style.RC):
        figure, axes = style.panel((6.4, 1.0 + 0.42 * len(rows)))
        ratios = [row["ratio"] for row in rows]
        spread = [[row["ratio"] - row["low"] for row in rows], [row["high"] - row["ratio"] for row in rows]]
        axes.barh(labels, ratios, color=style.COLOURS[0], xerr=spread, ecolor=style.INK, capsize=3.0)
        axes.axvline(1.0, color=style.GREY, linewidth=1.0, linestyle=(0, (2, 2)))
        axes.invert_yaxis()
        axes.set_axisbelow(True)
        axes.grid(False, axis="y")
        axes.set_xlabel(name)
    return figure
