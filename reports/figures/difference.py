"""Figure of where an answer is off from the nearest reference: first frame where the two part, and last frame."""

from collections.abc import Sequence

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpm_verify.cases.mms.digits.examine import Moment
from mpm_verify.cases.mms.digits.records import Parting
from mpm_verify.reports import words
from mpm_verify.reports.figures import style
from mpm_verify.reports.figures.error_field import draw

WIDTH, HEIGHT = 4.4, 4.7  # inches of a panel


def difference(moments: Sequence[Moment], partings: Sequence[Parting]) -> Figure:
    """Figure with a row for each quantity and a column for each moment; a ring marks the particle that is named."""
    names = list(moments[0].off)
    with rc_context(style.RC | {"axes.grid": False}):
        figure = Figure(figsize=(WIDTH * len(moments), HEIGHT * len(names)), layout="constrained")
        panels = figure.subplots(len(names), len(moments), squeeze=False)
        for row, name in zip(panels, names, strict=True):
            for axes, moment in zip(row, moments, strict=True):
                _draw(figure, axes, moment, name)
                for one in partings:
                    if (one.quantity, one.frame) == (name, moment.frame):
                        _mark(axes, moment, one.particle)
    return figure


def _draw(figure: Figure, axes: Axes, moment: Moment, name: str) -> None:
    """Draw how far each particle is off, on its domain."""
    bar = draw(figure, axes, moment.corners, moment.off[name])
    bar.set_label(f"|{words.quantity(name)} {words.MINUS} {words.quantity(name)} of the nearest reference|")
    axes.set_title(f"{words.quantity(name)}, frame {moment.frame}, step {moment.step}", loc="left", fontweight="bold")


def _mark(axes: Axes, moment: Moment, particle: int) -> None:
    """Draw a ring around a particle."""
    x, y = moment.corners[particle].mean(axis=0)
    axes.plot(x, y, "o", markersize=14, markerfacecolor="none", markeredgecolor=style.COLOURS[1], markeredgewidth=1.8)
