"""Figures of the collapsing column in the paper's style: fronts, profiles, energies, set-up, snapshots, refinement.

The band of the experiment is shaded where it is known; it is no curve. Time is counted in sqrt(h0/g).
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from mpm_verify.cases.column.experiment import Experiment, experiment
from mpm_verify.cases.column.records import FinishedRun
from mpm_verify.cases.column.refined import Refined
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.reports.figures import style
from mpm_verify.reports.sentences import column as words
from mpm_verify.solver.state import Floats

WIDE = 5.4
SIZE = WIDE, 4.4
LINES, LINE = 2, 0.24  # of a legend that such a figure has room for; height of one more, inches
SAND = "#e8d5a3"
DARK, PALE = "#4a3728", "#d9bf86"  # bands of sand, as in the experiment
BANDS = 10  # of the column's height
STROKES: tuple[Any, ...] = ("-", "--", ":", "-.")
FRONTS = {"front_99": "front, 99 % of the mass [m]", "toe": "toe [m]"}
PROFILES = {"profile": "height, 99 % of the mass [m]", "profile_volume": "volume over width [m]"}
TIME = "time / $\\sqrt{h_0/g}$"
Labels = Sequence[str]


def shared_experiment(ran: Sequence[FinishedRun]) -> Experiment | None:
    """Bands of the experiment, where all runs are of one size of column."""
    sizes = {(one.run.width, one.run.aspect, one.run.g) for one in ran}
    return experiment(ran[0].run) if len(sizes) == 1 else None


def fronts(ran: Sequence[FinishedRun], labels: Labels) -> Figure:
    """Front, within which 99 % of the mass lies, and toe against time."""
    known, tau = shared_experiment(ran), ran[0].run.tau
    last = max(float(one.curves["t"][-1]) for one in ran) / tau
    with rc_context(style.RC):
        figure, panels = stacked(FRONTS)
        for axes, name in zip(panels, FRONTS, strict=True):
            if known:
                resting(axes, known, last, axes is panels[0])
            for number, (one, label) in enumerate(zip(ran, labels, strict=True)):
                axes.plot(one.curves["t"] / one.run.tau, one.curves[name], label=label, **stroke(number))
            axes.set(xlim=(0, last), ylim=(0, None))
        panels[-1].set_xlabel(TIME)
        legend(figure, labels)
    return figure


def resting(axes: Axes, known: Experiment, last: float, named: bool) -> None:
    """Shade where the experiment's front rests until the `last` time, with dashes at the times of that."""
    low, high = known.front
    axes.add_patch(Rectangle((known.rest[0], low), last - known.rest[0], high - low, color=SAND, linewidth=0))
    for time in known.rest:
        axes.plot([time, time], [low, high], color=style.GREY, linewidth=1, linestyle=(0, (2, 2)))
    if named:
        axes.annotate("experiment, at rest", (last, low), xytext=(-4, -4), textcoords="offset points", ha="right",
                      va="top", color=style.GREY, fontsize=10)  # fmt: skip


def stacked(names: Mapping[str, str]) -> tuple[Figure, Sequence[Axes]]:
    """Figure with a panel for each name, one above the other, on one axis of x."""
    figure = Figure(figsize=(WIDE, 1.0 + 3.2 * len(names)), layout="constrained")
    panels = figure.subplots(len(names), 1, squeeze=False, sharex=True)[:, 0]
    for axes, name in zip(panels, names.values(), strict=True):
        axes.set_ylabel(name)
    return figure, list(panels)


def profiles(ran: Sequence[FinishedRun], labels: Labels) -> Figure:
    """Surfaces at the end, by mass and by volume, the column there was, and what is known of the experiment."""
    names = {name: text for name, text in PROFILES.items() if all(name in one.curves for one in ran)}
    run, known = ran[0].run, shared_experiment(ran)
    far = 1.05 * max(one.values["front_999"] for one in ran)
    with rc_context(style.RC):
        figure, panels = stacked(names)
        for axes, name in zip(panels, names, strict=True):
            tall = 1.15 * max(float(one.curves[name][-1].max()) for one in ran)
            if known:
                tall = max(tall, 1.1 * known.height[1])
                deposit(axes, run, known, tall, axes is panels[0])
            axes.plot([run.width, run.width], [0, tall], color=style.GREY, linewidth=1, linestyle=(0, (2, 2)))
            for number, (one, label) in enumerate(zip(ran, labels, strict=True)):
                height = one.curves[name][-1]
                axes.plot((np.arange(len(height)) + 0.5) * one.run.strip, height, label=label, **stroke(number))
            axes.set(xlim=(0, far), ylim=(0, tall))
        panels[-1].set_xlabel("distance from the wall [m]")
        legend(figure, labels)
    return figure


