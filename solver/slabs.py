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
    first, last
        Nodes that the particles can touch until they are sorted again: first ... last-1, whole columns of the grid.
        Arrays of the others hold zeros.
    whole
        Whether all nodes count, as those of an edge with a load of its own do.
    """

    slab_columns: int = SLAB_COLUMNS
    start: Ints = field(default_factory=lambda: np.zeros(1, np.int64))
    strayed: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    first: int = 0
    last: int = 0
    whole: bool = False

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
        self.bound(grid)

    def bound(self, grid: Grid) -> None:
        """Find the nodes that the particles can touch, and clear those that they could touch until now."""
        for array in (grid.mass, grid.momentum_force, grid.velocity_acceleration):
            array[self.nodes] = 0.0
        filled, guard = np.flatnonzero(np.diff(self.start)), (self.slab_columns - 1) // 2
        self.first, self.last = 0, grid.nx * grid.ny
        if len(filled) and not self.whole:
            self.first = max(0, int(filled[0]) * self.slab_columns - guard) * grid.ny
            self.last = min(grid.nx, (int(filled[-1]) + 1) * self.slab_columns + guard + 1) * grid.ny

    @property
    def nodes(self) -> slice:
        """Slice of the nodes that the particles can touch."""
        return slice(self.first, self.last)
