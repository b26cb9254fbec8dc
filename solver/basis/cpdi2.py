"""CPDI2: hat functions averaged over a quadrilateral whose corners move with the grid's velocity.

The field is interpolated bilinearly from the corners, so adjacent domains share them and leave no gaps, rotation and
bending included. N and dN are the exact means of that interpolation and of its gradient over the quadrilateral; a
particle's weights reproduce its centroid. Source: Sadeghirad, Brannon & Guilkey 2013. Order 2, large deformation
included.
"""

from typing import ClassVar

import numpy as np
from numba import prange

from mpm_verify.solver._jit import BLOCK, F1, F2, f8, i8, kernel, nothing
from mpm_verify.solver.failure import FailureKind
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.state import Floats, Grid, Particles
from mpm_verify.solver.weights import FILL, Basis, Fault, Position, Promise, bilinear, outside


@kernel(FILL)
def fill(x, F, corner, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """Write N and dN of the four nodes around each corner, sixteen in all; see solver/weights.py."""
    bad = 0
    for b in range(x.shape[0] // 2):
        ax = (corner[8 * b] - ox) * inv_dx
        ay = (corner[8 * b + 1] - oy) * inv_dx
        bx = (corner[8 * b + 2] - ox) * inv_dx
        by = (corner[8 * b + 3] - oy) * inv_dx
        cx = (corner[8 * b + 4] - ox) * inv_dx
        cy = (corner[8 * b + 5] - oy) * inv_dx
        dx = (corner[8 * b + 6] - ox) * inv_dx
        dy = (corner[8 * b + 7] - oy) * inv_dx
        V = 0.5 * ((cx - ax) * (dy - by) - (dx - bx) * (cy - ay))  # from the diagonals
        p = (dx - ax) * (by - cy) - (bx - cx) * (dy - ay)
        q = (cx - dx) * (ay - by) - (ax - bx) * (cy - dy)
        left = min(min(ax, bx), min(cx, dx))
        right = max(max(ax, bx), max(cx, dx))
        below = min(min(ay, by), min(cy, dy))
        above = max(max(ay, by), max(cy, dy))
        bad += outside(x0, x1, y0, y1, left, right, below, above) + int(not (V > 0.0))
        per_24 = 1.0 / (24.0 * V)
        per_2 = 12.0 * per_24 * inv_dx
        px = (by - dy) * per_2  # gradient weight of the first corner, and with the other sign of the third
        py = (dx - bx) * per_2
        qx = (cy - ay) * per_2  # of the second, and of the fourth
        qy = (ax - cx) * per_2
        bilinear(0, 16, b, ax, ay, (6.0 * V - p - q) * per_24, px, py, ny, table, node)
        bilinear(4, 16, b, bx, by, (6.0 * V - p + q) * per_24, qx, qy, ny, table, node)
        bilinear(8, 16, b, cx, cy, (6.0 * V + p + q) * per_24, -px, -py, ny, table, node)
        bilinear(12, 16, b, dx, dy, (6.0 * V + p - q) * per_24, -qx, -qy, ny, table, node)
    return bad == 0


@kernel(nothing(F1, f8, f8, f8, i8, F2, f8))
def move(corner, ox, oy, inv_dx, ny, velocity_acceleration, dt):
    """Move corners, flat: x_c <- x_c + dt sum S_i(x_c) v_i."""
    for c in range(corner.shape[0] // 2):
        x = (corner[2 * c] - ox) * inv_dx
        y = (corner[2 * c + 1] - oy) * inv_dx
        i = np.floor(x)
        j = np.floor(y)
        right = x - i
        above = y - j
        node = np.int64(i) * ny + np.int64(j)
        for a in range(2):
            low = (1.0 - above) * velocity_acceleration[node, a] + above * velocity_acceleration[node + 1, a]
            high = (1.0 - above) * velocity_acceleration[node + ny, a] + above * velocity_acceleration[node + ny + 1, a]
            corner[2 * c + a] += dt * ((1.0 - right) * low + right * high)


@kernel(nothing(F1, F1, f8, i8, F2, f8), parallel=True)
def move_all(corner, origin, inv_dx, ny, velocity_acceleration, dt):
    """Move all corners, in blocks."""
    for block in prange((corner.shape[0] + 8 * BLOCK - 1) // (8 * BLOCK)):
        lo = 8 * BLOCK * block
        hi = min(lo + 8 * BLOCK, corner.shape[0])
        move(corner[lo:hi], origin[0], origin[1], inv_dx, ny, velocity_acceleration, dt)


class Cpdi2(Basis):
    """CPDI2: sixteen support nodes, order 2.

    References
    ----------
    Sadeghirad, Brannon & Guilkey 2013, doi:10.1002/nme.4526.
    """

    support: ClassVar[int] = 16
    order: ClassVar[float] = 2.0
    fill = staticmethod(fill)
    domain_size: ClassVar[int] = 8
    domain_motion: ClassVar[str] = "deformed"
    faces_carry: ClassVar[bool] = True

    @classmethod
    def promises(cls, crossing: bool) -> Promise:
        """Order of u, the same when particles cross cells."""
        return Promise(cls.order, source="Sadeghirad, Brannon & Guilkey 2013")

    @staticmethod
    def domain(layout: Layout, position: Position) -> Floats:
        """Positions (P,8) of the four corners at the start, counter-clockwise."""
        return position(layout.corners.reshape(-1, 2)).reshape(-1, 8)

    @staticmethod
    def corners(x: Floats, F: Floats, domain: Floats, dx: float) -> Floats:
        """Corners (P,4,2) as they have moved."""
        return domain.reshape(-1, 4, 2)

    @staticmethod
    def convect(particles: Particles, grid: Grid, dt: float) -> None:
        """Move the corners with the velocity of the grid: they are material points."""
        move_all(particles.domain.ravel(), grid.origin, 1.0 / grid.dx, grid.ny, grid.velocity_acceleration, dt)

    @staticmethod
    def fault(F: Floats, domain: Floats, dx: float) -> Fault:
        """Domain inverted, or a corner that left the grid."""
        one, two = domain[4:6] - domain[0:2], domain[6:8] - domain[2:4]
        if not one[0] * two[1] - one[1] * two[0] > 0:
            return FailureKind.DOMAIN_INVERTED, {}
        return FailureKind.OUTSIDE_GRID, {}
