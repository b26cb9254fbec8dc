"""Hints on an answer of somebody else's solver in words: what it would have to be read as."""

from collections.abc import Iterable
from typing import Any

from mpm_verify.reports.sentences.numbers import percent

HINTS = {  # in the order in which they are said
    "id_and_X": "id and X, Y name different particles for {percent} of the rows; they fit by X, Y, and id was taken.",
    "permuted": "Particles fit when they are matched by position: {percent} of the rows have the id of another one.",
    "still": "Errors equal u: nothing moves; is the force added to the motion, and are new positions written?",
    "unmoved": "No position changes in the digits that are written; the last of them is {value:.2g} times the exact "
    "displacement. Nothing moves, or it moves and that cannot be seen: write 17 digits.",
    "x_is_u": "x fits when X is added to it: write positions, not displacements.",
    "wall_in": "In the cells next to the walls particles move {value:.2f} of what they should: "
    "are nodes held that lie one node inside the body?",
    "force_factor": "The body moves as if the body force were {value:.3g} times what it is: {force}",
    "stress_factor": "The body moves as if its stress were {value:.3g} times that of the material: "
    "look at constants, units and volumes.",
    "stress_of_F": "The body moves as if its stress were {value:.3g} times as large, and so does the stress of the F "
    "that is written: is F advanced twice in a step?",
    "shift": "Positions fit the exact ones best {steps}: is each file that of the step in its name?",
    "time_scale": "Positions fit at {value:.5g} times their time: is dt rounded, or the number of steps another?",
    "force_at_x": "The motion fits a body force that is taken at the position x: it is a function of X.",
    "force_swapped": "The motion fits a body force whose components are exchanged: x comes first.",
    "force_at_YX": "The motion fits a body force that is taken at (Y, X): its first coordinate is X.",
    "force_lag": "The motion fits a body force of {lag}: is it that of the start of the step?",
    "stress_lag": "The motion fits a stress of {lag}: from which level of F is it?",
    "viscous": "Velocities are smoothed in each step, as by a viscosity of {value:.2g} dx²/dt: so does PIC, and a FLIP "
    "ratio that is not used; the error grows when dt falls, and no time step mends it.",
    "damped": "The body loses {percent} of its momentum in a step: is a damping left on?",
    "start": "The body starts with the velocity that it should have {early}: "
    "is v at −dt/2 given where v at 0 is needed, or the other way round?",
    "F_transposed": "F fits its own displacements when it is transposed: rows are the components of the position; "
    "so is an F that is advanced by L transposed.",
    "L_transposed": "F fits its own displacements when it is advanced by L transposed: L_ij = dv_i/dx_j.",
    "F_twice": "F fits its own displacements when each of their steps is taken twice: is F advanced twice in a step?",
    "F_symmetric": "F fits its own displacements when it is advanced by the symmetric part of L alone: "
    "the rotation is missing.",
    "volume": "V changes {value:.3g} times as much as det F does.",
    "plane_stress": "sigma fits that of F in plane stress; the case is in plane strain.",
    "sigma_mean": "sigma fits that of F when its mean in the plane is {value:.3g} times as large: is lam right?",
    "sigma_sign": "sigma fits that of F with the other sign: tension is positive.",
    "sigma_factor": "sigma is {value:.4g} times that of F: look at units and constants.",
    "sigma_lag": "sigma fits that of the F of {lag}: write both at the same time.",
    "v_at_walls": "Next to the walls v is wrong, and its error in the interior is {value:.2f} of that everywhere: "
    "do increments of the velocity keep what the wall took?",
    "v_lag": 'v fits best {value:g} steps behind x: write "v_lag": {value:g} in result.json, or look at its start.',
    "F_lag": 'F fits best {value:g} steps behind x: write "F_lag": {value:g} in result.json, or look at its start.',
    "single": "x and v are single precision, though they may have 17 digits: their rounding is {value:.2g} times the "
    "error of u; take a larger amplitude, or write them in double precision.",
}
TIMES = ("shift", "force_lag", "stress_lag", "start", "v_lag", "F_lag")  # which other time levels may mend
LOSSES = ("viscous", "damped")  # which no time step mends
ZERO, MINUS = 0.2, 0.5  # factors on a force that is missing, and of the other sign, on a coarse grid


