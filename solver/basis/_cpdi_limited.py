"""CPDI with domains of limited length: a kernel of its own, compiled only where a limit is given."""

import numpy as np

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.basis._parallelogram import half_sides, parallelogram, passed
from mpm_verify.solver.weights import FILL


@kernel(FILL)
def fill_limited(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """Fill as in solver/basis/cpdi.py, with half diagonals no longer than the fifth number of each domain, in cells."""
    bad = 0
    for b in range(x.shape[0] // 2):
        r1x, r1y, r2x, r2y = half_sides(b, 5 * b, F, domain)
        sx = r1x + r2x
        sy = r1y + r2y
        dx = r1x - r2x
        dy = r1y - r2y
        s = np.sqrt(sx * sx + sy * sy)
        d = np.sqrt(dx * dx + dy * dy)
        long = domain[5 * b + 4] / inv_dx
        s = long / (s + long + abs(s - long))  # half of long / max(s, long); as a branch it would not vectorise
        d = long / (d + long + abs(d - long))
        r1x = s * sx + d * dx
        r1y = s * sy + d * dy
        r2x = s * sx - d * dx
        r2y = s * sy - d * dy
        bad += passed(b, x, r1x, r1y, r2x, r2y, ox, oy, inv_dx, x0, x1, y0, y1)
        parallelogram(b, x, r1x, r1y, r2x, r2y, ox, oy, inv_dx, ny, table, node)
    return bad == 0
