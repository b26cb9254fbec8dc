"""APIC: PIC with an affine velocity around each particle, so that what turns and stretches is not averaged away.

    m_i v_i = sum m_p N [v_p + B_p D_p^-1 (x_i - x_p)]      D_p = sum N (x_i - x_p)(x_i - x_p)^T
    v_p = sum N v_i                                         B_p = sum N v_i (x_i - x_p)^T

B_p is particles.affine_velocity. D is summed from the weights of the step, so this holds for every basis; x_p is
sum N x_i, which for cpdi2 is the centroid of its corners.
For hat functions D vanishes on the edges of cells, though N D^-1 (x_i - x_p) = dN does not: entries of D on its
diagonal are kept above 1e-12 h^2, and nearer to an edge than that the affine part is dropped.
Conserves: linear momentum; angular momentum with the affine part, sum m (x_p x v_p + B_yx - B_xy), exactly, but for
cpdi2: its centroid does not quite move with sum N v_i. Energy is lost, by far less than with PIC.
"""

from dataclasses import dataclass

import numpy as np
from numba import prange

from mpm_verify.solver._jit import BLOCK, F1, F2, F3, I1, f8, i8, kernel, nothing
from mpm_verify.solver.context import Context
from mpm_verify.solver.state import Floats
from mpm_verify.solver.transfer import CHUNK, B
from mpm_verify.solver.transfers._base import Gradient, Transfer
from mpm_verify.solver.weights import Fill

LEAST = 1e-12  # least diagonal entry of D / h^2


@kernel(inline=True)
def scatter_affine(K, lo, hi, ny, x, m, affine, ox, oy, inv_dx, table, node, out):
    """Add the momentum m N B D^-1 (x_i - x_p) of particles lo ... hi-1; positions in cells."""
    rows = np.float64(ny)
    per_row = 1.0 / rows  # a division of whole numbers for each support node takes longer than all else
    for q in range(np.uint64(hi - lo)):
        p = np.uint64(lo) + q
        px = (x[p, 0] - ox) * inv_dx
        py = (x[p, 1] - oy) * inv_dx
        sx = sy = Dxx = Dxy = Dyy = 0.0
        for k in range(np.uint64(K)):
            at = k * B + q
            number = np.float64(node[at])
            column = np.floor((number + 0.5) * per_row)
            N = table[at]
            dx = column - px
            dy = number - column * rows - py
            sx += N * dx
            sy += N * dy
            Dxx += N * dx * dx
            Dxy += N * dx * dy
            Dyy += N * dy * dy
        Dxx = max(Dxx - sx * sx, LEAST)
        Dyy = max(Dyy - sy * sy, LEAST)
        Dxy = Dxy - sx * sy
        scale = m[p] * inv_dx / (Dxx * Dyy - Dxy * Dxy)
        Cxx = scale * (affine[p, 0] * Dyy - affine[p, 1] * Dxy)
        Cxy = scale * (affine[p, 1] * Dxx - affine[p, 0] * Dxy)
        Cyx = scale * (affine[p, 2] * Dyy - affine[p, 3] * Dxy)
        Cyy = scale * (affine[p, 3] * Dxx - affine[p, 2] * Dxy)
        for k in range(np.uint64(K)):
            at = k * B + q
            i = np.uint64(node[at])
            column = np.floor((np.float64(i) + 0.5) * per_row)
            N = table[at]
            dx = column - px - sx
            dy = np.float64(i) - column * rows - py - sy
            out[i, 0] += N * (Cxx * dx + Cxy * dy)
            out[i, 1] += N * (Cyx * dx + Cyy * dy)


@kernel(nothing(Fill, i8, i8, i8, i8, F2, F3, F1, F2, F1, F1, f8, i8, i8, F2))
def give_slab(fill, K, W, start, end, x, F, m, affine, domain, origin, inv_dx, nx, ny, out):
    """Give the affine part of particles start ... end-1."""
    xs = x.reshape(-1)
    Fs = F.reshape(-1)
    table = np.empty(3 * K * BLOCK)
    node = np.empty(K * BLOCK, np.int64)
    for lo in range(start, end, BLOCK):
        hi = min(lo + BLOCK, end)
        fill(
            xs[2 * lo : 2 * hi], Fs[4 * lo : 4 * hi], domain[W * lo : W * hi],
            origin[0], origin[1], inv_dx, nx, ny, 0.0, nx - 1.0, 0.0, ny - 1.0, table, node,
        )  # fmt: skip
        scatter_affine(K, lo, hi, ny, x, m, affine, origin[0], origin[1], inv_dx, table, node, out)