def deposit(axes: Axes, run: ColumnRun, known: Experiment, tall: float, named: bool) -> None:
    """Shade where the experiment's front came to rest, and its height at the wall; with names where it is `named`."""
    axes.axvspan(*known.front, color=SAND, linewidth=0)
    axes.add_patch(Rectangle((0, known.height[0]), 0.25 * run.width, known.height[1] - known.height[0],
                             color=SAND, linewidth=0))  # fmt: skip
    if named:
        axes.annotate("experiment:\nfront", (sum(known.front) / 2, tall), xytext=(0, -4), va="top", ha="center",
                      textcoords="offset points", color=style.GREY, fontsize=10)  # fmt: skip
        beside = (1.1 * run.width, sum(known.height) / 2)
        axes.annotate("its height at the wall", beside, va="center", color=style.GREY, fontsize=10)


def energy(ran: Sequence[FinishedRun], labels: Labels, name: str) -> Figure:
    """Energy of each run over the initial potential energy."""
    with rc_context(style.RC):
        figure, axes = style.panel(SIZE, xlabel=TIME, ylabel=f"{words.ENERGIES[name]}\n/ initial potential energy")
        for number, (one, label) in enumerate(zip(ran, labels, strict=True)):
            part = one.curves[name] / one.curves["potential"][0]
            axes.plot(one.curves["t"] / one.run.tau, part, label=label, **stroke(number))
        axes.set(xlim=(0, None), ylim=(0, None))
        legend(figure, labels)
    return figure


def budget(one: FinishedRun) -> Figure:
    """Energy budget of one run, layer upon layer: together the initial potential energy, and what pooling has given."""
    c, start = one.curves, float(one.curves["potential"][0])
    layers = {
        "potential": c["potential"], "kinetic": c["kinetic"], "elastic": c["elastic"], "plastic": c["plastic"],
        "damping": c["damping"], "walls": -c["walls"], "lost by the method": c["transfer"] + c["convection"],
        "pooling": c.get("pooled", 0 * c["t"]),
    }  # fmt: skip
    with rc_context(style.RC):
        figure, axes = style.panel(SIZE, xlabel=TIME, ylabel="energy / initial potential energy")
        below, t, shown = np.zeros_like(c["t"]), c["t"] / one.run.tau, []
        for (name, layer), colour in zip(layers.items(), style.COLOURS, strict=False):
            above = below + layer / start
            if np.abs(layer).max() > 1e-4 * start:
                axes.fill_between(t, below, above, color=colour, alpha=0.75, linewidth=0, label=name)
                shown.append(name)
            below = above
        axes.plot(t, below - c.get("given", 0.0) / start, color=style.INK, linewidth=1.0)
        axes.set(xlim=(0, t[-1]), ylim=(0, max(1.05, 1.02 * float(below.max()))))
        legend(figure, shown, columns=3)
    return figure


def set_up(run: ColumnRun, x: Floats, corners: Floats | None) -> Figure:
    """Set-up, the paper's Figure 3: the column before it is released, and a corner of it with cells and domains."""
    dx = run.width / run.cells
    with rc_context(style.RC):
        figure = Figure(figsize=(WIDE, 5.6), layout="constrained")
        whole, near = figure.subplots(1, 2, width_ratios=(1, 1.25))
        for axes in (whole, near):
            domains(axes, run, x, corners, edge=axes is near)
            axes.set_aspect("equal")
            axes.grid(False)
        whole.set(xlim=(-0.02, 2.2 * run.width), ylim=(-0.02, 1.06 * run.height), xticks=[0, run.width],
                  yticks=[0, run.height], xticklabels=["0", f"{1e3 * run.width:g}"],
                  yticklabels=["0", f"{1e3 * run.height:g}"], xlabel="[mm]")  # fmt: skip
        for axes in (whole, near):
            wall(axes, run)
        some = min(7, run.cells)
        low, high = run.width - (some - 1.5) * dx, run.width + 1.5 * dx
        near.set(xlim=(low, high), ylim=(-0.5 * dx, (2 * some - 0.5) * dx), xticks=[], yticks=[])
        for k in range(-1, 2 * some + 1):
            near.axhline(k * dx, color=style.GREY, linewidth=0.7, zorder=3)
            near.axvline(run.width + (k - some) * dx, color=style.GREY, linewidth=0.7, zorder=3)
        near.plot(*x.T, linestyle="none", marker="o", markersize=2.4, color="#0072B2", zorder=4)
        near.set_title(f"its free foot: cells of {1e3 * dx:.2f} mm,\n{run.ppc} per cell", fontsize=10.5)
    return figure


