"""Walls: velocity components that are given at nodes, and the grid's equation of motion."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np
from numba import prange
from numpy.typing import NDArray

from mpm_verify.solver._jit import F1, F2, f8, flag, i8, kernel, nothing
from mpm_verify.solver.state import Floats, Grid, Ints

Kind = Literal["roller", "fixed", "free"]
MASS_CUTOFF = 1e-12  # fraction of a particle's mass: below it a node's velocity is 0/0


@dataclass
class Walls:
    """Velocity components that are given at nodes.

    A node that is held has the wall's velocity before the step too. So its acceleration is the wall's own, and not what
    would bring the particles' velocity to the wall's: that reaction, handed on to the particles by FLIP, costs v half
    an order near the wall.

    Parameters
    ----------
    held
        Whether a component is given, (n,2).
    value
        Velocity at the end of the step, (n,2); read where `held`.
    rate
        Acceleration of the wall, (n,2).
    stops
        Hand the reaction on to the particles: bodies that strike a wall are stopped by nothing else, and FLIP would
        let them keep a velocity with which they do not move.
    filtered
        Velocity that walls take from what a transfer filters, (n,2), in the last step; empty where it filters nothing.
    """

    held: NDArray[np.bool_]
    value: Floats
    rate: Floats
    stops: bool = field(default=False, kw_only=True)
    filtered: Floats = field(default_factory=lambda: np.zeros((0, 2)), kw_only=True)

    def move(self, grid: Grid, t: float, dt: float) -> None:
        """Set the walls for the step from t to t + dt; these stand still."""

    def touch(self, grid: Grid, dt: float, cutoff: float) -> None:
        """Set what depends on momentum and force at the nodes, see solver/friction.py; of these nothing does."""

    def damp(self, apply: "Apply", grid: Grid, dt: float, cutoff: float) -> float:
        """Damp by `apply` what is not held, and return the work that this takes in the step; see Damping.apply."""
        return apply(grid, self, dt, cutoff)

    def closes(self, nodes: Ints, axis: int) -> bool:
        """Whether no body passes these nodes along the axis."""
        return bool(self.held[nodes, axis].all())

    def in_strain(self) -> tuple[NDArray[np.bool_], Floats, Floats]:
        """Components held of velocities that strain the particles and do not move them: `held`, `value` and `rate`."""
        return self.held, self.value, self.rate


Apply = Callable[[Grid, Walls, float, float], float]  # of damping
Rule = Callable[[Floats, float, float], tuple[NDArray[np.bool_], Floats, Floats]]


@dataclass
class MovingWalls(Walls):
    """Walls that `rule(nodes, t, dt)` gives anew for each step, as (held, value, rate)."""

    rule: Rule

    def move(self, grid: Grid, t: float, dt: float) -> None:
        """Set the walls for the step from t to t + dt."""
        self.held, self.value, self.rate = self.rule(grid.nodes, t, dt)


def moving(grid: Grid, rule: Rule) -> MovingWalls:
    """Walls that a rule gives anew for each step, see MovingWalls."""
    return MovingWalls(*rule(grid.nodes, 0.0, 0.0), rule)


def box(grid: Grid, kind: Kind | tuple[Kind, Kind, Kind, Kind]) -> Walls:
    """Walls on the four sides of the domain: on them and behind them, where corners of particle domains may reach.

    Parameters
    ----------
    grid
        Grid whose sides are meant.
    kind
        ``roller`` holds the normal component, ``fixed`` both, and ``free`` none: one word for all sides, or one for
        each of left, right, bottom, top.

    Returns
    -------
    Walls
        At rest.

    Raises
    ------
    ValueError
        For another kind.
    """
    kinds = (kind,) * 4 if isinstance(kind, str) else kind
    for name in kinds:
        if name not in get_args(Kind):
            raise ValueError(f"no wall {name!r}; choose from {', '.join(get_args(Kind))}")
    held = np.zeros((len(grid.mass), 2), dtype=bool)
    for side, name in enumerate(kinds):
        axis, there = side // 2, behind(grid, side)
        held[there, axis] |= name != "free"
        held[there, 1 - axis] |= name == "fixed"
    return Walls(held, np.zeros(held.shape), np.zeros(held.shape))


def behind(grid: Grid, side: int) -> NDArray[np.bool_]:
    """Nodes (n,) on a side of the domain and behind it; sides are left, right, bottom, top."""
    axis, slack = side // 2, 1e-9 * grid.dx
    x = grid.origin[axis] + grid.dx * np.arange((grid.nx, grid.ny)[axis])
    on = (x >= grid.upper[axis] - slack) if side % 2 else (x <= grid.lower[axis] + slack)
    found: NDArray[np.bool_] = np.tile(on, grid.nx) if axis else np.repeat(on, grid.ny)
    return found


@kernel(nothing(F1, F2, F2, flag[:, ::1], F2, F2, flag, f8, f8, i8), parallel=True)
def solve(mass, momentum_force, velocity_acceleration, held, value, rate, stops, dt, cutoff, ny):
    """Velocity at the end of the step and acceleration at every node; m a = f, or what the wall makes of it."""
    for column in prange(mass.shape[0] // ny):
        for i in range(column * ny, (column + 1) * ny):
            inverse = 1.0 / mass[i] if mass[i] > cutoff else 0.0
            for a in range(2):
                before = inverse * momentum_force[i, a]
                acceleration = inverse * momentum_force[i, 2 + a]
                velocity = before + dt * acceleration
                if held[i, a]:
                    velocity = value[i, a]
                    acceleration = (velocity - before) / dt if stops else rate[i, a]
                velocity_acceleration[i, a] = velocity
                velocity_acceleration[i, 2 + a] = acceleration
