"""Power and safety of the order rule: fractions of the three outcomes, for each sequence, set of levels and scatter."""

from collections.abc import Sequence

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import Patch

from mpm_verify.cases.judging.power import Row
from mpm_verify.reports.figures import style
from mpm_verify.reports.sentences import power as words

PASS, FAIL, LEFT, WRONG = "#009E73", "#D55E00", "#e4e8ec", "#1b1f24"
HEIGHT, GAP = 0.72, 0.5


def power_figure(rows: Sequence[Row]) -> Figure:
    """Figure: a bar of PASS, INCONCLUSIVE and FAIL; a frame around what is wrong of it."""
    names = list(dict.fromkeys(row.sequence for row in rows))
    levels = list(dict.fromkeys(row.levels for row in rows))
    scatters = list(dict.fromkeys(row.scatter for row in rows))
    with rc_context(style.RC | {"axes.grid": False, "hatch.linewidth": 0.8}):
        figure = Figure(figsize=(12.4, 7.4), layout=ConstrainedLayoutEngine(rect=(0.02, 0, 0.98, 1)))
        axes = figure.subplots()
        for row in rows:
            column = levels.index(row.levels) * (len(scatters) + GAP) + scatters.index(row.scatter)
            _bar(axes, row, column, names.index(row.sequence))
        columns = [k * (len(scatters) + GAP) + i for k in range(len(levels)) for i in range(len(scatters))]
        axes.set_xticks([x + 0.45 for x in columns], [words.scatter(s) for s in scatters] * len(levels))
        axes.set_yticks(range(len(names)), [words.name(name) for name in names])
        axes.set(xlim=(-0.1, columns[-1] + 1), ylim=(len(names) - 0.4, -1.5), xlabel="scatter of an error")
        for k, name in enumerate(levels):
            axes.text(k * (len(scatters) + GAP), -0.75, words.levels(name), fontsize=10.5, color=style.INK)
        axes.tick_params(length=0)
        for side in axes.spines.values():
            side.set_visible(False)
        figure.legend(handles=_handles(), loc="outside lower center", ncols=4, fontsize=10.5)
    return figure


def _bar(axes: Axes, row: Row, x: float, y: int) -> None:
    """Draw one bar, 0.9 wide."""
    start = x
    parts = ((row.passed, PASS, ""), (row.left, LEFT, ""), (row.failed, FAIL, "////"))
    for count, colour, hatch in parts:
        width = 0.9 * count / row.draws
        if width:
            axes.barh(y, width, HEIGHT, left=start, color=colour, hatch=hatch, edgecolor="white", linewidth=0)
        if width and colour == (FAIL if row.sound else PASS):
            axes.barh(y, width, HEIGHT, left=start, fill=False, edgecolor=WRONG, linewidth=1.4)
        start += width


def _handles() -> list[Patch]:
    """Entries of the legend."""
    return [
        Patch(color=PASS, label="PASS"),
        Patch(color=LEFT, label="INCONCLUSIVE"),
        Patch(facecolor=FAIL, hatch="////", edgecolor="white", label="FAIL"),
        Patch(fill=False, edgecolor=WRONG, linewidth=1.4, label="wrong: bad that passes, sound that fails"),
    ]
