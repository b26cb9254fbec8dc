"""Single passes between particles and grid, for steps that cannot take all at once as solver/transfer.py does.

Imported only by those who need them: kernels take seconds to compile. Weights are those of the positions and F of the
particles at the time of the call, which transfer.p2g has found to fit into their slabs.
"""

import numpy as np
from numba import prange

from mpm_verify.solver._jit import BLOCK, F1, F2, F3, I1, f8, i8, kernel, nothing
from mpm_verify.solver.boundary import solve
from mpm_verify.solver.context import Context
from mpm_verify.solver.state import Floats
from mpm_verify.solver.transfer import CHUNK, B, cells_of, deform, invertible
from mpm_verify.solver.weights import Fill


@kernel(nothing(Fill, i8, i8, i8, i8, F2, F3, F1, F2, F1, F1, f8, i8, i8, F2))
def spread_slab(fill, K, W, start, end, x, F, m, values, domain, origin, inv_dx, nx, ny, out):
    """Spread the values of particles start ... end-1."""
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
        for q in range(np.uint64(hi - lo)):
            p = np.uint64(lo) + q
            px = m[p] * values[p, 0]
            py = m[p] * values[p, 1]
            for k in range(np.uint64(K)):
                i = np.uint64(node[k * B + q])
                N = table[k * B + q]
                out[i, 0] += N * px
                out[i, 1] += N * py


