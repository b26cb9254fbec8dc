"""Kernels of the edge of a body: hat functions at points, and the weights of the nodes around many of them."""

import numpy as np

from mpm_verify.solver._jit import BLOCK, F1, F2, I1, f8, i8, kernel
from mpm_verify.solver.weights import FILL, Fill, bilinear, outside


@kernel(FILL)
def hats(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """Write the hat functions of the four nodes around a point: what the grid's field is for all but splines."""
    bad = 0
    for b in range(x.shape[0] // 2):
        px = (x[2 * b] - ox) * inv_dx
        py = (x[2 * b + 1] - oy) * inv_dx
        bad += outside(x0, x1, y0, y1, px, px, py, py)
        bilinear(0, 4, b, px, py, 1.0, 0.0, 0.0, ny, table, node)
    return bad == 0


@kernel(i8(Fill, i8, F2, F1, f8, i8, i8, F2, I1))
def weigh(fill, K, x, origin, inv_dx, nx, ny, weights, nodes):
    """Write the weights (S,K) of the nodes around points x (S,2), and their numbers, row by row, (S K,).

    Returns -1, or the first point of a block that is outside.
    """
    xs = x.reshape(-1)
    none = np.zeros(4 * BLOCK)
    table = np.empty(3 * K * BLOCK)
    node = np.empty(K * BLOCK, np.int64)
    for lo in range(0, x.shape[0], BLOCK):
        hi = min(lo + BLOCK, x.shape[0])
        if not fill(
            xs[2 * lo : 2 * hi], none, none, origin[0], origin[1], inv_dx, nx, ny, 0.0, nx - 1.0, 0.0, ny - 1.0, table,
            node,
        ):  # fmt: skip
            return lo
        for q in range(hi - lo):
            for k in range(K):
                weights[lo + q, k] = table[k * BLOCK + q]
                nodes[(lo + q) * K + k] = node[k * BLOCK + q]
    return -1
