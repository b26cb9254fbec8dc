"""Parts of the column's page: solution verification, pictures and films, what keeps the column alive."""

from collections.abc import Sequence
from typing import Any

from mpm_verify.cases.column.exam import ColumnAnalysis
from mpm_verify.cases.column.run import ColumnResult, ColumnRun
from mpm_verify.cases.harness.store import Store
from mpm_verify.reports.components.examined import Section
from mpm_verify.reports.components.film import EACH, MOST, film
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.figures import column as draw
from mpm_verify.reports.sentences import column as words
from mpm_verify.reports.words import DASH, percent

FILMS = 8  # of a page
AXES = {"cells": "cells of the width", "ppc": "particles per cell", "courant": "Courant number"}
SET_UP = (
    "The paper's Figure 3: the column at its wall (thick), before it is released; right, its free foot with the cells "
    "of the grid, the domains of the particles in layers, and their centres."
)


def refinement(analysis: ColumnAnalysis, add: Add) -> Section:
    """Section with Richardson extrapolation where levels are refined, scatter where particles are shifted."""
    figures, rows = [], []
    heads = ("axis", *(("runs with",) if any(one.shared for one in analysis.refined) else ()))
    named = [(one.axis, words.listed(one.shared), one) for one in analysis.refined]
    for number, (axis, runs) in enumerate(dict.fromkeys((axis, runs) for axis, runs, _ in named)):
        series = [one for *of, one in named if tuple(of) == (axis, runs)]
        drawn = draw.refined(series, f"{AXES[axis]}, finer to the right")
        image = add(f"refined_{number}", drawn, f"Refinement in {axis}.")
        figures.append(
            (image, f"Refinement in {axis}{f', {runs}' if runs else ''}: each quantity over its finest value.")
        )
        for one in series:
            spread = ", ".join(f"{value:.4f}" for _, value in reversed(one.levels))
            name = words.quantity(one.quantity)
            rows.append((axis, *((runs,) if len(heads) > 1 else ()), name, spread, *extrapolated(one.found[0])))
    tables = []
    if rows:
        head = (*heads, "quantity", "coarse to fine [m]", "finest three", "order", "limit", "uncertainty [m]")
        tables.append(Table("Richardson extrapolation and grid convergence index", head, tuple(rows), texts=head[:5]))
    if analysis.scattered:
        head = ("quantity", "runs with", "runs", "mean [m]", "standard deviation [mm]", "range [mm]", "of the mean")
        tables.append(Table("Scatter over the initial positions of the particles in their cells", head, tuple(
            (words.quantity(one.quantity), words.listed(one.shared) or DASH, str(one.count), f"{one.mean:.4f}",
             f"{1e3 * one.deviation:.1f}", f"{1e3 * one.reach:.1f}", percent(one.deviation / one.mean))
            for one in analysis.scattered), texts=("runs with",)))  # fmt: skip
    text = (
        "There is no exact solution. Where three levels approach a limit from one side, the order is observed, the "
        "limit is extrapolated, with an order of 2 at most, and the uncertainty is the grid convergence index, 1.25 "
        "times the distance from it. Where values go to and fro, or settle at no order of a half or more, nothing "
        "converges on these levels, and the uncertainty is half the range of the three values: no bound. No difference "
        "means more than the scatter over the positions of particles (study offsets)."
    )
    return Section("refinement", "Solution verification", [text], figures, tables)


def extrapolated(found: Any) -> tuple[str, ...]:
    """Extrapolation of the finest three levels, as text."""
    limits = (f"{found.order:.2f}", f"{found.limit:.4f}") if found.kind == "converges" else (DASH, DASH)
    return (found.kind, *limits, f"{found.uncertainty:.4f}")


def set_up(store: Store, add: Add, run: ColumnRun, result: ColumnResult) -> Section:
    """Section of the set-up, the paper's Figure 3."""
    arrays = store.arrays(result.digest)
    x, corners = draw.away(run, arrays["snapshot_x"][0]), arrays.get("snapshot_corners")
    figure = draw.set_up(run, x, None if corners is None else draw.away(run, corners[0]))
    return Section(
        "setup", "The set-up", figures=[(add("set_up", figure, "The column before it is released."), SET_UP)]
    )


