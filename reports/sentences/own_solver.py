"""Hints on an answer of somebody else's solver in words: what it would have to be read as."""

from collections.abc import Iterable
from typing import Any

HINTS = {
    "still": "The displacement is {value:.1g} of the exact one: nothing moves; is the force added to the motion?",
    "shift": "Positions fit the exact ones best {steps}: is each file that of the step in its name?",
    "x_is_u": "x fits when X is added to it: write positions, not displacements.",
    "v_lag": 'v fits best {value:g} steps behind x: write "v_lag": {value:g} in result.json, or look at its start.',
    "F_lag": 'F fits best {value:g} steps behind x: write "F_lag": {value:g} in result.json, or look at its start.',
    "F_transposed": "F fits when it is transposed: rows are the components of the position.",
    "F_twice": "F − I fits when it is halved: is F advanced twice in a step?",
    "sigma_sign": "sigma fits with the other sign: tension is positive.",
}


def hint(name: str, value: float) -> str:
    """Sentence of a hint."""
    steps = f"{abs(value):g} step{'s' * (abs(value) != 1)} {'earlier' if value > 0 else 'later'}"
    return HINTS[name].format(value=value, steps=steps)


def hints(results: Iterable[Any]) -> list[str]:
    """Sentences on the finest finished runs of each solver; none for the reference solver."""
    finest: dict[tuple[str, str], Any] = {}
    for result in sorted(results, key=lambda result: result.run.cells if hasattr(result.run, "cells") else 0):
        if getattr(result.run, "solver", "") and result.status == "finished":
            finest[result.run.method, result.run.solution] = result
    return [hint(name, value) for result in finest.values() for name, value in result.values.items() if name in HINTS]


LEVELS = {
    "half": "v at −dt/2", "zero": "v at 0", "now": "F and sigma at 0", "before": "F and sigma at −dt",
    "start": "b at the start of the step", "end": "b at its end",
}  # fmt: skip


def start(name: str) -> str:
    """Time levels of a start in words."""
    return ", ".join(LEVELS[part] for part in name.split("."))


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