def wall(axes: Axes, run: ColumnRun) -> None:
    """Draw floor and wall as thick lines."""
    axes.plot([0, 0, 40 * run.width], [2 * run.height, 0, 0], color=style.INK, linewidth=2.0, zorder=5,
              solid_capstyle="butt", scalex=False, scaley=False)  # fmt: skip


def snapshots(run: ColumnRun, arrays: Mapping[str, Any], most: int = 6) -> Figure:
    """Snapshots of domains, or particles, at a few times; bands of sand by the height at which they began."""
    times = arrays["snapshot_t"]
    chosen = sorted({*range(min(most, len(times)) - 1), len(times) - 1})  # it moves at first
    far = 1.04 * float(np.quantile(away(run, arrays["snapshot_x"][-1])[:, 0], 0.9995))
    columns, width = 3, 3.9
    rows, height = -(-len(chosen) // columns), width * run.height / far + 0.55
    with rc_context(style.RC):
        figure = Figure(figsize=(columns * width, rows * height), layout="constrained")
        panels = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel()
        first = away(run, arrays["snapshot_x"][0])[:, 1]
        for axes, number in zip(panels, chosen, strict=False):
            x, corners = away(run, arrays["snapshot_x"][number]), arrays.get("snapshot_corners")
            domains(axes, run, x, None if corners is None else away(run, corners[number]), first=first)
            wall(axes, run)
            axes.set(xlim=(-0.01, far), ylim=(-0.012, 1.02 * run.height), aspect="equal")
            axes.set_title(
                f"t = {times[number]:.2f} s = {times[number] / run.tau:.1f} $\\sqrt{{h_0/g}}$", fontsize=10.5
            )
            axes.grid(False)
        for axes in panels[len(chosen) :]:
            axes.set_visible(False)
    return figure


def away(run: ColumnRun, positions: Any) -> Floats:
    """Positions with the wall at x = 0, as float64."""
    found = np.array(positions, float)
    if run.mirror:
        found[..., 0] = run.channel * run.width - found[..., 0]
    return found


def domains(
    axes: Axes, run: ColumnRun, x: Floats, corners: Floats | None, edge: bool = False, first: Floats | None = None
) -> None:
    """Draw domains as quadrilaterals, particles as points where they have none."""
    height = x[:, 1] if first is None else first
    dark = (height / run.height * BANDS).astype(int) % 2 == 0
    colours = np.where(dark[:, None], [DARK], [PALE])[:, 0]
    if corners is None:
        axes.scatter(x[:, 0], x[:, 1], s=1.2, c=colours, linewidths=0, rasterized=True)
        return
    line: dict[str, Any] = (
        {"edgecolors": "white", "linewidths": 0.5} if edge else {"edgecolors": "face", "linewidths": 0.2}
    )
    axes.add_collection(PolyCollection(list(corners), facecolors=colours, rasterized=True, **line))


def refined(series: Sequence[Refined], xlabel: str) -> Figure:
    """Figure of each quantity over its finest value, against the spacing, a mark a level."""
    with rc_context(style.RC):
        figure, axes = style.panel(SIZE, xlabel=xlabel, ylabel="value over that of the finest level")
        for number, one in enumerate(series):
            values = np.array([value for _, value in one.levels])
            axes.plot(range(len(values)), values / values[0], marker=style.MARKERS[number % len(style.MARKERS)],
                      label=words.quantity(one.quantity), **stroke(number))  # fmt: skip
        numbers = [f"{value:g}" for value, _ in series[0].levels]  # the axis says of what
        axes.set_xticks(range(len(numbers)), numbers)
        axes.invert_xaxis()
        legend(figure, [words.quantity(one.quantity) for one in series])
    return figure


def stroke(number: int) -> dict[str, Any]:
    """Colour and line of a run by its number in the study: no two of 32 alike."""
    return {
        "color": style.COLOURS[number % len(style.COLOURS)],
        "linestyle": STROKES[(number // len(style.COLOURS) + number) % len(STROKES)],
    }


def legend(figure: Figure, labels: Labels, columns: int = 2) -> None:
    """Draw the legend below, in as many columns as labels leave room for; for many lines the figure grows."""
    handles, names = figure.axes[0].get_legend_handles_labels()
    if len(labels) > 1:
        longest = max(map(len, labels))
        columns = 1 if longest > 34 else columns
        wide, high = figure.get_size_inches()
        figure.set_size_inches(wide, high + LINE * max(0, -(-len(labels) // columns) - LINES))
        figure.legend(handles, names, loc="outside lower center", ncols=columns, fontsize=10, handlelength=2.4)