def hint(name: str, value: float) -> str:
    """Sentence of a hint."""
    steps = f"{abs(value):g} step{'s' * (abs(value) != 1)} {'earlier' if value > 0 else 'later'}"
    lag = f"{abs(value):.2g} step{'s' * (f'{abs(value):.2g}' != '1')} {'before' if value > 0 else 'after'}"
    force = "look at units, and whether it is per mass."
    if abs(value) < ZERO or value < -MINUS:
        force = "is it added?" if value > -ZERO else "it has the other sign."
    early = f"{abs(value):.1f} steps {'before' if value > 0 else 'after'} its time"
    told = {"steps": steps, "lag": lag, "force": force, "early": early, "percent": percent(value)}
    return HINTS[name].format(value=value, **told)


def hints(results: Iterable[Any]) -> list[str]:
    """Sentences on the finest finished run of each solver, with the longest time step; none for the reference.

    None either of several starts: most of them are wrong by intent, and what they are to tell is told by `starts`.
    """
    finest: dict[tuple[str, str], Any] = {}
    known = list(results)
    if len({getattr(result.run, "start", "") for result in known}) > 1:
        return []
    for result in sorted(known, key=fineness):
        if getattr(result.run, "solver", "") and result.status == "finished":
            finest[result.run.method, getattr(result.run, "solution", "")] = result
    return [hint(name, value) for result in finest.values() for name, value in said(result)]


def fineness(result: Any) -> tuple[float, float]:
    """Key that sorts runs by their cells, and then by their time step: what is wrong in time shows in the longest."""
    return getattr(result.run, "cells", 0), getattr(result.run, "courant", 0.0)


def causes(results: Iterable[Any]) -> set[str]:
    """Names of the hints on the finest finished run."""
    done = [result for result in results if result and result.status == "finished"]
    finest = max(done, key=fineness, default=None)
    return {name for name, _ in said(finest)} if finest else set()


def said(result: Any) -> list[tuple[str, float]]:
    """Hints of a run with their numbers, in the order in which they are said."""
    return [(name, result.values[name]) for name in HINTS if name in result.values]


LEVELS = {
    "half": "v at −dt/2", "zero": "v at 0", "now": "F and sigma at 0", "before": "F and sigma at −dt",
    "start": "b at the start of the step", "end": "b at its end",
}  # fmt: skip


def start(name: str) -> str:
    """Time levels of a start in words."""
    return ", ".join(LEVELS[part] for part in name.split("."))


def walls(orders: dict[bool, float], low: float = 1.8) -> str:
    """Sentence on the last local orders of u with walls (True) and without; empty where walls are not why."""
    if orders.keys() != {True, False} or orders[True] >= low or orders[False] < low:
        return ""
    return f"Order {orders[True]:.2f} with walls, {orders[False]:.2f} without: look at the walls."


def starts(orders: dict[str, float], low: float = 1.8, high: float = 2.3) -> str:
    """Sentence on the orders of u by start, the time levels that were given by force; empty where there are not two."""
    if len(orders) < 2:
        return ""
    fit = {name: order for name, order in orders.items() if low <= order <= high}
    rest = [order for name, order in orders.items() if name not in fit]
    others = f"; with the others {min(rest):.2f} to {max(rest):.2f}" if rest else ""
    if not fit:
        return f"No time levels give order 2: the orders are {min(rest):.2f} to {max(rest):.2f}."
    best = "; ".join(f"{order:.2f} with {start(name)}" for name, order in fit.items())
    return f"Order {best}{others}."
