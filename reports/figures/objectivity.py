"""Figures of frame indifference: the paper's Figure 2 (stress of a turned block), inertia, orders, rates in shear."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpm_verify.cases.harness.checks import Curves
from mpm_verify.reports.figures import style
from mpm_verify.solver.state import Floats

Curve = Mapping[str, Floats]
LABELS = {"xx": "\N{GREEK SMALL LETTER SIGMA}$_{xx}$", "yy": "\N{GREEK SMALL LETTER SIGMA}$_{yy}$",
          "xy": "\N{GREEK SMALL LETTER SIGMA}$_{xy}$"}  # fmt: skip
WIDE, HIGH = SIZE = 5.4, 4.6
SPARSE = 12  # samples between two marks
UNSEEN = 0.02  # of |sigma_v|: negative controls that miss by less lie on the line


def stresses(exact: Curve, blocks: Mapping[str, Curve], wave: Curve | None = None) -> Figure:
    """Figure 2, a panel for each block: its mean stress over |sigma_v| against time, marks on lines of the closed form.

    `wave`: vertical stress of the first block with its own vibration, in the ramp.
    """
    with rc_context(style.RC):
        figure = Figure(figsize=(WIDE * len(blocks), HIGH), layout="constrained")
        panels = figure.subplots(1, len(blocks), squeeze=False, sharey=True)[0]
        for axes, (title, block) in zip(panels, blocks.items(), strict=True):
            axes.set(xlabel="time [s]", xlim=(0, 2), ylim=(-1.15, 0.4), title=title)
            axes.axvline(1.0, color=style.GREY, linewidth=0.8)
            for k, name in enumerate(("xx", "yy", "xy")):
                axes.plot(exact["t"], exact[name], linewidth=1.4, color=style.COLOURS[k], label=f"{name}, closed form")
                axes.plot(block["t"][::SPARSE], block[name][::SPARSE], linestyle="none", marker=style.MARKERS[k],
                          label=f"{name}, run",
                          markersize=5, markerfacecolor="white", color=style.COLOURS[k])  # fmt: skip
        if wave:
            panels[0].plot(wave["t"], wave["yy"], color=style.INK, linewidth=0.9)
        panels[0].set_ylabel("mean stress / |σ$_v$|, tension positive")
        handles = [
            Line2D([], [], color=style.COLOURS[k], marker=style.MARKERS[k], markerfacecolor="white", label=LABELS[name])
            for k, name in enumerate(("xx", "yy", "xy"))
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def co_rotated(runs: Mapping[str, Curve]) -> Figure:
    """Shear stress as the turning box sees it: the mean, and the largest of a particle."""
    with rc_context(style.RC):
        figure, axes = style.panel(SIZE, xlabel="time [s]", ylabel="|co-rotated shear stress| / |σ$_v$|", xlim=(1, 2))
        for k, (label, curve) in enumerate(runs.items()):
            late = curve["t"] > 1.0
            axes.plot(curve["t"][late], np.abs(curve["own_xy"][late]), color=style.COLOURS[k],
                      label=f"{label}: mean")  # fmt: skip
            axes.plot(curve["t"][late], curve["shear"][late], color=style.COLOURS[k], linestyle=":",
                      label="largest of a particle")  # fmt: skip
        axes.set_yscale("log")
        axes.set_ylim(1e-5, 0.5)
        figure.legend(loc="outside lower center", ncols=2)
    return figure


def inertia(runs: Mapping[str, Curve]) -> Figure:
    """Mean vertical stress in the frame of the box less its static value, over |sigma_v|."""
    with rc_context(style.RC):
        figure, axes = style.panel(SIZE, xlabel="time [s]", ylabel="co-rotated σ$_{yy}$ / |σ$_v$| + 1", xlim=(1, 2))
        for k, (label, curve) in enumerate(runs.items()):
            late = curve["t"] > 1.0
            axes.plot(curve["t"][late], curve["own_yy"][late] + 1, color=style.COLOURS[k], label=label,
                      linestyle=("-", "--", ":")[k % 3])  # fmt: skip
        figure.legend(loc="outside lower center", ncols=1)
    return figure


def controls(exact: Curve, wrong: Mapping[str, Curve]) -> Figure:
    """Shear stress of Figure 2 by each negative control: lines for what is wrong, marks for what is right."""
    with rc_context(style.RC):
        figure, axes = style.panel(SIZE, xlabel="time [s]", ylabel="σ$_{xy}$ / |σ$_v$|", xlim=(1, 2), ylim=(-0.4, 0.4))
        late = exact["t"] >= 1.0
        axes.plot(exact["t"][late], exact["xy"][late], color=style.LIGHT, linewidth=7, label="exact")
        away = {name: float(np.abs(curve["xy"] - exact["xy"]).max()) for name, curve in wrong.items()}
        unseen = sum(miss < UNSEEN for miss in away.values())
        for k, name in enumerate(name for name in wrong if away[name] >= UNSEEN):
            axes.plot(wrong[name]["t"], wrong[name]["xy"], color=style.COLOURS[k], linewidth=1.4,
                      linestyle=("-", "--", ":", "-.")[k % 4], label=name.replace("_", " "))  # fmt: skip
        if unseen:
            axes.plot(exact["t"][late][::10], exact["xy"][late][::10], "x", color=style.INK, markersize=5,
                      label=f"the {unseen} others")  # fmt: skip
        figure.legend(loc="outside lower center", ncols=2, fontsize=9.5)
    return figure


def orders(errors: Mapping[str, Curve], rates: Sequence[str]) -> Figure:
    """Error against the number of steps, rates in full lines and negative controls in broken ones."""
    with rc_context(style.RC):
        figure, axes = style.panel(
            SIZE, xlabel="steps in a quarter turn", ylabel="error of the stress at the end, relative"
        )
        for k, (name, curve) in enumerate(errors.items()):
            right = name in rates
            axes.plot(curve["steps"], curve["error"], color=style.COLOURS[k % len(style.COLOURS)],
                      marker=style.MARKERS[k % len(style.MARKERS)], markersize=5,
                      linestyle="-" if right else "--", markerfacecolor=None if right else "white",
                      label=name.replace("_", " "))  # fmt: skip
        axes.set(xscale="log", yscale="log")
        ticks = next(iter(errors.values()))["steps"]
        axes.set_xticks(ticks, [f"{n:g}" for n in ticks])
        axes.minorticks_off()
        figure.legend(loc="outside lower center", ncols=3, fontsize=9.5)
    return figure


def shear(exact: Curves, computed: Curves, component: str) -> Figure:
    """Stress component in simple shear over G, by each rate: the closed forms, marks for what was computed."""
    with rc_context(style.RC):
        symbol = {"s12": "σ$_{12}$", "s11": "σ$_{11}$"}[component]
        figure, axes = style.panel(SIZE, xlabel="shear γ", ylabel=f"{symbol} / G", xlim=(0, 8), ylim=(-2, 8))
        for k, (name, curve) in enumerate(exact.items()):
            axes.plot(curve["gamma"], curve[component], color=style.COLOURS[k], label=name.replace("_", " "))
            marks = computed[name]
            axes.plot(marks["gamma"], marks[component], linestyle="none", marker=style.MARKERS[k], markersize=5,
                      markerfacecolor="white", color=style.COLOURS[k])  # fmt: skip
        figure.legend(loc="outside lower center", ncols=4, columnspacing=1.2, handlelength=1.6)
    return figure
