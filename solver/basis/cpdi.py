"""CPDI: hat functions averaged over a parallelogram that deforms with the particle.

The field is interpolated bilinearly from the four corners x + (-r1-r2, r1-r2, r1+r2, -r1+r2), r_i = F r0_i. So
N = 1/4 sum S(corner), and dN is the exact mean gradient of that interpolation over the domain. It is written from the
corners, because the literature holds both half and full side vectors. Order 2, large deformation included.
Source: Sadeghirad, Brannon & Burghardt 2011; paper eqs. (2), (3). The paper leaves the gradient weights out; they are
edge integrals of the interpolation, divided by the area.
"""

from typing import ClassVar

import numpy as np

from solver._jit import kernel
from solver.layout import Layout, parallelograms
from solver.state import Floats
from solver.weights import FILL, Basis, Place, bilinear, outside


@kernel(FILL)
def fill(x, F, r0, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """N and dN of the four nodes around each corner, sixteen in all, some of them the same; see solver/weights.py."""
    bad = 0
    for b in range(x.shape[0] // 2):
        r1x = F[4 * b] * r0[4 * b] + F[4 * b + 1] * r0[4 * b + 1]
        r1y = F[4 * b + 2] * r0[4 * b] + F[4 * b + 3] * r0[4 * b + 1]
        r2x = F[4 * b] * r0[4 * b + 2] + F[4 * b + 1] * r0[4 * b + 3]
        r2y = F[4 * b + 2] * r0[4 * b + 2] + F[4 * b + 3] * r0[4 * b + 3]
        per_area = 0.25 / (r1x * r2y - r1y * r2x)
        ax = (r1y - r2y) * per_area  # gradient weight of corner 1, and with the other sign of corner 3
        ay = (r2x - r1x) * per_area
        bx = (r1y + r2y) * per_area  # of corner 2, and of corner 4
        by = -(r1x + r2x) * per_area
        px = (x[2 * b] - ox) * inv_dx
        py = (x[2 * b + 1] - oy) * inv_dx
        sx = (r1x + r2x) * inv_dx  # the two half diagonals, in cells
        sy = (r1y + r2y) * inv_dx
        dx = (r1x - r2x) * inv_dx
        dy = (r1y - r2y) * inv_dx
        ex = max(abs(sx), abs(dx))
        ey = max(abs(sy), abs(dy))
        bad += outside(x0, x1, y0, y1, px - ex, px + ex, py - ey, py + ey)
        bilinear(0, 16, b, px - sx, py - sy, 0.25, ax, ay, ny, table, node)
        bilinear(4, 16, b, px + dx, py + dy, 0.25, bx, by, ny, table, node)
        bilinear(8, 16, b, px + sx, py + sy, 0.25, -ax, -ay, ny, table, node)
        bilinear(12, 16, b, px - dx, py - dy, 0.25, -bx, -by, ny, table, node)
    return bad == 0


class Cpdi(Basis):
    """Sixteen neighbours, order 2."""

    support: ClassVar[int] = 16
    order: ClassVar[float] = 2.0
    fill = staticmethod(fill)
    width: ClassVar[int] = 4

    @staticmethod
    def domain(layout: Layout, place: Place) -> Floats:
        """Initial half side vectors r0; F moves them."""
        return layout.r0.reshape(-1, 4).copy()

    @staticmethod
    def corners(x: Floats, F: Floats, domain: Floats) -> Floats:
        """x - r1 - r2 and so on, r = F r0."""
        r0 = domain.reshape(-1, 2, 2)
        return parallelograms(x, np.einsum("pab,psb->psa", F, r0))

    @staticmethod
    def refusal(F: Floats, domain: Floats, dx: float) -> str:
        """A corner."""
        return "a corner of the particle's domain is outside the grid"
