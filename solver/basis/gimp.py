"""GIMP with domains of fixed size (uGIMP): hat functions averaged over a rectangle that does not deform.

N = Nx Ny with N(s) = 1/(2 l) times the integral of the hat over (s - l, s + l), and the gradient is that of N. With
half lengths l up to half a cell. Source: Bardenhagen & Kober 2004. Order 2 until particles cross cells; then domains
that do not follow the deformation overlap or leave gaps, and the order falls (Wallstedt & Guilkey 2008).
"""

from typing import ClassVar

import numpy as np

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.basis._gimp import half_lengths, slope, value
from mpm_verify.solver.failure import FailureKind
from mpm_verify.solver.layout import Layout, parallelograms
from mpm_verify.solver.state import Floats
from mpm_verify.solver.tensor import three
from mpm_verify.solver.weights import FILL, Basis, Fault, Position, Promise, outside

LARGEST = 0.5 + 1e-9  # half length, in cells: beyond, a domain reaches a fourth node


@kernel(FILL)
def fill(x, F, l0, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """Write N and dN of the nearest node and of those around it, nine in all; see solver/weights.py."""
    bad = 0
    for b in range(x.shape[0] // 2):
        px = (x[2 * b] - ox) * inv_dx
        py = (x[2 * b + 1] - oy) * inv_dx
        lx = l0[2 * b] * inv_dx
        ly = l0[2 * b + 1] * inv_dx
        i = np.floor(px + 0.5)
        j = np.floor(py + 0.5)
        bad += outside(x0, x1, y0, y1, i - 1.0, i + 0.5, j - 1.0, j + 0.5)
        bad += int(not (max(lx, ly) < LARGEST))
        per_x = 0.5 / lx
        per_y = 0.5 / ly
        sx = px - i
        sy = py - j
        first = (np.int64(i) - 1) * ny + np.int64(j) - 1
        Y0 = value(sy + 1.0, ly, per_y)
        Y1 = value(sy, ly, per_y)
        Y2 = value(sy - 1.0, ly, per_y)
        D0 = slope(sy + 1.0, ly, per_y) * inv_dx
        D1 = slope(sy, ly, per_y) * inv_dx
        D2 = slope(sy - 1.0, ly, per_y) * inv_dx
        for a in range(3):
            s = sx + 1.0 - a
            three(
                3 * a,
                9,
                b,
                first + a * ny,
                value(s, lx, per_x),
                slope(s, lx, per_x) * inv_dx,
                Y0,
                Y1,
                Y2,
                D0,
                D1,
                D2,
                table,
                node,
            )
    return bad == 0


class Gimp(Basis):
    """GIMP with domains of fixed size: nine support nodes, order 2 before the first cell crossing.

    References
    ----------
    Bardenhagen & Kober 2004, doi:10.3970/cmes.2004.005.477.
    Wallstedt & Guilkey 2008, doi:10.1016/j.jcp.2008.07.019, for the order with crossings.
    """

    support: ClassVar[int] = 9
    order: ClassVar[float] = 2.0
    fill = staticmethod(fill)
    domain_size: ClassVar[int] = 2
    domain_motion: ClassVar[str] = "fixed"

    @classmethod
    def promises(cls, crossing: bool) -> Promise:
        """Stall of u once particles cross cells."""
        return Promise(None, True, "Wallstedt & Guilkey 2008") if crossing else Promise(cls.order)

    @staticmethod
    def domain(layout: Layout, position: Position) -> Floats:
        """Half lengths (P,2) in x and y at the start."""
        return half_lengths(layout)

    @staticmethod
    def corners(x: Floats, F: Floats, domain: Floats, dx: float) -> Floats:
        """Corners (P,4,2) of rectangles with sides in x and y."""
        half = domain
        return parallelograms(x, half[:, :, None] * np.eye(2))

    @staticmethod
    def fault(F: Floats, domain: Floats, dx: float) -> Fault:
        """Domain too wide for nine support nodes, or particle at the edge."""
        if not domain.max() < LARGEST * dx:
            return FailureKind.DOMAIN_TOO_WIDE, {"width": 2 * float(domain.max()) / dx, "limit": 1.0}
        return FailureKind.OUTSIDE_GRID, {}
