"""Packing of particles, whether it is good enough: no empty full cell, no domain too wide, no two adjacent too unlike.

A cell is full while the body covers all of it. The edge of the body is that of the layout, moved as the exact solution
moves it; cells that it passes through are not full. Methods whose weights are those of the reference positions are
counted there. Asked for in Moormann, Giridharan & Stolle 2022, section 2.1.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.mms.run import Packed
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.layout import Layout, shared_corners
from mpm_verify.solver.model import Model, Observer
from mpm_verify.solver.state import Floats, Grid, Ints

Mask = NDArray[np.bool_]
STRICTLY = 1e-6  # cells: an edge so near to a face runs along it and cuts no cell


@dataclass
class Packing(Observer):
    """Observer that counts the particles in full cells, one look `every` so many steps; `fewest` in any `cell`."""

    exact: Manufactured
    layout: Layout
    dx: float
    every: int = 1
    fewest: int | None = None
    cell: tuple[int, int] | None = None
    widest: float = field(init=False)
    steepest: float = field(init=False)
    edge: Floats = field(init=False)

    def __post_init__(self) -> None:
        corners = self.layout.corners
        sides = np.roll(corners, -1, axis=1) - corners
        self.widest = float(np.sqrt((sides**2).sum(axis=-1).max()) / self.dx)
        self.edge, self.steepest = outline(self.layout)

    def after_step(self, model: Model) -> None:
        """Count after the first step, and when it is time again."""
        if (model.steps - 1) % self.every == 0:
            self.look(model)

    def look(self, model: Model) -> None:
        """Count now."""
        edge = self.edge
        if not model.basis.reference:
            edge = self.exact.x(edge.reshape(-1, 2), model.time).reshape(edge.shape)
        full = full_cells(model.grid, edge)
        held = counts(model.grid, model.basis.on_grid(model.particles))
        if full.any():
            fewest = int(held[full].min())
            if self.fewest is None or fewest < self.fewest:
                i, j = np.argwhere(full & (held == fewest))[0]
                self.fewest, self.cell = fewest, (int(i), int(j))

    def begin(self, model: Model, must: bool = True) -> None:
        """Count at the start. Raises RunFailed with the cell if a full one must hold a particle and does not."""
        self.look(model)
        if must and self.fewest == 0:
            raise RunFailed(FailureKind.EMPTY_CELL, cell=self.cell)

    @property
    def packed(self) -> Packed:
        """Record for the Result."""
        return Packed(self.fewest, self.cell, self.widest, self.steepest)


def outline(layout: Layout) -> tuple[Floats, float]:
    """Faces (B,2,2) of one domain alone, start and end; and the largest ratio of volumes across a face of two.

    Faces that meet have the same bits where they do, or a row of cells could be said to pass both of them or none.
    """
    corners, number = shared_corners(layout)
    shared = corners[number]
    pairs = np.sort(np.stack([number, np.roll(number, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1) @ (len(corners), 1)
    order = np.argsort(pairs, kind="stable")
    twice = np.flatnonzero(np.diff(pairs[order]) == 0)
    one, other = order[twice], order[twice + 1]
    alone = np.setdiff1d(order, np.concatenate([one, other]))
    ends = np.stack([shared, np.roll(shared, -1, axis=1)], axis=2).reshape(-1, 2, 2)
    volume = np.abs(np.log(layout.V0[one // 4] / layout.V0[other // 4]))
    return ends[alone], float(np.exp(volume.max(initial=0.0)))


def counts(grid: Grid, x: Floats) -> Ints:
    """Particles in each cell of the domain."""
    nx, ny = shape(grid)
    cell = grid.cell(x)
    inside = ((cell >= 0) & (cell < (nx, ny))).all(axis=1)
    held: Ints = np.bincount(cell[inside] @ (ny, 1), minlength=nx * ny).reshape(nx, ny)
    return held


def shape(grid: Grid) -> tuple[int, int]:
    """Cells of the domain along x and y."""
    nx, ny = np.rint((grid.upper - grid.lower) / grid.dx).astype(int)
    return int(nx), int(ny)


def full_cells(grid: Grid, edge: Floats) -> Mask:
    """Cells whose middle is inside the outline (B,2,2), and that it does not pass through."""
    return covered(grid, edge) & ~cut(grid, edge)


def covered(grid: Grid, edge: Floats) -> Mask:
    """Cells whose middle is inside: on the way to it along its row from the left, an odd number of faces is passed."""
    nx, ny = shape(grid)
    passed = np.zeros((nx + 1, ny), dtype=np.int64)
    a, b = ((edge[:, side] - grid.lower) / grid.dx - 0.5 for side in (0, 1))  # so that middles are whole numbers
    low, high = np.minimum(a[:, 1], b[:, 1]), np.maximum(a[:, 1], b[:, 1])
    for j in range(ny):
        through = (low <= j) & (high > j)
        p, q = a[through], b[through]
        x = p[:, 0] + (j - p[:, 1]) / (q[:, 1] - p[:, 1]) * (q[:, 0] - p[:, 0])
        np.add.at(passed[:, j], np.clip(np.ceil(x), 0, nx).astype(int), 1)
    inside: Mask = passed[:-1].cumsum(axis=0) % 2 == 1
    return inside


def cut(grid: Grid, edge: Floats) -> Mask:
    """Cells with a part of the outline strictly inside."""
    marked = np.zeros(shape(grid), dtype=bool)
    length = np.hypot(*(edge[:, 1] - edge[:, 0]).T).max() / grid.dx
    for s in np.linspace(0.0, 1.0, 2 + int(8 * length)):
        position = ((1 - s) * edge[:, 0] + s * edge[:, 1] - grid.lower) / grid.dx
        cell = np.floor(position).astype(int)
        part = position - cell
        strictly = ((part > STRICTLY) & (part < 1 - STRICTLY) & (cell >= 0) & (cell < marked.shape)).all(axis=1)
        marked[tuple(cell[strictly].T)] = True
    return marked