@kernel(nothing(Fill, i8, i8, I1, F2, F3, F1, F2, F1, F1, f8, i8, i8, F2), parallel=True)
def give_affine(fill, K, W, start, x, F, m, affine, domain, origin, inv_dx, nx, ny, out):
    """Add the affine part to the first columns of `out` (n,4), in slabs of two colours as transfer.p2g, which fit."""
    slabs = start.shape[0] - 1
    for colour in range(2):
        for pair in prange((slabs - colour + 1) // 2):
            s = 2 * pair + colour
            give_slab(
                fill, K, W, start[s], start[s + 1], x, F, m, affine, domain, origin, inv_dx, nx, ny, out
            )  # fmt: skip


@kernel(inline=True)
def gather_affine(K, lo, hi, ny, x, affine, ox, oy, inv_dx, dx, velocity_acceleration, table, node):
    """Write B of particles lo ... hi-1: sum N v_i (x_i - x_p)^T about the mean position."""
    rows = np.float64(ny)
    per_row = 1.0 / rows  # a division of whole numbers for each support node takes longer than all else
    for q in range(np.uint64(hi - lo)):
        p = np.uint64(lo) + q
        px = (x[p, 0] - ox) * inv_dx
        py = (x[p, 1] - oy) * inv_dx
        sx = sy = vx = vy = Bxx = Bxy = Byx = Byy = 0.0
        for k in range(np.uint64(K)):
            at = k * B + q
            i = np.uint64(node[at])
            column = np.floor((np.float64(i) + 0.5) * per_row)
            N = table[at]
            rx = N * (column - px)
            ry = N * (np.float64(i) - column * rows - py)
            ux = velocity_acceleration[i, 0]
            uy = velocity_acceleration[i, 1]
            sx += rx
            sy += ry
            vx += N * ux
            vy += N * uy
            Bxx += ux * rx
            Bxy += ux * ry
            Byx += uy * rx
            Byy += uy * ry
        affine[p, 0] = dx * (Bxx - vx * sx)
        affine[p, 1] = dx * (Bxy - vx * sy)
        affine[p, 2] = dx * (Byx - vy * sx)
        affine[p, 3] = dx * (Byy - vy * sy)


@kernel(nothing(Fill, i8, i8, i8, i8, F2, F3, F2, F1, F1, f8, i8, i8, F2))
def take_chunk(fill, K, W, start, end, x, F, affine, domain, origin, inv_dx, nx, ny, velocity_acceleration):
    """Take B of particles start ... end-1."""
    xs = x.reshape(-1)
    Fs = F.reshape(-1)
    table = np.empty(3 * K * BLOCK)
    node = np.empty(K * BLOCK, np.int64)
    for lo in range(start, end, BLOCK):
        hi = min(lo + BLOCK, end)
        fill(
            xs[2 * lo : 2 * hi], Fs[4 * lo : 4 * hi], domain[W * lo : W * hi],
            origin[0], origin[1], inv_dx, nx, ny, 0.0, nx - 1.0, 0.0, ny - 1.0, table, node,
        )  # fmt: skip
        gather_affine(
            K, lo, hi, ny, x, affine, origin[0], origin[1], inv_dx, 1.0 / inv_dx, velocity_acceleration, table, node
        )


@kernel(nothing(Fill, i8, i8, F2, F3, F2, F1, F1, f8, i8, i8, F2), parallel=True)
def take_affine(fill, K, W, x, F, affine, domain, origin, inv_dx, nx, ny, velocity_acceleration):
    """Write B (P,4) of all particles."""
    for c in prange((x.shape[0] + CHUNK - 1) // CHUNK):
        start = c * CHUNK
        end = min(x.shape[0], start + CHUNK)
        take_chunk(fill, K, W, start, end, x, F, affine, domain, origin, inv_dx, nx, ny, velocity_acceleration)


@dataclass(frozen=True)
class Apic(Transfer):
    """APIC, the affine particle-in-cell method; no parameters.

    The state of its own is particles.affine_velocity (P,4): B as xx, xy, yx, yy, a velocity times a length.

    References
    ----------
    Jiang, Schroeder, Selle, Teran & Stomakhin 2015, doi:10.1145/2766996.
    Jiang, Schroeder & Teran 2017, doi:10.1016/j.jcp.2017.02.050, for the symplectic step.
    """

    def start(self, context: Context, L: Gradient | None = None) -> None:
        """Write B = L D, by which p2g gives each node the velocity of the affine field; zero without L (P,2,2)."""
        p, g = context.particles, context.grid
        p.affine_velocity = np.zeros((len(p), 4))
        if L is not None:
            positions = np.concatenate([g.nodes, np.zeros_like(g.nodes)], axis=1)
            write_affine(context, positions)  # for v_i = x_i, B is D
            p.affine_velocity = (L(p.X) @ p.affine_velocity.reshape(-1, 2, 2)).reshape(-1, 4)

    def give(self, context: Context, momentum: Floats) -> None:
        """Add the affine part to the first two columns of `momentum` (n,4)."""
        g, p, basis = context.grid, context.particles, context.basis
        give_affine(
            basis.fill, basis.support, basis.domain_size, context.slabs.start, p.x, p.F, p.m, p.affine_velocity,
            p.domain.ravel(), g.origin, 1.0 / g.dx, g.nx, g.ny, momentum,
        )  # fmt: skip

    def take(self, context: Context) -> None:
        """Write B from the new velocities."""
        write_affine(context, context.grid.velocity_acceleration)


def write_affine(context: Context, velocity_acceleration: Floats) -> None:
    """Write particles.affine_velocity from velocities, the first columns of `velocity_acceleration` (n,4)."""
    g, p, basis = context.grid, context.particles, context.basis
    take_affine(
        basis.fill, basis.support, basis.domain_size, p.x, p.F, p.affine_velocity, p.domain.ravel(), g.origin,
        1.0 / g.dx,
        g.nx, g.ny, velocity_acceleration,
    )  # fmt: skip
