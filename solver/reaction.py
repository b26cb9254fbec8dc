"""Reaction, the force that walls add to a body at their nodes, and the balance of momentum that it closes.

A node whose velocity is given takes another acceleration than its force over its mass. What a wall adds in a step is
    R = (momentum that particles take from the node) / dt - f
and they take m a of FLIP, and m v_after - m v_before over dt of PIC. Gradients of weights sum to zero, so inner forces
cancel in the sum over all nodes, and in each step
    change of momentum / dt = R of all walls + weight and traction + damping
to round-off, as long as all that hand a force to a node hand it mass too. A node below the mass cut-off takes no part
in the equation of motion, so its force moves nobody: beside a surface that rises by a millionth of a cell, of domains
of a fixed size, and at points of an edge, which have traction and no mass. `Balance.missing` has what it dropped.
A transfer that filters velocities (`filters_walls`) does so after R is taken: R is not known there.
"""

import numpy as np
from numpy.typing import NDArray

from mpm_verify.solver.model import Model, Observer
from mpm_verify.solver.state import Floats


class Reaction(Observer):
    """Observer of the force of walls in the last step.

    Parameters
    ----------
    part
        Which nodes count, (n,); None for all.

    Attributes
    ----------
    force
        Force (2,) per thickness that the walls add to the body at these nodes; none on an axis that is not held.
    """

    def __init__(self, part: NDArray[np.bool_] | None = None) -> None:
        self.part = part
        self.force: Floats = np.zeros(2)

    def after_motion(self, model: Model) -> None:
        """Sum over the components that are held."""
        grid, flip = model.grid, model.scheme.transfer.flip_fraction
        taken = grid.mass[:, None] * grid.acceleration
        if flip != 1.0:
            change = (grid.mass[:, None] * grid.velocity - grid.momentum) / model.dt
            taken = flip * taken + (1.0 - flip) * change
        held = model.walls.held if self.part is None else model.walls.held & self.part[:, None]
        self.force = np.where(held, taken - grid.force, 0.0).sum(axis=0)


class Balance(Observer):
    """Observer of the momentum of the whole body: what no force explains, in all steps.

    Parameters
    ----------
    outer
        Weight and traction (2,) per thickness, constant.

    Attributes
    ----------
    missing
        Largest component of a force, per thickness, that would explain a step and is none.
    largest
        Largest component of a force so far, of the walls or of `outer`: what `missing` is to be compared with.
    """

    def __init__(self, outer: Floats) -> None:
        self.outer, self.walls = outer, Reaction()
        self.momentum: Floats = np.zeros(2)
        self.damped: Floats = np.zeros(2)
        self.missing, self.largest = 0.0, float(np.abs(outer).max())

    def before_forces(self, model: Model) -> None:
        """Keep the force before damping, and the momentum; particles change it later."""
        self.damped = -model.grid.force.sum(axis=0)
        self.momentum = momentum(model)

    def after_motion(self, model: Model) -> None:
        """Take the force of walls and of damping."""
        self.walls.after_motion(model)
        self.damped += model.grid.force.sum(axis=0)

    def after_step(self, model: Model) -> None:
        """Hold the change of momentum against the forces."""
        change = (momentum(model) - self.momentum) / model.dt
        missing = change - self.outer - self.damped - self.walls.force
        self.missing = max(self.missing, float(np.abs(missing).max()))
        self.largest = max(self.largest, float(np.abs(self.walls.force).max()))


def momentum(model: Model) -> Floats:
    """Momentum (2,) of the particles, per thickness."""
    p = model.particles
    total: Floats = (p.m[:, None] * p.v).sum(axis=0)
    return total
