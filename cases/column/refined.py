"""Solution verification of the column: refinement of mesh, time step and particles, and scatter over their places."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpm_verify.cases.column.claims import FinishedRun, families, shared, told
from mpm_verify.cases.judging.richardson import Extrapolation, extrapolate

REFINES = {"cells": lambda run: 1 / run.cells, "courant": lambda run: run.courant, "ppc": lambda run: run.ppc**-0.5}
QUANTITIES = {"front_99": "front, 99 %", "front_999": "front, 99.9 %", "toe": "toe", "height": "height at the wall"}


@dataclass(frozen=True)
class Refined:
    """A refinement in one axis: levels finest first, and what three levels say at each place along it."""

    axis: str
    runs: str
    quantity: str
    levels: tuple[tuple[str, float], ...]
    found: tuple[Extrapolation, ...]  # of the finest three first


@dataclass(frozen=True)
class Scattered:
    """A quantity over runs that differ in where their particles lie in their cells at first."""

    runs: str
    quantity: str
    count: int
    mean: float
    deviation: float
    reach: float


def refinements(ran: Sequence[FinishedRun], axes: Sequence[str]) -> list[Refined]:
    """Wherever a study has three levels or more."""
    found = []
    for axis in axes:
        for family in families(ran, axis) if axis in REFINES else ():
            levels = sorted(family, key=lambda one: REFINES[axis](one.run))
            words = shared(levels[0].run, [other for other in axes if other != axis])
            for key, name in QUANTITIES.items() if len(levels) > 2 else ():
                h, f = [REFINES[axis](one.run) for one in levels], [one.values[key] for one in levels]
                triples = tuple(extrapolate(h[k : k + 3], f[k : k + 3]) for k in range(len(h) - 2))
                shown = tuple((told(axis, getattr(one.run, axis)), v) for one, v in zip(levels, f, strict=True))
                found.append(Refined(axis, words, name, shown, triples))
    return found


def scatter(ran: Sequence[FinishedRun], axes: Sequence[str]) -> list[Scattered]:
    """Wherever a study has three places or more."""
    found = []
    for family in families(ran, "offset") if "offset" in axes else ():
        words = shared(family[0].run, [axis for axis in axes if axis != "offset"])
        for key, name in QUANTITIES.items() if len(family) > 2 else ():
            values = np.array([one.values[key] for one in family])
            spread = float(values.std(ddof=1)), float(np.ptp(values))
            found.append(Scattered(words, name, len(values), float(values.mean()), *spread))
    return found
