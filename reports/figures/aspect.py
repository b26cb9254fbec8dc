"""Figure of the run-out against the aspect ratio, both logarithmic, with the scalings of the experiment."""

from collections.abc import Sequence

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from mpm_verify.cases.column.aspect import BETWEEN, FACTORS, Line, scaling
from mpm_verify.reports.figures import style
from mpm_verify.reports.figures.column import SAND, SIZE, legend

TICKS = (0.2, 0.5, 1, 2, 5, 10, 20)
POINTS = 200


def run_out(lines: Sequence[Line], labels: Sequence[str]) -> Figure:
    """Run-out over the width against height over width, in a band between the forms of the scaling.

    Parameters
    ----------
    lines
        Columns at rest, by aspect.
    labels
        Name of each line.
    """
    aspects = [point.aspect for line in lines for point in line.points]
    found = [point.run_out for line in lines for point in line.points]
    a = np.geomspace(min(aspects) / 1.2, max(aspects) * 1.2, POINTS)
    bands = np.array([scaling(float(one)) for one in a])
    with rc_context(style.RC):
        figure, axes = style.panel(SIZE, xscale="log", yscale="log", xlabel="height / width of the column",
                                   ylabel="(front at rest − width) / width")  # fmt: skip
        axes.fill_between(a, bands[:, 0], bands[:, 1], color=SAND, linewidth=0, label="experiment, as quoted")
        for (linear, power), dashes in zip(FACTORS, ((0, (5, 2)), (0, (1, 1.5))), strict=True):
            squat, tall = a[a <= BETWEEN[1]], a[a >= BETWEEN[0]]
            name = f"{linear:g} a, {power:g} a$^{{2/3}}$"
            axes.plot(squat, linear * squat, color=style.GREY, linewidth=1.1, linestyle=dashes, label=name)
            axes.plot(tall, power * tall ** (2 / 3), color=style.GREY, linewidth=1.1, linestyle=dashes)
        for number, (line, label) in enumerate(zip(lines, labels, strict=True)):
            axes.plot([point.aspect for point in line.points], [point.run_out for point in line.points],
                      color=style.COLOURS[number % len(style.COLOURS)], label=label,
                      marker=style.MARKERS[number % len(style.MARKERS)])  # fmt: skip
        for axis, low, high in ((axes.xaxis, a[0], a[-1]), (axes.yaxis, *reach(bands, found))):
            shown = [tick for tick in TICKS if low <= tick <= high]
            axis.set_ticks(shown, [f"{tick:g}" for tick in shown])
            axis.set_minor_locator(NullLocator())
        axes.set(xlim=(a[0], a[-1]), ylim=reach(bands, found))
        legend(figure, ["experiment", *(name for name in labels), "", ""])
    return figure


def reach(bands: np.ndarray, found: Sequence[float]) -> tuple[float, float]:
    """Limits of the run-out, above zero."""
    low = min(bands.min(), *(one for one in found if one > 0), bands.max())
    return 0.85 * float(low), 1.15 * float(max(bands.max(), *found))
