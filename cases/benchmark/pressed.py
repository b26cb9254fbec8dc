"""Slow push of nodes into soil, out and back if need be, and the force that it takes."""

from collections.abc import Callable
from math import cos, pi

import numpy as np

from mpm_verify.cases.benchmark.problem import Measured, Watch
from mpm_verify.solver.model import Model
from mpm_verify.solver.pushed import PushedWalls
from mpm_verify.solver.reaction import Balance, Reaction
from mpm_verify.solver.state import Floats

Measure = Callable[[Floats, Floats], Measured]  # from travel and force of each step (n,)
ROUND_OFF = 1e-11  # of the largest force, of what is missing in a step: a node below the cut-off of mass drops its own
STIFF = 1e4  # least stiffness over strength: strains stay far below what would change the geometry


def smooth(distance: float, duration: float) -> Callable[[float], float]:
    """Travel from rest to rest, 1 - cos: to the distance within the duration, and then back as slowly."""
    return lambda t: 0.5 * distance * (1.0 - cos(pi * max(t, 0.0) / duration))


def slow(model: Model, walls: PushedWalls, outer: Floats) -> tuple[Reaction, Balance]:
    """Push by these walls, and watch their force and the momentum; `outer` (2,) is weight and traction."""
    model.walls = walls
    reaction, balance = Reaction(walls.there), Balance(outer)
    model.watch(reaction, balance)
    return reaction, balance


class Pressed(Watch):
    """Watch of the force on nodes that are pushed, as a function of their travel.

    Parameters
    ----------
    walls
        Walls that push.
    reaction
        Force of their nodes.
    balance
        Balance of momentum.
    measure
        What is made of travel and force, both positive along the push.
    """

    def __init__(self, walls: PushedWalls, reaction: Reaction, balance: Balance, measure: Measure) -> None:
        self.walls, self.reaction, self.balance, self.measure = walls, reaction, balance, measure
        self.travel: list[float] = []
        self.force: list[float] = []

    def after_step(self, model: Model) -> None:
        """Keep travel and force at the start of the step, whose stress the force is of."""
        self.travel.append(self.walls.travel(model.time - model.dt))
        self.force.append(float(self.reaction.force[self.walls.axis]))

    def found(self, model: Model) -> Measured:
        """Numbers and curves of the problem, and what no force explains of the momentum."""
        measured = self.measure(np.array(self.travel), np.array(self.force))
        measured.values["unbalanced"] = self.balance.missing / self.balance.largest
        return measured


def thinned(x: Floats, y: Floats, rows: int = 200) -> Floats:
    """Curve (2,rows) of means over equal numbers of steps."""
    parts = zip(np.array_split(x, rows), np.array_split(y, rows), strict=True)
    return np.array([(a.mean(), b.mean()) for a, b in parts if len(a)]).T
