"""Helpers of the two fills of CPDI: half sides of a parallelogram, whether it fits, and its weights by its corners."""

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.weights import bilinear, outside


@kernel(inline=True)
def half_sides(b, at, F, domain):
    """r1, r2 = F r0 of particle b, whose numbers start at `at`."""
    return (
        F[4 * b] * domain[at] + F[4 * b + 1] * domain[at + 1],
        F[4 * b + 2] * domain[at] + F[4 * b + 3] * domain[at + 1],
        F[4 * b] * domain[at + 2] + F[4 * b + 1] * domain[at + 3],
        F[4 * b + 2] * domain[at + 2] + F[4 * b + 3] * domain[at + 3],
    )


@kernel(inline=True)
def passed(b, x, r1x, r1y, r2x, r2y, ox, oy, inv_dx, x0, x1, y0, y1):
    """Number of sides of the box that a corner has passed; before weights are written: after it nothing vectorises."""
    px = (x[2 * b] - ox) * inv_dx
    py = (x[2 * b + 1] - oy) * inv_dx
    ex = max(abs(r1x + r2x), abs(r1x - r2x)) * inv_dx
    ey = max(abs(r1y + r2y), abs(r1y - r2y)) * inv_dx
    return outside(x0, x1, y0, y1, px - ex, px + ex, py - ey, py + ey)


@kernel(inline=True)
def parallelogram(b, x, r1x, r1y, r2x, r2y, ox, oy, inv_dx, ny, table, node):
    """Write N and dN of the four nodes around each corner, sixteen in all, some of them the same."""
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
    bilinear(0, 16, b, px - sx, py - sy, 0.25, ax, ay, ny, table, node)
    bilinear(4, 16, b, px + dx, py + dy, 0.25, bx, by, ny, table, node)
    bilinear(8, 16, b, px + sx, py + sy, 0.25, -ax, -ay, ny, table, node)
    bilinear(12, 16, b, px - dx, py - dy, 0.25, -bx, -by, ny, table, node)
