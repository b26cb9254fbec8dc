"""Cubic B-splines on the grid: smooth weights at a point, four nodes in each direction.

    N(s) = 2/3 - s^2 + |s|^3 / 2 for |s| < 1,  (2 - |s|)^3 / 6 for |s| < 2;  s in cells from the node

At a wall the node behind it is folded as in bspline2. Order 2: the lumped mass limits it, not the spline.
Source: Steffen, Kirby & Berzins 2008.
"""

from typing import ClassVar

import numpy as np

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.basis._splines import beyond
from mpm_verify.solver.state import PAD
from mpm_verify.solver.tensor import four
from mpm_verify.solver.weights import FILL, Basis, Promise, outside


@kernel(inline=True)
def weights(s):
    """Values at the four nodes around a point in a cell, 0 <= s <= 1 from the second of them."""
    r = 1.0 - s
    return r * r * r / 6.0, 2.0 / 3.0 - s * s + 0.5 * s * s * s, 2.0 / 3.0 - r * r + 0.5 * r * r * r, s * s * s / 6.0


@kernel(inline=True)
def slopes(s, inv_dx):
    """Derivatives of the weights at the four nodes, per length."""
    r = 1.0 - s
    half = 0.5 * inv_dx
    return -half * r * r, half * s * (3.0 * s - 4.0), half * r * (4.0 - 3.0 * r), half * s * s


@kernel(inline=True)
def fold(w0, w1, w2, w3, first, last):
    """Weights with that of a node behind the wall, where `first` or `last` is 1, put onto the two next to it."""
    ghost = first * w0
    other = last * w3
    return w0 - ghost, w1 + 2.0 * ghost - other, w2 + 2.0 * other - ghost, w3 - other


@kernel(FILL)
def fill(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """Write N and dN of sixteen nodes; see solver/weights.py."""
    bad = 0
    for b in range(x.shape[0] // 2):
        px = (x[2 * b] - ox) * inv_dx
        py = (x[2 * b + 1] - oy) * inv_dx
        i = min(max(np.floor(px), float(PAD)), float(nx - 2 - PAD))
        j = min(max(np.floor(py), float(PAD)), float(ny - 2 - PAD))
        bad += beyond(px, nx) + beyond(py, ny)
        bad += outside(x0, x1, y0, y1, i - 1.0, i + 1.5, j - 1.0, j + 1.5)
        sx = px - i
        sy = py - j
        left = 1.0 * (i == PAD)
        right = 1.0 * (i == nx - 2 - PAD)
        below = 1.0 * (j == PAD)
        above = 1.0 * (j == ny - 2 - PAD)
        a0, a1, a2, a3 = weights(sx)
        A0, A1, A2, A3 = fold(a0, a1, a2, a3, left, right)
        b0, b1, b2, b3 = weights(sy)
        B0, B1, B2, B3 = fold(b0, b1, b2, b3, below, above)
        c0, c1, c2, c3 = slopes(sx, inv_dx)
        C0, C1, C2, C3 = fold(c0, c1, c2, c3, left, right)
        d0, d1, d2, d3 = slopes(sy, inv_dx)
        D0, D1, D2, D3 = fold(d0, d1, d2, d3, below, above)
        first = (np.int64(i) - 1) * ny + np.int64(j) - 1
        four(0, 16, b, first, A0, C0, B0, B1, B2, B3, D0, D1, D2, D3, table, node)
        four(4, 16, b, first + ny, A1, C1, B0, B1, B2, B3, D0, D1, D2, D3, table, node)
        four(8, 16, b, first + 2 * ny, A2, C2, B0, B1, B2, B3, D0, D1, D2, D3, table, node)
        four(12, 16, b, first + 3 * ny, A3, C3, B0, B1, B2, B3, D0, D1, D2, D3, table, node)
    return bad == 0


class Bspline3(Basis):
    """Cubic B-splines: sixteen support nodes, order 2.

    References
    ----------
    Steffen, Kirby & Berzins 2008, doi:10.1002/nme.2360.
    """

    support: ClassVar[int] = 16
    order: ClassVar[float] = 2.0
    fill = staticmethod(fill)

    @classmethod
    def promises(cls, crossing: bool) -> Promise:
        """Stall of u once particles cross cells: as with bspline2, on finer cells; measured, no source."""
        return Promise(None, stalls=True) if crossing else Promise(cls.order)
