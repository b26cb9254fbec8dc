"""Figures of an element test: stress path, stress against strain, volume against strain; error against the step."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpm_verify.reports.figures import style
from mpm_verify.solver.state import Floats

Curve = Mapping[str, Floats]
SIZE = (4.3, 3.9)
MINE, EXACT = style.COLOURS[0], style.LIGHT
STRAIN = {"gamma": "shear strain ε₁ − ε₃", "ey": "vertical strain, compression positive", "xy": "shear strain γ"}


def path(curve: Curve, exact: Curve | None, strength: tuple[float, float] | None) -> Figure:
    """Stress path, t against s, and the line t = a + b s of the strength (a, b)."""
    with rc_context(style.RC):
        figure, axes = _panel("mean stress s, compression positive", "radius t")
        if strength:
            s = np.array([0.0, 1.05 * float(np.max(curve["s"]))])
            axes.plot(
                s, strength[0] + strength[1] * s, color=style.GREY, linewidth=1.0, linestyle="--", label="strength"
            )
        _both(axes, curve, exact, "s", "t")
    return figure


def stress(
    curve: Curve,
    exact: Curve | None,
    x: str,
    y: str,
    marks: Sequence[tuple[float, float]] = (),
    limit: float | None = None,
) -> Figure:
    """Stress against a strain; `marks` are of a reference table, `limit` is the stress that it comes to."""
    labels = {"t": "radius t", "tau": "shear stress τ", "sy": "vertical stress, compression positive",
              "q": "deviator stress q = σ_y − σ_x"}  # fmt: skip
    with rc_context(style.RC):
        figure, axes = _panel(_strain(x, y), labels[y])
        if limit is not None:
            axes.axhline(limit, color=style.GREY, linewidth=1.0, linestyle="--", label="at failure (Davis)")
        _both(axes, curve, exact, x, y)
        _marks(axes, marks)
    return figure


def volume(curve: Curve, exact: Curve | None, x: str, shear: bool, marks: Sequence[tuple[float, float]] = ()) -> Figure:
    """Volume strain against a strain, that of a shear test or not."""
    with rc_context(style.RC):
        figure, axes = _panel(_strain(x, "tau" if shear else ""), "volume strain, contraction positive")
        _both(axes, curve, exact, x, "ev")
        _marks(axes, marks)
    return figure


def rates(own: Mapping[str, Curve], exact: Mapping[str, Curve]) -> Figure:
    """Shear stress xy and normal stress xx over G against the shear, a line for each rate over its closed form."""
    with rc_context(style.RC):
        figure = Figure(figsize=(9.2, 4.4), layout="constrained")
        for axes, of, label in zip(
            figure.subplots(1, 2), ("xy", "xx"), (r"$\sigma_{xy}$ / G", r"$\sigma_{xx}$ / G"), strict=True
        ):
            axes.set(xlabel="shear γ", ylabel=label)
            for number, (name, curve) in enumerate(own.items()):
                axes.plot(exact[name]["gamma"], exact[name][of], color=EXACT, linewidth=6.5, zorder=1)
                axes.plot(curve["gamma"], curve[of], color=style.COLOURS[number % 8], linewidth=1.6, zorder=2,
                          label=name.replace("_", " ") if of == "xy" else None)  # fmt: skip
            low = min(float(np.min(curve[of])) for curve in own.values())
            axes.set_ylim(min(low, 0.0) - 0.3, 8.0 if of == "xx" else None)
        figure.legend(loc="outside lower center", ncols=4, fontsize=9.5)
    return figure


def errors(curves: Mapping[str, Curve], names: Mapping[str, str]) -> Figure:
    """Error at the end of each test against its number of steps."""
    with rc_context(style.RC):
        figure = Figure(figsize=(6.4, 5.0), layout="constrained")
        axes = figure.subplots()
        drawn = {name: c for name, c in curves.items() if np.isfinite(c["error"]).any() and (c["error"] > 0).any()}
        for number, (name, curve) in enumerate(drawn.items()):
            axes.plot(curve["steps"], np.maximum(curve["error"], 1e-17), color=style.COLOURS[number % 8],
                      marker=style.MARKERS[number % 8], markersize=5, label=names[name])  # fmt: skip
        axes.set(xscale="log", yscale="log", xlabel="steps", ylabel="error at the end, relative")
        if drawn:
            figure.legend(loc="outside lower center", ncols=2, fontsize=9.5)
    return figure


def _panel(xlabel: str, ylabel: str) -> tuple[Figure, Axes]:
    figure, axes = style.panel(SIZE, xlabel=xlabel, ylabel=ylabel)
    axes.ticklabel_format(style="plain", useOffset=False)
    axes.locator_params(axis="x", nbins=5)
    return figure, axes


def _strain(x: str, y: str) -> str:
    return STRAIN["xy"] if y == "tau" else STRAIN[x]


def _both(axes: Axes, curve: Curve, exact: Curve | None, x: str, y: str) -> None:
    """Draw the computed curve over the exact one, and a legend where there are two."""
    if exact is not None and x in exact and y in exact:
        axes.plot(exact[x], exact[y], color=EXACT, linewidth=6.5, label="exact")
    axes.plot(curve[x], curve[y], color=MINE, linewidth=1.4, label="computed")
    low, high = axes.get_ylim()
    if high - low < 1e-9 * max(abs(high), abs(low), 1e-300) or high - low < 1e-12:
        axes.set_ylim(low - 1, high + 1)
    axes.legend(loc="best", fontsize=9.5)


def _marks(axes: Axes, marks: Sequence[tuple[float, float]]) -> None:
    """Draw the points of a reference table."""
    if marks:
        axes.plot(*np.array(marks).T, linestyle="none", marker="o", markersize=6, markerfacecolor="white",
                  color=style.COLOURS[1], label="table")  # fmt: skip
        axes.legend(loc="best", fontsize=9.5)
