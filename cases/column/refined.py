"""Solution verification of the column: refinement of mesh, time step and particles, scatter over their positions."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm_verify.cases.column.claims import families, values
from mpm_verify.cases.column.records import MEASURES, FinishedRun
from mpm_verify.cases.judging.richardson import Extrapolation, extrapolate

REFINES = {"cells": lambda run: 1 / run.cells, "courant": lambda run: run.courant, "ppc": lambda run: run.ppc**-0.5}
QUANTITIES = tuple(name for names in MEASURES.values() for name in names)


@dataclass(frozen=True)
class Refined:
    """A refinement in one axis: levels finest first, and what three levels say at each position along it.

    `shared`: what the runs have on the other axes; `levels`: value on the axis and number of each.
    """

    axis: str
    shared: dict[str, Any]
    quantity: str
    levels: tuple[tuple[float, float], ...]
    found: tuple[Extrapolation, ...]  # of the finest three first


@dataclass(frozen=True)
class Scattered:
    """A quantity over runs that differ in where their particles lie in their cells at first."""

    shared: dict[str, Any]
    quantity: str
    count: int
    mean: float
    deviation: float
    reach: float


def refinements(ran: Sequence[FinishedRun], axes: Sequence[str]) -> list[Refined]:
    """Refinements in each axis on which a study has three levels or more."""
    found = []
    for axis in axes:
        for family in families(ran, axis) if axis in REFINES else ():
            levels = sorted(family, key=lambda one: REFINES[axis](one.run))
            shared = values(levels[0].run, [other for other in axes if other != axis])
            for name in known(levels) if len(levels) > 2 else ():
                h, f = [REFINES[axis](one.run) for one in levels], [one.values[name] for one in levels]
                triples = tuple(extrapolate(h[k : k + 3], f[k : k + 3]) for k in range(len(h) - 2))
                shown = tuple((getattr(one.run, axis), v) for one, v in zip(levels, f, strict=True))
                found.append(Refined(axis, shared, name, shown, triples))
    return found


def scatter(ran: Sequence[FinishedRun], axes: Sequence[str]) -> list[Scattered]:
    """Scatter over positions of the particles, where a study has three or more."""
    found = []
    for family in families(ran, "offset") if "offset" in axes else ():
        shared = values(family[0].run, [axis for axis in axes if axis != "offset"])
        for name in known(family) if len(family) > 2 else ():
            sample = np.array([one.values[name] for one in family])
            spread = float(sample.std(ddof=1)), float(np.ptp(sample))
            found.append(Scattered(shared, name, len(sample), float(sample.mean()), *spread))
    return found


def known(family: Sequence[FinishedRun]) -> list[str]:
    """Quantities that all runs have: those stored before a measure was made are without it."""
    return [name for name in QUANTITIES if all(name in one.values for one in family)]
