"""Walls with Coulomb friction: contact that can part, and a tangential impulse of at most mu times the normal one.

With v the velocity that a node would have at the end of the step, w that of the wall, n the normal into the body:

    contact     (w - v) . n > 0; a node that leaves keeps v
    normal      v_n <- w_n, an impulse of m dv_n with dv_n = (w - v) . n
    stick       v_t <- w_t where |v_t - w_t| <= mu dv_n
    slip        v_t <- v_t - mu dv_n sign(v_t - w_t) elsewhere

Contact is decided at the end of the step, where the sign of w - v is that of the reaction: by the velocity before it, a
node that its force tears off would be held, and one that is pressed let go. Friction never turns a velocity round, so
that its impulse on the slip is an energy that is taken, in each step and at each node, and a node that touches one of
two walls does not enter the other. The reaction is always handed on to the particles, whatever `Walls.stops` says:
without it they keep a velocity with which they do not move, and momentum does not add up. Nodes that touch are not
damped, as those of other walls. Damping may turn the velocity of one that leaves into the wall: of those that it has
damped contact is decided again, so that no node ends a step with a velocity into a wall, whatever damps it, and what
damping takes is counted on the velocity that the wall leaves.

A node touches as soon as it has mass, which is while a body is still up to a cell away from the wall.

Update-stress-first strains before it knows the forces, by what touched at the end of the step before, at first nothing.
So a node that strikes a wall with v_n is strained a step late, by v_n dt / dx, which vanishes with dt; one that leaves
moves with the wall until its step begins, and is strained in time. Contact by the sign of the velocity then would hold
a resting body that rings in each half of its period that shortens it, and not in the other: its strains would add up.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mpm_verify.solver._jit import F1, F2, I1, f8, flag, kernel
from mpm_verify.solver.boundary import Apply, Kind, Walls, behind, box
from mpm_verify.solver.state import Floats, Grid, Ints

Masks = flag[:, ::1]
Side = Kind | float  # of a box: a kind of wall, or the friction coefficient of one
Sides = tuple[Side, Side, Side, Side]


@kernel(f8(I1, F2, F2, F1, F2, Masks, F2, F2, Masks, Masks, F2, F2, f8, f8))
def touch(
    nodes, normal, mu, mass, momentum_force, always, wall, wall_rate, held, held_in_strain, value, rate, dt, cutoff
):
    """Write what walls with friction make of the step at `nodes`, and return the energy that friction takes."""
    taken = 0.0
    for i in nodes:
        touching = 0
        for a in range(2):
            held[i, a] = held_in_strain[i, a] = always[i, a]
            value[i, a], rate[i, a] = wall[i, a], wall_rate[i, a]
            free = (momentum_force[i, a] + dt * momentum_force[i, 2 + a]) / mass[i] if mass[i] > cutoff else wall[i, a]
            if not always[i, a] and (wall[i, a] - free) * normal[i, a] > 0.0:
                held[i, a] = held_in_strain[i, a] = True
                rate[i, a] = (wall[i, a] - momentum_force[i, a] / mass[i]) / dt
                touching += 1 + a
        if touching == 1 or touching == 2:
            n, t = touching - 1, 2 - touching
            if not always[i, t]:
                pressed = (momentum_force[i, n] + dt * momentum_force[i, 2 + n]) / mass[i] - wall[i, n]
                sliding = (momentum_force[i, t] + dt * momentum_force[i, 2 + t]) / mass[i] - wall[i, t]
                most = mu[i, n] * abs(pressed)
                left = sliding - np.copysign(most, sliding) if abs(sliding) > most else 0.0
                held[i, t] = True
                held_in_strain[i, t] = left == 0.0
                value[i, t] = wall[i, t] + left
                rate[i, t] = (value[i, t] - momentum_force[i, t] / mass[i]) / dt
                taken += mass[i] * (sliding - left) * left
    return taken


@dataclass
class FrictionalWalls(Walls):
    """Walls some of which have friction; what each step holds is decided anew in it.

    Parameters
    ----------
    still
        Walls without friction beside them, of any kind: they are moved, and handed on what they `stops`. Its `value`
        is the velocity of walls with friction too, and a component that it holds has no friction.
    normal
        Normal of the walls with friction, into the body: 1, -1, or 0 where there is none, (n,2).
    mu
        Friction coefficient of the wall with that normal, (n,2).

    Attributes
    ----------
    held, value, rate
        As of any walls, with the components that friction gives in the step.
    held_in_strain
        Components that have the wall's velocity, (n,2): those that slip have not, and at first none that may leave.
    taken
        Energy per thickness that friction has taken so far: its impulses on the slip. No step makes it less.

    References
    ----------
    Bardenhagen, Brackbill & Sulsky 2000, doi:10.1016/S0045-7825(99)00338-2, for two bodies; the wall is the second one.
    """

    still: Walls
    normal: Floats
    mu: Floats
    nodes: Ints = field(init=False)
    held_in_strain: NDArray[np.bool_] = field(init=False)
    taken: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        self.nodes = np.flatnonzero(self.normal.any(axis=1))
        self.held_in_strain = self.still.held.copy()
        self.stops |= self.still.stops

    def move(self, grid: Grid, t: float, dt: float) -> None:
        """Set the walls without friction for the step from t to t + dt; what touches is what touched before it."""
        touched = self.held_in_strain & ~self.still.held
        self.still.move(grid, t, dt)
        self.held_in_strain = touched | self.still.held
        self.held, self.value, self.rate = self.still.held.copy(), self.still.value.copy(), self.still.rate.copy()

    def touch(self, grid: Grid, dt: float, cutoff: float) -> None:
        """Decide what sticks, slips or leaves in the step, by momentum and force at the nodes."""
        self.decide(self.nodes, grid, dt, cutoff)

    def damp(self, apply: Apply, grid: Grid, dt: float, cutoff: float) -> float:
        """Damp the nodes that do not touch, decide what of them damping brings into a wall, and return its work.

        Damping counts its work on the velocity of a node that is free; the wall changes that, and half of it the mean.
        """
        left = self.nodes[~self.held[self.nodes].all(axis=1)]
        undamped = grid.force[left].copy()
        work = apply(grid, self, dt, cutoff)
        self.decide(left, grid, dt, cutoff)
        new = grid.momentum[left] + dt * grid.force[left]
        pushed = self.held[left] & ~self.still.held[left]
        change = np.where(pushed, self.value[left] - new / np.maximum(grid.mass[left], cutoff)[:, None], 0.0)
        return work + 0.5 * dt * float(((undamped - grid.force[left]) * change).sum())

    def decide(self, nodes: Ints, grid: Grid, dt: float, cutoff: float) -> None:
        """Decide it at some of the nodes."""
        still = self.still
        self.taken += touch(
            nodes, self.normal, self.mu, grid.mass, grid.momentum_force, still.held, still.value, still.rate,
            self.held, self.held_in_strain, self.value, self.rate, dt,
            cutoff,
        )  # fmt: skip

    def closes(self, nodes: Ints, axis: int) -> bool:
        """Whether no body passes these nodes along the axis: walls with friction count where nothing touches too."""
        return bool((self.still.held[nodes, axis] | (self.normal[nodes, axis] != 0)).all())

    def in_strain(self) -> tuple[NDArray[np.bool_], Floats, Floats]:
        """Components that have the wall's velocity, that velocity, and its rate, (n,2)."""
        return self.held_in_strain, self.still.value, self.still.rate


def frictional(grid: Grid, sides: Sides) -> Walls:
    """Walls on the four sides of the domain, some with friction.

    Parameters
    ----------
    grid
        Grid whose sides are meant.
    sides
        Left, right, bottom, top: a kind of wall as in solver.boundary.box, or the friction coefficient of one.

    Returns
    -------
    Walls
        At rest; FrictionalWalls if a side has friction.

    Raises
    ------
    ValueError
        For another kind, or a coefficient below zero.
    """
    normal, mu = np.zeros((len(grid.mass), 2)), np.zeros((len(grid.mass), 2))
    kinds: list[Kind] = []
    for side, given in enumerate(sides):
        if isinstance(given, str):
            kinds.append(given)
            continue
        if not given >= 0:
            raise ValueError(f"friction = {given} of a wall must be zero or more")
        kinds.append("free")
        there, axis = behind(grid, side), side // 2
        normal[there, axis], mu[there, axis] = 1.0 - 2.0 * (side % 2), given
    plain = box(grid, (kinds[0], kinds[1], kinds[2], kinds[3]))
    if not normal.any():
        return plain
    return FrictionalWalls(plain.held.copy(), plain.value.copy(), plain.rate.copy(), plain, normal, mu)
