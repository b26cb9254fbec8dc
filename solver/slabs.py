"""Which particles stand in which slab of grid columns; sorted anew only when one strays out of its slab's guard."""

from dataclasses import dataclass, field

import numpy as np

from mpm_verify.solver.state import Grid, Ints, Particles

WIDTH = 8  # columns; leaves a particle with a reach of one column two columns to wander before the next sort


@dataclass
class Slabs:
    """`start` (S+1,): the particles of slab s are start[s] ... start[s+1]-1; `strayed` (S,): see transfer.p2g."""

    slab_columns: int = WIDTH
    start: Ints = field(default_factory=lambda: np.zeros(1, np.int64))
    strayed: Ints = field(default_factory=lambda: np.zeros(0, np.int64))

    def sort(self, grid: Grid, particles: Particles) -> None:
        """Put the particles in the order of their slabs, keeping their order within one."""
        column = np.floor((particles.x[:, 0] - grid.origin[0]) / grid.dx)
        slab = np.clip(column, 0, grid.nx - 1).astype(np.int64) // self.slab_columns
        if (np.diff(slab) < 0).any():
            order = np.argsort(slab, kind="stable")
            particles.reorder(order)
            slab = slab[order]
        self.start = np.searchsorted(slab, np.arange(-(-grid.nx // self.slab_columns) + 1))
        self.strayed = np.full(len(self.start) - 1, -1)
