"""Crowding: what particles claim beyond the space that there is comes off their volume.

det F follows the gradient of the velocity and positions the velocity. Nothing else ties the two, and the grid sees det
F alone: whatever brings particles together and no particle feels as a strain meets no resistance. Gravity finds it, so
that with 9 particles per cell a heap is 8 % too small for its material. The space is where positions are:

    phi = sum V N / space at each node, V = J V0 exp(-void), voids closed, N hat functions, space dx^2, less by walls

Both sums are smoothed by (1 2 1)/4 along both axes, twice: after a collapse particles lie in their cells as if by
chance, and phi scatters by 0.2 to 0.3 between nodes. Where it is above 1 + slack, ln J of the particles there falls by
RATE (phi - 1 - slack), each time that pooling asks (every sixteenth step, before it pools): a strain that the material
sees as any other. It closes voids, then builds up pressure; that drives the particles apart, and they come back to the
volume that they had with the space for it. Claims below the space mean nothing, as at a surface or in flight. So noise
is rectified; therefore smoothing and slack.
Without slack the sand of `verify box`, which is sound, ends with K = 0.9 instead of 0.5, by a strain of 0.7 %. Of n
particles per cell that lie by chance smoothed claims scatter by 0.26/sqrt(n); the slack is a third of it, or SLACK.

What positions have drifted from det F is the sum of these strains, and the work of stress on them is counted: it is
energy given to the body, which crowding took from its fall. Sums are serial: the same bits for any number of threads.
"""

from dataclasses import dataclass, field

import numpy as np

from mpm_verify.solver._jit import F1, F2, f8, i8, kernel, nothing
from mpm_verify.solver.boundary import Walls
from mpm_verify.solver.context import Context
from mpm_verify.solver.state import PAD, Floats, Grid

RATE, SLACK, NOISE, PASSES = 0.1, 0.03, 0.09, 2


@kernel(nothing(F2, F1, F1, f8, i8, i8, F1))
def claimed(x, V, origin, inv_dx, nx, ny, claims):
    """Add the volumes V (P,) of particles at x (P,2) to the nodes (n,), by hat functions."""
    for p in range(x.shape[0]):
        at, up = (x[p, 0] - origin[0]) * inv_dx, (x[p, 1] - origin[1]) * inv_dx
        if at >= 0.0 and at < nx - 1.0 and up >= 0.0 and up < ny - 1.0:
            i, j = np.int64(at), np.int64(up)
            first, right, above = i * ny + j, at - i, up - j
            claims[first] += V[p] * (1.0 - right) * (1.0 - above)
            claims[first + 1] += V[p] * (1.0 - right) * above
            claims[first + ny] += V[p] * right * (1.0 - above)
            claims[first + ny + 1] += V[p] * right * above


@kernel(nothing(F2, F1, f8, i8, i8, F1, F1))
def collected(x, origin, inv_dx, nx, ny, values, out):
    """Write values of nodes (n,) at particles (P,), by hat functions; zero outside the grid."""
    for p in range(x.shape[0]):
        out[p] = 0.0
        at, up = (x[p, 0] - origin[0]) * inv_dx, (x[p, 1] - origin[1]) * inv_dx
        if at >= 0.0 and at < nx - 1.0 and up >= 0.0 and up < ny - 1.0:
            i, j = np.int64(at), np.int64(up)
            first, right, above = i * ny + j, at - i, up - j
            left = (1.0 - above) * values[first] + above * values[first + 1]
            out[p] = (1.0 - right) * left
            out[p] += right * ((1.0 - above) * values[first + ny] + above * values[first + ny + 1])