def films(analysis: ColumnAnalysis, store: Store, add: Add, ran: Sequence[tuple[ColumnRun, ColumnResult]]) -> Section:
    """Section of pictures: snapshots of the last run, and animations of the first few."""
    run, result = ran[-1]
    image = add("snapshots", draw.snapshots(run, store.arrays(result.digest)), "Layers of sand at a few times.")
    label = words.label(analysis.study, run)
    caption = f"{label}: the domains of the particles, in layers by the height at which they began."
    shown = ran[:FILMS]
    most, wide = min(EACH, MOST // len(shown)), 1.02 * max(one.values.get("front_999", run.width) for _, one in shown)
    reels = [film(run, store.arrays(one.digest), words.label(analysis.study, run), wide, most) for run, one in shown]
    return Section("pictures", "The collapse", figures=[(image, caption)], films=reels, wide=True)


def books(analysis: ColumnAnalysis) -> Section:
    """Section on the volume of the heap at the end: what it is made of, and the space that it takes."""
    head = ("run", "plastic dilation", "void strain", "det F", "unaccounted for", "drifted", "crowding",
            "det F / crowding", "area below 99 %", "height falls")  # fmt: skip
    rows = []
    for one in analysis.ran:
        v = one.values
        unbooked = f"{abs(v['unbooked']):.1e}" if one.run.pooling else ""
        drifted = f"{v.get('drifted', 0.0):.3f}" if one.run.pooling else ""
        parts = (f"{v['dilated']:.4f}", f"{v['void_strain']:.4f}", f"{v['volume']:.4f}", unbooked, drifted)
        space = (f"{v['crowding']:.3f}", f"{v['volume'] / v['crowding']:.3f}", f"{v['area']:.3f}")
        rows.append((words.label(analysis.study, one.run), *parts, *space, percent(v["creep"])))
    return Section("volume", "Volume of the heap", [words.BOOKS], tables=[Table("Means at the end", head, tuple(rows))])


def alive(analysis: ColumnAnalysis) -> Section:
    """Section on what limits, void strain and smoothing do to the runs, failed ones too."""
    head = ("run", "limit [cells]", "limited domains", "with void strain", "without stress", "void strain", "det F",
            "crowding", "outside the cone", "worst t/(s sin φ)", "largest s / ρgh₀", "fastest particle [m/s]",
            "Courant number", "steps", "CPU [s]", "million updates a second")  # fmt: skip
    rows = []
    for run in analysis.study.runs:
        result = analysis.results.get(run.digest)
        if result and result.values:
            v = result.values
            weight = float(result.parameters["rho0"]) * run.g * run.height
            rows.append((
                words.label(analysis.study, run), f"{float(result.parameters['domain limit']):.3g}",
                percent(v["most_cut"]), percent(v["void"]), percent(v["idle"]), f"{v['void_strain']:.3g}",
                f"{v['least_J']:.3g} to {v['most_largest_J']:.3g}", f"{v['crowding']:.2f}", percent(v["most_outside"]),
                f"{1 + v['most_beyond']:.3g}", f"{v['most_largest_s'] / weight:.1f}", f"{v['most_fastest']:.2f}",
                f"{v['most_courant']:.2f}", str(result.steps), f"{result.cpu_s:.1f}",
                f"{result.updates / max(result.cpu_s, 1e-9) / 1e6:.1f}"))  # fmt: skip
    text = (
        "A cohesionless column of CPDI particles lives by three things, which can be switched off: domains of limited "
        "length, a memory of void strain, and an update of F that keeps its determinant. The table says how many "
        "particles they touch: the largest fraction whose domain is cut, at the end the fraction with void strain and "
        "that without any stress, the volume of void per solid, and the extremes of det F.",
        "A particle with void strain waits for as much compression before it carries again. Most particles of a heap "
        "at rest do so, deep inside too: the others carry the weight and hold them apart, and the heap is larger by "
        "it.",
        "Crowding is the volume that particles keep, det F times what they began with, over the space in which they "
        "are: it should be 1. Above it the heap is too small for its material, which the particles do not notice. It "
        "grows as particles are fewer.",
        "Smoothing p or the deviator alone takes stresses out of the cone of friction: the largest fraction of "
        "particles that the forces see outside it, in the plane, and the worst ratio among those under more than 1 % "
        "of the largest s. The largest s is that of sand striking the floor.",
    )
    return Section("alive", "What keeps it alive, and what leaves the cone", text, tables=[
        Table("Largest values over each run", head, tuple(rows), texts=("det F",))])  # fmt: skip
