"""cpGIMP: GIMP on rectangles that stretch with the diagonal of F, l = |F_xx| l0_x in x and |F_yy| l0_y in y.

Contiguous particles where the body is stretched in x and y; shear and rotation are not followed: a body that turns
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
from mpm_verify.solver.weights import FILL, Basis, Fault, Position, outside


@kernel(inline=True)
def column(a, b, first, sx, lx, per_x, inv_dx, Y0, Y1, Y2, Y3, D0, D1, D2, D3, table, node):
    """Write the four nodes of column a; called four times: the vectoriser passes a loop by."""
    Nx = value(sx - a, lx, per_x)
    Gx = slope(sx - a, lx, per_x) * inv_dx
    four(4 * a, 16, b, first, Nx, Gx, Y0, Y1, Y2, Y3, D0, D1, D2, D3, table, node)


@kernel(FILL)
def fill(x, F, l0, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """Write N and dN of the nodes that a domain of up to two cells can reach, sixteen in all; see solver/weights.py."""
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
    """GIMP on stretched rectangles (cpGIMP): sixteen support nodes, order 2 while the body neither turns nor shears.

    References
    ----------
    Bardenhagen & Kober 2004, doi:10.3970/cmes.2004.005.477.
    Wallstedt & Guilkey 2008, doi:10.1016/j.jcp.2008.07.019.
    """

    support: ClassVar[int] = 16
    order: ClassVar[float] = 2.0
    fill = staticmethod(fill)
    domain_size: ClassVar[int] = 2
    domain_motion: ClassVar[str] = "stretched"

    @staticmethod
    def domain(layout: Layout, position: Position) -> Floats:
        """Half lengths (P,2) in x and y at the start."""
        return half_lengths(layout)

    @staticmethod
    def corners(x: Floats, F: Floats, domain: Floats, dx: float) -> Floats:
        """Corners (P,4,2) of rectangles with sides in x and y."""
        half = np.abs(np.diagonal(F, axis1=1, axis2=2)) * domain
        return parallelograms(x, half[:, :, None] * np.eye(2))

    @staticmethod
    def fault(F: Floats, domain: Floats, dx: float) -> Fault:
        """Domain too wide for sixteen support nodes, domain without width, or particle at the edge."""
        half = np.abs(np.diagonal(F)) * domain
        if half.max() > dx:
            return FailureKind.DOMAIN_TOO_WIDE, {"width": 2 * float(half.max()) / dx, "limit": 2.0}
        return FailureKind.OUTSIDE_GRID if half.min() > 0 else FailureKind.NO_WIDTH, {}