def closed(grid: Grid, walls: Walls) -> tuple[bool, bool, bool, bool]:
    """Whether a wall stands on the left, right, bottom and top side of the domain: beyond a free one there is space."""
    column, row = np.arange(PAD, grid.ny - PAD), grid.ny * np.arange(PAD, grid.nx - PAD)
    left, right = (walls.closes(i * grid.ny + column, 0) for i in (PAD, grid.nx - PAD - 1))
    bottom, top = (walls.closes(row + j, 1) for j in (PAD, grid.ny - PAD - 1))
    return left, right, bottom, top


def spaces(grid: Grid, sides: tuple[bool, bool, bool, bool]) -> Floats:
    """Area of the hat function of each node (nx,ny) within `sides` with walls, and within the grid, ghost cells too."""
    widths = []
    for count, lower, upper in ((grid.nx, *sides[:2]), (grid.ny, *sides[2:])):
        first, last = PAD * lower, count - 1 - PAD * upper
        width = np.zeros(count)
        width[first : last + 1] = grid.dx
        width[[first, last]] *= 0.5
        widths.append(width)
    return np.multiply.outer(*widths)


def smoothed(values: Floats) -> Floats:
    """Values (nx,ny) smoothed PASSES times by (1 2 1)/4 along both axes; nothing lies beyond the grid."""
    for _ in range(PASSES):
        for _ in range(2):
            padded = np.pad(values, ((1, 1), (0, 0)))
            values = (0.25 * (padded[:-2] + padded[2:]) + 0.5 * padded[1:-1]).T
    return values


def excess(grid: Grid, space: Floats, x: Floats, V: Floats) -> Floats:
    """Claims of volumes V (P,) at x (P,2) over smoothed `space` (nx,ny), less 1, at nodes (n,); -1 where none is."""
    claims = np.zeros(grid.nx * grid.ny)
    claimed(x, V, grid.origin, 1.0 / grid.dx, grid.nx, grid.ny, claims)
    found = smoothed(claims.reshape(grid.nx, grid.ny))
    over: Floats = np.divide(found, space, out=np.zeros_like(found), where=space > 0).ravel() - 1.0
    return over


def slack(grid: Grid, V0: Floats) -> float:
    """Claims beyond the space that are left alone, by the number of particles of volumes V0 (P,) in a cell."""
    return max(SLACK, NOISE * float(np.sqrt(V0.mean())) / grid.dx)


@dataclass
class Crowding:
    """Relief of crowded particles.

    Attributes
    ----------
    given
        Work of stress on strains so far, per thickness: energy that the body is given.
    strain
        Mean of the strains so far, weighted by V0: what positions have drifted from det F, below zero.
    """

    given: float = 0.0
    strain: float = 0.0
    space: Floats = field(default_factory=lambda: np.zeros((0, 0)), repr=False)
    of: tuple[float, ...] = field(default=(), repr=False)  # the grid and its sides that `space` is of

    def relieve(self, context: Context) -> None:
        """Strain the particles that are crowded, and update their material."""
        p, grid, material = context.particles, context.grid, context.material
        if context.basis.reference:  # weights, and the forces that they give, know no crowding of positions
            return
        sides = closed(grid, context.walls)
        if self.of != (grid.dx, grid.nx, grid.ny, *sides):
            self.space, self.of = smoothed(spaces(grid, sides)), (grid.dx, grid.nx, grid.ny, *sides)
        void = p.history[:, material.memory.index("void")] if "void" in material.memory else 0.0
        over = np.maximum(excess(grid, self.space, p.x, p.V0 * p.J * np.exp(-void)) - slack(grid, p.V0), 0.0)
        if not over.any():
            return
        change = np.empty(len(p))
        collected(p.x, grid.origin, 1.0 / grid.dx, grid.nx, grid.ny, -RATE * np.minimum(over, 1.0), change)
        before = p.work.sum(axis=1)
        p.F *= np.exp(0.5 * change)[:, None, None]
        material.update(p, context.dt)
        self.given += 0.5 * float((p.V0 * (p.work.sum(axis=1) - before)).sum())
        self.strain += float((p.V0 * change).sum() / p.V0.sum())
