"""cpGIMP: GIMP on rectangles that stretch with the diagonal of F, l = |F_xx| l0_x along x and |F_yy| l0_y along y.

Contiguous particles where the body is stretched along the axes; shear and rotation are not followed: a body that turns
and is stretched gets domains much too wide or, where F_xx or F_yy vanishes, none. Half lengths of up to one cell.
Source: Bardenhagen & Kober 2004; Wallstedt & Guilkey 2008.
"""

from typing import ClassVar

import numpy as np

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.basis._gimp import half_lengths, slope, value
from mpm_verify.solver.failure import FailureKind
from mpm_verify.solver.layout import Layout, parallelograms
from mpm_verify.solver.state import Floats
from mpm_verify.solver.tensor import four
from mpm_verify.solver.weights import FILL, Basis, Place, Refusal, outside


@kernel(inline=True)
def column(a, b, first, sx, lx, per_x, inv_dx, Y0, Y1, Y2, Y3, D0, D1, D2, D3, table, node):
    """The four nodes of column a. Called four times: the vectoriser passes a loop by."""
    Nx = value(sx - a, lx, per_x)
    Gx = slope(sx - a, lx, per_x) * inv_dx
    four(4 * a, 16, b, first, Nx, Gx, Y0, Y1, Y2, Y3, D0, D1, D2, D3, table, node)


@kernel(FILL)
def fill(x, F, l0, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """N and dN of the nodes that a domain of up to two cells can reach, sixteen in all; see solver/weights.py."""
    bad = 0
    for b in range(x.shape[0] // 2):
        px = (x[2 * b] - ox) * inv_dx
        py = (x[2 * b + 1] - oy) * inv_dx
        lx = abs(F[4 * b]) * l0[2 * b] * inv_dx
        ly = abs(F[4 * b + 3]) * l0[2 * b + 1] * inv_dx
        i = np.floor(px - lx)
        j = np.floor(py - ly)
        bad += outside(x0, x1, y0, y1, i, i + 2.5, j, j + 2.5)
        bad += int(not (max(lx, ly) <= 1.0)) + int(not (min(lx, ly) > 0.0))
        per_x = 0.5 / lx
        per_y = 0.5 / ly
        sx = px - i
        sy = py - j
        first = np.int64(i) * ny + np.int64(j)
        Y0 = value(sy, ly, per_y)
        Y1 = value(sy - 1.0, ly, per_y)
        Y2 = value(sy - 2.0, ly, per_y)
        Y3 = value(sy - 3.0, ly, per_y)
        D0 = slope(sy, ly, per_y) * inv_dx
        D1 = slope(sy - 1.0, ly, per_y) * inv_dx
        D2 = slope(sy - 2.0, ly, per_y) * inv_dx
        D3 = slope(sy - 3.0, ly, per_y) * inv_dx
        column(0, b, first, sx, lx, per_x, inv_dx, Y0, Y1, Y2, Y3, D0, D1, D2, D3, table, node)
        column(1, b, first + ny, sx, lx, per_x, inv_dx, Y0, Y1, Y2, Y3, D0, D1, D2, D3, table, node)
        column(2, b, first + 2 * ny, sx, lx, per_x, inv_dx, Y0, Y1, Y2, Y3, D0, D1, D2, D3, table, node)
        column(3, b, first + 3 * ny, sx, lx, per_x, inv_dx, Y0, Y1, Y2, Y3, D0, D1, D2, D3, table, node)
    return bad == 0


class Cpgimp(Basis):
    """Sixteen neighbours, order 2 while the body neither turns nor shears."""

    support: ClassVar[int] = 16
    order: ClassVar[float] = 2.0
    fill = staticmethod(fill)
    domain_size: ClassVar[int] = 2

    @staticmethod
    def domain(layout: Layout, place: Place) -> Floats:
        """Half lengths along x and y, as at first."""
        return half_lengths(layout)

    @staticmethod
    def corners(x: Floats, F: Floats, domain: Floats, dx: float) -> Floats:
        """Of rectangles along the axes."""
        half = np.abs(np.diagonal(F, axis1=1, axis2=2)) * domain
        return parallelograms(x, half[:, :, None] * np.eye(2))

    @staticmethod
    def refusal(F: Floats, domain: Floats, dx: float) -> Refusal:
        """Too wide for sixteen support nodes, without width, or at the edge."""
        half = np.abs(np.diagonal(F)) * domain
        if half.max() > dx:
            return FailureKind.DOMAIN_TOO_WIDE, {"width": 2 * float(half.max()) / dx, "limit": 2.0}
        return FailureKind.OUTSIDE_GRID if half.min() > 0 else FailureKind.NO_WIDTH, {}
