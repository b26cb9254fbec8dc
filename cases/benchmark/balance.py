"""Balance of a body in layers of cells: the mean stress of each by the weights of the method."""

import numpy as np

from mpm_verify.solver.model import Model
from mpm_verify.solver.state import Floats
from mpm_verify.solver.step import particles_to_grid

LEAST = 0.1  # of a cell that is full: a cell with less is left out
YY = np.array([0.0, 1.0, 0.0, 0.0])  # component of a stress


def rms(values: Floats) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def nodal(model: Model, yy: Floats) -> Floats:
    """Vertical forces of a stress yy (P,) alone at each row of nodes, from the ghost cells upwards."""
    p, grid = model.particles, model.grid
    kept = p.sigma, p.b
    p.sigma, p.b = yy[:, None] * YY, np.zeros_like(p.b)
    particles_to_grid(model)
    p.sigma, p.b = kept
    found: Floats = grid.force[:, 1].reshape(grid.nx, grid.ny).sum(axis=0)
    return found


def cell_stress(model: Model, error: Floats) -> tuple[Floats, Floats]:
    """Heights of cells, and the mean error of the stress in each by the weights of the method, (n,) each.

    The forces of a stress at the nodes above a face are the stress on that cell: a field that rises by one over the
    cell has the gradient 1/dx there and 0 elsewhere. Cells that are nearly empty are left out.
    """
    grid = model.grid
    force, filled = (-np.cumsum(nodal(model, one)[::-1])[::-1][1:] for one in (error, np.ones_like(error)))
    there = filled > LEAST * filled.max()
    heights = grid.origin[1] + grid.dx * (np.arange(len(filled)) + 0.5)
    return heights[there], force[there] / filled[there]
