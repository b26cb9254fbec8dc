"""Local non-viscous damping: a fraction alpha of the unbalanced force of each node, against its velocity.

    local       f_a -= alpha |f_a| sign(v_a) for each component a: the usual one (Cundall 1987), and the paper's
    objective   f -= alpha |f| v/|v|: the same in any axes, which the usual one is not

v is the velocity before the step, and a node at rest is not damped. Free fall has the acceleration (1 - alpha) g, a
rise (1 + alpha) g; an oscillator loses the fraction 2 alpha/(1 + alpha) of its amplitude in a cycle, whatever its
frequency: 5 % of force are 1.6 % of critical damping. It damps rigid motion too.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from mpm_verify.solver._jit import F1, F2, f8, flag, i8, kernel
from mpm_verify.solver.boundary import Walls
from mpm_verify.solver.state import Grid

Kind = Literal["local", "objective"]


@kernel(f8(F1, F2, flag[:, ::1], f8, f8, f8, i8))
def damp(mass, momentum_force, held, alpha, dt, cutoff, objective):
    """Damp the forces of nodes that no wall holds, and return the work that the damping takes in the step.

    It is the work on the mean velocity of the step: exactly what the kinetic energy of the grid lacks.
    """
    work = 0.0
    for i in range(mass.shape[0]):
        if mass[i] > cutoff:
            f0, f1 = momentum_force[i, 2], momentum_force[i, 3]
            v0 = momentum_force[i, 0] / mass[i]
            v1 = momentum_force[i, 1] / mass[i]
            if held[i, 0]:
                f0 = v0 = 0.0
            if held[i, 1]:
                f1 = v1 = 0.0
            if objective:
                speed = np.sqrt(v0 * v0 + v1 * v1)
                scale = alpha * np.sqrt(f0 * f0 + f1 * f1) / speed if speed > 0.0 else 0.0
                d0, d1 = scale * v0, scale * v1
            else:
                d0, d1 = alpha * abs(f0) * np.sign(v0), alpha * abs(f1) * np.sign(v1)
            momentum_force[i, 2] -= d0
            momentum_force[i, 3] -= d1
            half = 0.5 * dt / mass[i]
            work += dt * (d0 * (v0 + half * (f0 - d0)) + d1 * (v1 + half * (f1 - d1)))
    return work


@dataclass(frozen=True)
class Damping:
    """Damping of the unbalanced force at the nodes.

    Parameters
    ----------
    alpha
        Fraction of the force, from 0 to below 1.
    kind
        ``local``, component by component, or ``objective``.

    Raises
    ------
    ValueError
        For another fraction or kind.
    """

    alpha: float
    kind: Kind = "local"

    def __post_init__(self) -> None:
        if not 0 <= self.alpha < 1:
            raise ValueError(f"damping = {self.alpha} must lie from 0 to below 1: a fraction of the unbalanced force")
        if self.kind not in get_args(Kind):
            raise ValueError(f"no damping {self.kind!r}; choose from {', '.join(get_args(Kind))}")

    def apply(self, grid: Grid, walls: Walls, dt: float, cutoff: float) -> float:
        """Damp grid.force, and return the work that this takes in the step."""
        if not self.alpha:
            return 0.0
        objective = int(self.kind == "objective")
        return float(damp(grid.mass, grid.momentum_force, walls.held, self.alpha, dt, cutoff, objective))
