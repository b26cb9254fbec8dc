"""Slow push of nodes into soil, out and back if need be, and the force that it takes."""

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, pi
from typing import ClassVar

import numpy as np

from mpm_verify.cases.benchmark.problem import Held, Measured, Watch
from mpm_verify.cases.benchmark.run import Run
from mpm_verify.solver.model import Model
from mpm_verify.solver.plugins import METHODS, create
from mpm_verify.solver.pushed import PushedWalls
from mpm_verify.solver.reaction import Balance, Reaction
from mpm_verify.solver.state import Floats

Measure = Callable[[Floats, Floats, Floats], Measured]  # from travel, force and momentum of each step (n,)
ROUND_OFF = 1e-11  # of the largest force, of what is missing in a step: a node below the cut-off of mass drops its own
STIFF = 1e4  # least stiffness over strength: strains stay far below what would change the geometry


@dataclass(frozen=True)
class Smooth:
    """Travel from rest to rest, 1 - cos: to the distance within the duration, and then back as slowly."""

    formula: ClassVar[str] = "distance/2*(1-cos(pi*t/duration))"

    distance: float
    duration: float

    def __call__(self, t: float) -> float:
        """Distance that is gone at the time t."""
        return 0.5 * self.distance * (1.0 - cos(pi * max(t, 0.0) / self.duration))


def slow(model: Model, walls: PushedWalls, outer: Floats) -> tuple[Reaction, Balance]:
    """Push by these walls, and watch their force and the momentum; `outer` (2,) is weight and traction."""
    model.walls = walls
    reaction, whole = Reaction(walls.there), Balance(outer)
    model.watch(reaction, whole)
    return reaction, whole


class Pressed(Watch):
    """Watch of the force on nodes that are pushed, as a function of their travel.

    Parameters
    ----------
    walls
        Walls that push.
    reaction
        Force of their nodes.
    whole
        Balance of momentum.
    measure
        What is made of travel, force and momentum, on the axis of the push.
    """

    def __init__(self, walls: PushedWalls, reaction: Reaction, whole: Balance, measure: Measure) -> None:
        self.walls, self.reaction, self.whole, self.measure = walls, reaction, whole, measure
        self.travel: list[float] = []
        self.force: list[float] = []
        self.momentum: list[float] = []

    def after_step(self, model: Model) -> None:
        """Keep travel and force at the start of the step, whose stress the force is of, and the momentum before it."""
        self.travel.append(self.walls.travel(model.time - model.dt))
        self.force.append(float(self.reaction.force[self.walls.axis]))
        self.momentum.append(float(self.whole.momentum[self.walls.axis]))

    def found(self, model: Model) -> Measured:
        """Numbers and curves of the problem, and what no force explains of the momentum."""
        measured = self.measure(*map(np.array, (self.travel, self.force, self.momentum)))
        measured.values["unbalanced"] = self.whole.missing / self.whole.largest
        return measured


def balance(run: Run, traction: bool = False) -> tuple[Held, ...]:
    """Balance of momentum to round-off, for methods that hand all forces to nodes that have mass.

    A surface that rises by a millionth of a cell reaches nodes above it: domains of fixed size give them a mass below
    the cut-off, and points of an edge a part of their traction and no mass. Domains with corners give both.
    """
    basis = create(METHODS, run.method)
    if not basis.faces_carry and (traction or basis.domain_size):
        return ()
    return (Held("unbalanced", ROUND_OFF, "at_most", "momentum of the whole body in each step", of="each"),)


def thinned(x: Floats, y: Floats, rows: int = 200) -> Floats:
    """Curve (2,rows) of means over equal numbers of steps."""
    parts = zip(np.array_split(x, rows), np.array_split(y, rows), strict=True)
    return np.array([(a.mean(), b.mean()) for a, b in parts if len(a)]).T
