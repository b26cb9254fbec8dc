"""Velocity of part of an edge, or of any nodes: a plate that is pushed into a body, a wall that yields."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mpm_verify.solver.boundary import Walls
from mpm_verify.solver.state import Grid


@dataclass
class PushedWalls(Walls):
    """Walls of which some nodes are pushed along an axis.

    The velocity at the end of a step from t to t + dt is the distance from one to the other over dt, and belongs to the
    middle, as in a staggered run; the acceleration is its change since the last step. So particles that take the
    acceleration of the wall keep its velocity to round-off. The nodes stay where they are: what moves by much less than
    a cell is meant.

    Parameters
    ----------
    there
        Which nodes are pushed, (n,).
    axis
        Component of the velocity that is given there: 0 or 1.
    travel
        ``travel(t)``: distance along the axis that they have gone at the time t.
    """

    there: NDArray[np.bool_]
    axis: int
    travel: Callable[[float], float]

    def move(self, grid: Grid, t: float, dt: float) -> None:
        """Set the velocity and the acceleration of the step from t to t + dt."""
        before, now, after = (self.travel(t + part * dt) for part in (-1, 0, 1))
        self.value[self.there, self.axis] = (after - now) / dt
        self.rate[self.there, self.axis] = ((after - now) - (now - before)) / dt**2


def pushed(
    walls: Walls, there: NDArray[np.bool_], axis: int, travel: Callable[[float], float], rough: bool = False
) -> PushedWalls:
    """Walls that stand still but for some of their nodes, or of others.

    Parameters
    ----------
    walls
        Walls, which keep what they hold.
    there, axis, travel
        See PushedWalls.
    rough
        Whether these nodes are held on the other axis too.

    Raises
    ------
    ValueError
        For an axis that is neither 0 nor 1, or where no node is pushed.
    """
    if axis not in (0, 1):
        raise ValueError(f"axis = {axis} must be 0 or 1")
    if not there.any():
        raise ValueError("no node is pushed; choose a part of the edge that is a cell wide at least")
    held = walls.held.copy()
    held[there, axis] = True
    held[there, 1 - axis] |= rough
    return PushedWalls(held, walls.value.copy(), walls.rate.copy(), there, axis, travel, stops=walls.stops)
