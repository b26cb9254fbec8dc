"""Classical MPM: the particle is a point, its weights are the bilinear hat functions at that point.

Source: Sulsky, Chen & Schreyer 1994; Kafaji 2013. Order 2 until particles cross cell faces, where the gradients jump;
with crossings the error grows on refinement (Steffen, Kirby & Berzins 2008).
"""

from typing import ClassVar

import numpy as np

from mpm_verify.solver._jit import BLOCK, kernel
from mpm_verify.solver.weights import FILL, Basis, Promise, outside

B = BLOCK


@kernel(FILL)
def fill(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """Write N and dN of the four nodes of the cell that holds the particle; see solver/weights.py."""
    bad = 0
    for b in range(x.shape[0] // 2):
        px = (x[2 * b] - ox) * inv_dx
        py = (x[2 * b + 1] - oy) * inv_dx
        bad += outside(x0, x1, y0, y1, px, px, py, py)
        i = np.floor(px)
        j = np.floor(py)
        right = px - i
        above = py - j
        left = 1.0 - right
        below = 1.0 - above
        first = np.int64(i) * ny + np.int64(j)
        node[b] = first
        node[B + b] = first + 1
        node[2 * B + b] = first + ny
        node[3 * B + b] = first + ny + 1
        table[b] = left * below
        table[B + b] = left * above
        table[2 * B + b] = right * below
        table[3 * B + b] = right * above
        table[4 * B + b] = -below * inv_dx
        table[5 * B + b] = -above * inv_dx
        table[6 * B + b] = below * inv_dx
        table[7 * B + b] = above * inv_dx
        table[8 * B + b] = -left * inv_dx
        table[9 * B + b] = left * inv_dx
        table[10 * B + b] = -right * inv_dx
        table[11 * B + b] = right * inv_dx
    return bad == 0


class Mpm(Basis):
    """Classical MPM: four support nodes, order 2 before the first cell crossing.

    References
    ----------
    Sulsky, Chen & Schreyer 1994, doi:10.1016/0045-7825(94)90112-0.
    Steffen, Kirby & Berzins 2008, doi:10.1002/nme.2360, for the error with crossings.
    """

    support: ClassVar[int] = 4
    order: ClassVar[float] = 2.0
    fill = staticmethod(fill)
    gradients_jump: ClassVar[bool] = True

    @classmethod
    def promises(cls, crossing: bool) -> Promise:
        """Growth of the error of u once particles cross cells."""
        return Promise(None, source="Steffen, Kirby & Berzins 2008") if crossing else Promise(cls.order)
