"""Slabs of grid columns and the particles in them, sorted anew only when one strays out of its slab's guard."""

from dataclasses import dataclass, field

import numpy as np

from mpm_verify.solver.state import Floats, Grid, Ints, Particles

SLAB_COLUMNS = 8  # leaves a particle with a reach of one column two columns to wander before the next sort


@dataclass
class Slabs:
    """Particles by slab: those of slab s are start[s] ... start[s+1]-1.

    Parameters
    ----------
    slab_columns
        Columns of the grid in a slab.
    start
        First particle of each slab, and their number, (S+1,).
    strayed
        See transfer.p2g, (S,).
    """

    slab_columns: int = SLAB_COLUMNS
    start: Ints = field(default_factory=lambda: np.zeros(1, np.int64))
    strayed: Ints = field(default_factory=lambda: np.zeros(0, np.int64))

    def sort(self, grid: Grid, particles: Particles, x: Floats) -> None:
        """Put the particles, on the grid at x (P,2), in the order of their slabs, keeping their order within one."""
        column = np.floor((x[:, 0] - grid.origin[0]) / grid.dx)
        slab = np.clip(column, 0, grid.nx - 1).astype(np.int64) // self.slab_columns
        if (np.diff(slab) < 0).any():
            order = np.argsort(slab, kind="stable")
            particles.reorder(order)
            slab = slab[order]
        self.start = np.searchsorted(slab, np.arange(-(-grid.nx // self.slab_columns) + 1))
        self.strayed = np.full(len(self.start) - 1, -1)