@kernel(nothing(Fill, i8, i8, I1, F2, F3, F1, F2, F1, F1, f8, i8, i8, F2), parallel=True)
def spread_all(fill, K, W, start, x, F, m, values, domain, origin, inv_dx, nx, ny, out):
    """Add sum m N values to the first columns of `out` (n,4), in slabs of two colours, as transfer.p2g."""
    slabs = start.shape[0] - 1
    for colour in range(2):
        for pair in prange((slabs - colour + 1) // 2):
            s = 2 * pair + colour
            spread_slab(fill, K, W, start[s], start[s + 1], x, F, m, values, domain, origin, inv_dx, nx, ny, out)


@kernel(nothing(Fill, i8, i8, i8, i8, F2, F3, F1, F1, f8, i8, i8, F2, F2))
def collect_chunk(fill, K, W, start, end, x, F, domain, origin, inv_dx, nx, ny, velocity_acceleration, values):
    """Collect the values of particles start ... end-1."""
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
        for q in range(np.uint64(hi - lo)):
            vx = vy = ax = ay = 0.0
            for k in range(np.uint64(K)):
                i = np.uint64(node[k * B + q])
                N = table[k * B + q]
                vx += N * velocity_acceleration[i, 0]
                vy += N * velocity_acceleration[i, 1]
                ax += N * velocity_acceleration[i, 2]
                ay += N * velocity_acceleration[i, 3]
            p = np.uint64(lo) + q
            values[p, 0] = vx
            values[p, 1] = vy
            values[p, 2] = ax
            values[p, 3] = ay


@kernel(nothing(Fill, i8, i8, F2, F3, F1, F1, f8, i8, i8, F2, F2), parallel=True)
def collect_all(fill, K, W, x, F, domain, origin, inv_dx, nx, ny, velocity_acceleration, values):
    """Write the sums of N velocity_acceleration to `values` (P,4)."""
    for c in prange((x.shape[0] + CHUNK - 1) // CHUNK):
        start = c * CHUNK
        end = min(x.shape[0], start + CHUNK)
        collect_chunk(fill, K, W, start, end, x, F, domain, origin, inv_dx, nx, ny, velocity_acceleration, values)


@kernel(i8(Fill, i8, i8, i8, i8, F2, F3, F1, F1, f8, i8, i8, F2, F2, f8, f8, I1))
def advect_chunk(
    fill,
    K,
    W,
    start,
    end,
    x,
    F,
    domain,
    origin,
    inv_dx,
    nx,
    ny,
    velocity_acceleration,
    strain,
    dt,
    half,
    cell_crossings,
):
    """Advect the particles start ... end-1; return and count as transfer.g2p_chunk."""
    xs = x.reshape(-1)
    Fs = F.reshape(-1)
    table = np.empty(3 * K * BLOCK)
    node = np.empty(K * BLOCK, np.int64)
    before = np.zeros(2 * BLOCK)
    after = np.zeros(2 * BLOCK)
    dNx = np.uint64(K * BLOCK)
    dNy = np.uint64(2 * K * BLOCK)
    inverted = -1
    for lo in range(start, end, BLOCK):
        hi = min(lo + BLOCK, end)
        fill(
            xs[2 * lo : 2 * hi], Fs[4 * lo : 4 * hi], domain[W * lo : W * hi],
            origin[0], origin[1], inv_dx, nx, ny, 0.0, nx - 1.0, 0.0, ny - 1.0, table, node,
        )  # fmt: skip
        cells_of(xs[2 * lo : 2 * hi], origin[0], origin[1], inv_dx, before)
        for q in range(np.uint64(hi - lo)):
            p = np.uint64(lo) + q
            vx = vy = Lxx = Lxy = Lyx = Lyy = 0.0
            for k in range(np.uint64(K)):
                at = k * B + q
                i = np.uint64(node[at])
                vx += table[at] * velocity_acceleration[i, 0]
                vy += table[at] * velocity_acceleration[i, 1]
                Lxx += strain[i, 0] * table[at + dNx]
                Lxy += strain[i, 0] * table[at + dNy]
                Lyx += strain[i, 1] * table[at + dNx]
                Lyy += strain[i, 1] * table[at + dNy]
            x[p, 0] += dt * vx
            x[p, 1] += dt * vy
            deform(p, F, Lxx, Lxy, Lyx, Lyy, dt, half)
        cells_of(xs[2 * lo : 2 * hi], origin[0], origin[1], inv_dx, after)
        for b in range(hi - lo):
            cell_crossings[0] += int(before[b] != after[b]) + int(before[BLOCK + b] != after[BLOCK + b])
        if inverted < 0 and not invertible(Fs[4 * lo : 4 * hi]):
            inverted = lo
    return inverted


@kernel(nothing(Fill, i8, i8, F2, F3, F1, F1, f8, i8, i8, F2, F2, f8, f8, I1, I1), parallel=True)
def advect_all(
    fill, K, W, x, F, domain, origin, inv_dx, nx, ny, velocity_acceleration, strain, dt, half, inverted, cell_crossings
):
    """Advect all particles: x += dt sum N v, v of `velocity_acceleration`, and F by L = sum v dN, v of `strain`.

    `inverted` and `cell_crossings` as in transfer.g2p.
    """
    for c in prange(inverted.shape[0]):
        start = c * CHUNK
        end = min(x.shape[0], start + CHUNK)
        inverted[c] = advect_chunk(
            fill, K, W, start, end, x, F, domain, origin, inv_dx, nx, ny, velocity_acceleration, strain, dt, half,
            cell_crossings[c : c + 1],
        )  # fmt: skip


def spread(context: Context, values: Floats) -> Floats:
    """Momentum at the nodes, the first columns of (n,4), that particles with velocities `values` (P,2) give."""
    g, p, basis, out = context.grid, context.particles, context.basis, np.zeros_like(context.grid.momentum_force)
    spread_all(
        basis.fill, basis.support, basis.domain_size, context.slabs.start, p.x, p.F, p.m, np.ascontiguousarray(values),
        p.domain.ravel(), g.origin, 1.0 / g.dx, g.nx, g.ny, out,
    )  # fmt: skip
    return out


def collect(context: Context, velocity_acceleration: Floats) -> Floats:
    """Velocity and acceleration (P,4) of the grid where the particles are, from those at its nodes (n,4)."""
    g, p, basis, values = context.grid, context.particles, context.basis, np.empty((len(context.particles), 4))
    collect_all(
        basis.fill, basis.support, basis.domain_size, p.x, p.F, p.domain.ravel(), g.origin, 1.0 / g.dx, g.nx, g.ny,
        velocity_acceleration,
        values,
    )  # fmt: skip
    return values


def advect(context: Context, velocity_acceleration: Floats, strain: Floats, half: float) -> None:
    """Move x with the velocities `velocity_acceleration`, and F with the gradient of `strain`; both (n,4), one pass.

    `half`: see Scheme.half.
    """
    g, p, basis = context.grid, context.particles, context.basis
    advect_all(
        basis.fill, basis.support, basis.domain_size, p.x, p.F, p.domain.ravel(), g.origin, 1.0 / g.dx, g.nx, g.ny,
        velocity_acceleration,
        strain, context.dt, half, context.inverted, context.cell_crossings,
    )  # fmt: skip


def lumped(context: Context, momentum: Floats) -> Floats:
    """Momentum over mass, (n,2), zero at nodes of no mass; walls are not looked at."""
    mass = context.grid.mass[:, None]
    velocity: Floats = np.divide(momentum[:, :2], mass, out=np.zeros((len(mass), 2)), where=mass > context.cutoff)
    return velocity


def walled(context: Context, momentum: Floats, before: bool = False) -> Floats:
    """Momentum over mass as (n,4), with the walls' velocities at the end of the step, or before it."""
    g, velocity = context.grid, np.empty_like(momentum)
    held, value, rate = context.walls.in_strain()
    value = value - context.dt * rate if before else value
    solve(g.mass, momentum, velocity, held, value, rate, False, 0.0, context.cutoff, g.ny)
    return velocity
