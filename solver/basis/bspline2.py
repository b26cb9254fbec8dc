"""Quadratic B-splines on the grid: smooth weights at a point, three nodes in each direction.

    N(s) = 3/4 - s^2 for |s| < 1/2,  (3/2 - |s|)^2 / 2 for |s| < 3/2;  s in cells from the node

At a wall the weight of the node behind it is folded onto the two nearest in the body by linear extrapolation,
N_0 + 2 N_-1 and N_1 - N_-1. That leaves linear fields exact and the wall node interpolatory, so a given velocity can
stand there; these are the boundary functions of Steffen, Kirby & Berzins 2008.
Order 2: continuous gradients remove the error of cell crossing, but with few particles a cell the quadrature stalls it.
"""

from typing import ClassVar

import numpy as np

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.basis._splines import beyond
from mpm_verify.solver.state import PAD
from mpm_verify.solver.tensor import three
from mpm_verify.solver.weights import FILL, Basis, Promise, outside


@kernel(inline=True)
def fold(w0, w1, w2, first, last):
    """Weights with that of a node behind the wall, where `first` or `last` is 1, put onto the two next to it."""
    ghost = first * w0
    other = last * w2
    return w0 - ghost - other, w1 + 2.0 * (ghost + other), w2 - other - ghost


@kernel(FILL)
def fill(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """Write N and dN of the nearest node and of those around it, nine in all; see solver/weights.py."""
    bad = 0
    for b in range(x.shape[0] // 2):
        px = (x[2 * b] - ox) * inv_dx
        py = (x[2 * b + 1] - oy) * inv_dx
        i = min(max(np.floor(px + 0.5), float(PAD)), float(nx - 1 - PAD))
        j = min(max(np.floor(py + 0.5), float(PAD)), float(ny - 1 - PAD))
        bad += beyond(px, nx) + beyond(py, ny)
        bad += outside(x0, x1, y0, y1, i - 1.0, i + 0.5, j - 1.0, j + 0.5)
        sx = px - i
        sy = py - j
        X0 = 0.5 * (0.5 - sx) * (0.5 - sx)
        X2 = 0.5 * (0.5 + sx) * (0.5 + sx)
        Y0 = 0.5 * (0.5 - sy) * (0.5 - sy)
        Y2 = 0.5 * (0.5 + sy) * (0.5 + sy)
        left = 1.0 * (i == PAD)  # whether the first, or the last, of the three nodes is behind a wall
        right = 1.0 * (i == nx - 1 - PAD)
        below = 1.0 * (j == PAD)
        above = 1.0 * (j == ny - 1 - PAD)
        A0, A1, A2 = fold(X0, 0.75 - sx * sx, X2, left, right)
        B0, B1, B2 = fold(Y0, 0.75 - sy * sy, Y2, below, above)
        C0, C1, C2 = fold((sx - 0.5) * inv_dx, -2.0 * sx * inv_dx, (sx + 0.5) * inv_dx, left, right)
        D0, D1, D2 = fold((sy - 0.5) * inv_dx, -2.0 * sy * inv_dx, (sy + 0.5) * inv_dx, below, above)
        first = (np.int64(i) - 1) * ny + np.int64(j) - 1
        three(0, 9, b, first, A0, C0, B0, B1, B2, D0, D1, D2, table, node)
        three(3, 9, b, first + ny, A1, C1, B0, B1, B2, D0, D1, D2, table, node)
        three(6, 9, b, first + 2 * ny, A2, C2, B0, B1, B2, D0, D1, D2, table, node)
    return bad == 0


class Bspline2(Basis):
    """Quadratic B-splines: nine support nodes, order 2.

    References
    ----------
    Steffen, Kirby & Berzins 2008, doi:10.1002/nme.2360.
    Tielen, Wobbes, Moeller & Beuth 2017, doi:10.1016/j.proeng.2017.01.022, for the stall with crossings.
    """

    support: ClassVar[int] = 9
    order: ClassVar[float] = 2.0
    fill = staticmethod(fill)

    @classmethod
    def promises(cls, crossing: bool) -> Promise:
        """Stall of u once particles cross cells."""
        return Promise(None, True, "Tielen, Wobbes, Moeller & Beuth 2017") if crossing else Promise(cls.order)
