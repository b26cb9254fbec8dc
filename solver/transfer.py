"""Particles to grid and back. Reads the weights table and knows no basis; compiled once, called with any fill.

Particles are sorted into slabs of `slab_columns` grid columns. Slabs of one colour (even, then odd) are worked on at
the same time and never touch the same node: the box given to a fill is the slab and a guard of (slab_columns - 1) // 2
columns. So there are no atomics and no copies, and each node's sum has one order: the same bits for any number of
threads.

The parallel kernels are thin, and call one that is compiled apart: what stands inside a prange takes longer to compile.
"""

import numpy as np
from numba import prange

from mpm_verify.solver._jit import BLOCK, F1, F2, F3, I1, f8, flag, i8, kernel, nothing
from mpm_verify.solver.weights import Fill

B = np.uint64(BLOCK)  # unsigned indices: a signed one costs a comparison and a selection, for Python's x[-1]
CHUNK = 128 * BLOCK  # particles a thread takes at a time on the way back


@kernel(inline=True)
def scatter(K, lo, hi, v, F, sigma, m, V0, b, table, node, mass, momentum_force):
    """Add mass, momentum and force of particles lo ... hi-1 at their nodes: f_i = -V sigma dN_i + m b N_i, V = J V0."""
    dNx = np.uint64(K * BLOCK)
    dNy = np.uint64(2 * K * BLOCK)
    for q in range(np.uint64(hi - lo)):
        p = np.uint64(lo) + q
        mp = m[p]  # a local: read again after each store otherwise, since the compiler must fear that they overlap
        px = mp * v[p, 0]
        py = mp * v[p, 1]
        bx = mp * b[p, 0]
        by = mp * b[p, 1]
        V = V0[p] * (F[p, 0, 0] * F[p, 1, 1] - F[p, 0, 1] * F[p, 1, 0])
        sxx = -V * sigma[p, 0]
        syy = -V * sigma[p, 1]
        sxy = -V * sigma[p, 3]
        for k in range(np.uint64(K)):
            at = k * B + q
            i = np.uint64(node[at])
            N = table[at]
            gx = table[at + dNx]
            gy = table[at + dNy]
            momentum_x = momentum_force[i, 0] + N * px
            momentum_y = momentum_force[i, 1] + N * py
            force_x = momentum_force[i, 2] + (N * bx + (sxx * gx + sxy * gy))
            force_y = momentum_force[i, 3] + (N * by + (sxy * gx + syy * gy))
            mass[i] += N * mp
            momentum_force[i, 0] = momentum_x
            momentum_force[i, 1] = momentum_y
            momentum_force[i, 2] = force_x
            momentum_force[i, 3] = force_y


@kernel(i8(Fill, i8, i8, i8, i8, F2, F2, F3, F2, F1, F1, F2, F1, F1, f8, i8, i8, f8, f8, F1, F2))
def p2g_slab(
    fill, K, W, start, end, x, v, F, sigma, m, V0, b, domain, origin, inv_dx, nx, ny, left, right, mass, momentum_force
):  # fmt: skip
    """Scatter the particles start ... end-1; -1, or the first particle of the block that reaches out of the box."""
    xs = x.reshape(-1)
    Fs = F.reshape(-1)
    table = np.empty(3 * K * BLOCK)
    node = np.empty(K * BLOCK, np.int64)
    for lo in range(start, end, BLOCK):
        hi = min(lo + BLOCK, end)
        if not fill(
            xs[2 * lo : 2 * hi], Fs[4 * lo : 4 * hi], domain[W * lo : W * hi],
            origin[0], origin[1], inv_dx, nx, ny, left, right, 0.0, ny - 1.0, table, node,
        ):  # fmt: skip
            return lo
        scatter(K, lo, hi, v, F, sigma, m, V0, b, table, node, mass, momentum_force)
    return -1


@kernel(
    nothing(Fill, i8, i8, I1, i8, i8, i8, F2, F2, F3, F2, F1, F1, F2, F1, F1, f8, i8, i8, F1, F2, I1), parallel=True
)
def p2g(
    fill,
    K,
    W,
    start,
    slab_columns,
    first,
    last,
    x,
    v,
    F,
    sigma,
    m,
    V0,
    b,
    domain,
    origin,
    inv_dx,
    nx,
    ny,
    mass,
    momentum_force,
    strayed,
):
    """Sum mass (n,), momentum and force (n,4) of all particles at the nodes; `domain` is flat, W numbers a particle.

    `start` (S+1,) bounds the particles of each slab, `first` and `last` the nodes that they touch. `strayed` (S,) is
    -1, or the first particle of a block that reaches out of its slab's box; the sums are then not to be used.
    """
    slabs = start.shape[0] - 1
    mass[first:last] = 0.0
    momentum_force[first:last] = 0.0
    guard = (slab_columns - 1) // 2
    for colour in range(2):
        for pair in prange((slabs - colour + 1) // 2):
            s = 2 * pair + colour
            left = max(0.0, float(s * slab_columns - guard))
            right = min(nx - 1.0, float((s + 1) * slab_columns + guard))
            strayed[s] = p2g_slab(
                fill, K, W, start[s], start[s + 1], x, v, F, sigma, m, V0, b, domain, origin, inv_dx, nx, ny,
                left, right, mass, momentum_force,
            )  # fmt: skip


@kernel(inline=True)
def deform(p, F, Lxx, Lxy, Lyx, Lyy, dt, half):
    """Write F of particle p at the end of the step: F + dt L (F + half L F), see Scheme.half."""
    Fxx = F[p, 0, 0]
    Fxy = F[p, 0, 1]
    Fyx = F[p, 1, 0]
    Fyy = F[p, 1, 1]
    Gxx = Lxx * Fxx + Lxy * Fyx
    Gxy = Lxx * Fxy + Lxy * Fyy
    Gyx = Lyx * Fxx + Lyy * Fyx
    Gyy = Lyx * Fxy + Lyy * Fyy
    F[p, 0, 0] = Fxx + dt * (Gxx + half * (Lxx * Gxx + Lxy * Gyx))
    F[p, 0, 1] = Fxy + dt * (Gxy + half * (Lxx * Gxy + Lxy * Gyy))
    F[p, 1, 0] = Fyx + dt * (Gyx + half * (Lyx * Gxx + Lyy * Gyx))
    F[p, 1, 1] = Fyy + dt * (Gyy + half * (Lyx * Gxy + Lyy * Gyy))


@kernel(inline=True)
def gather(K, n, velocity_acceleration, table, node, taken):
    """Write twelve sums (n,12) over the support nodes: N, dN/dx and dN/dy times both velocities and accelerations.

    Nobody reads those of dN and accelerations; with them there are three times four equal lanes, and a quarter of the
    time is saved.
    """
    dNx = np.uint64(K * BLOCK)
    dNy = np.uint64(2 * K * BLOCK)
    for q in range(np.uint64(n)):
        vx = vy = ax = ay = 0.0
        Lxx = Lyx = Axx = Ayx = 0.0
        Lxy = Lyy = Axy = Ayy = 0.0
        for k in range(np.uint64(K)):
            at = k * B + q
            i = np.uint64(node[at])
            N = table[at]
            gx = table[at + dNx]
            gy = table[at + dNy]
            ux = velocity_acceleration[i, 0]
            uy = velocity_acceleration[i, 1]
            wx = velocity_acceleration[i, 2]
            wy = velocity_acceleration[i, 3]
            vx += N * ux
            vy += N * uy
            ax += N * wx
            ay += N * wy
            Lxx += gx * ux
            Lyx += gx * uy
            Axx += gx * wx
            Ayx += gx * wy
            Lxy += gy * ux
            Lyy += gy * uy
            Axy += gy * wx
            Ayy += gy * wy
        taken[q, 0] = vx
        taken[q, 1] = vy
        taken[q, 2] = ax
        taken[q, 3] = ay
        taken[q, 4] = Lxx
        taken[q, 5] = Lyx
        taken[q, 6] = Axx
        taken[q, 7] = Ayx
        taken[q, 8] = Lxy
        taken[q, 9] = Lyy
        taken[q, 10] = Axy
        taken[q, 11] = Ayy


@kernel(inline=True)
def take(lo, hi, x, v, F, taken, dt, half, flip):
    """Write velocity, position and F of particles lo ... hi-1 at the end of the step, from the sums of gather."""
    for q in range(np.uint64(hi - lo)):
        p = np.uint64(lo) + q
        vx = taken[q, 0]
        vy = taken[q, 1]
        ax = taken[q, 2]
        ay = taken[q, 3]
        Lxx = taken[q, 4]
        Lxy = taken[q, 8]
        Lyx = taken[q, 5]
        Lyy = taken[q, 9]
        x[p, 0] += dt * vx
        x[p, 1] += dt * vy
        v[p, 0] = flip * (v[p, 0] + dt * ax) + (1.0 - flip) * vx
        v[p, 1] = flip * (v[p, 1] + dt * ay) + (1.0 - flip) * vy
        deform(p, F, Lxx, Lxy, Lyx, Lyy, dt, half)


@kernel(flag(F1))
def invertible(F):
    """Whether 0 < det F < infinity for a block of particles, flat; in a loop of its own: in gather it costs a fifth."""
    bad = 0
    for b in range(F.shape[0] // 4):
        J = F[4 * b] * F[4 * b + 3] - F[4 * b + 1] * F[4 * b + 2]
        bad += int(not (J > 0.0)) + int(not (J < np.inf))
    return bad == 0


@kernel(inline=True)
def cells_of(x, ox, oy, inv_dx, cells):
    """Write the cell numbers of a block, x flat: columns, then rows."""
    for b in range(x.shape[0] // 2):
        cells[b] = np.floor((x[2 * b] - ox) * inv_dx)
        cells[BLOCK + b] = np.floor((x[2 * b + 1] - oy) * inv_dx)


@kernel(i8(Fill, i8, i8, i8, i8, F2, F2, F3, F1, F1, f8, i8, i8, F2, f8, f8, f8, I1))
def g2p_chunk(
    fill,
    K,
    W,
    start,
    end,
    x,
    v,
    F,
    domain,
    origin,
    inv_dx,
    nx,
    ny,
    velocity_acceleration,
    dt,
    half,
    flip,
    cell_crossings,
):
    """Gather the particles start ... end-1; -1, or the first particle of the first block in which one is inverted.

    Adds to `cell_crossings` (1,) the faces of cells that they passed.
    """
    xs = x.reshape(-1)
    Fs = F.reshape(-1)
    table = np.empty(3 * K * BLOCK)
    node = np.empty(K * BLOCK, np.int64)
    taken = np.empty((BLOCK, 12))
    before = np.zeros(2 * BLOCK)
    after = np.zeros(2 * BLOCK)
    inverted = -1
    for lo in range(start, end, BLOCK):
        hi = min(lo + BLOCK, end)
        fill(
            xs[2 * lo : 2 * hi], Fs[4 * lo : 4 * hi], domain[W * lo : W * hi],
            origin[0], origin[1], inv_dx, nx, ny, 0.0, nx - 1.0, 0.0, ny - 1.0, table, node,
        )  # fmt: skip
        cells_of(xs[2 * lo : 2 * hi], origin[0], origin[1], inv_dx, before)
        gather(K, hi - lo, velocity_acceleration, table, node, taken)
        take(lo, hi, x, v, F, taken, dt, half, flip)
        cells_of(xs[2 * lo : 2 * hi], origin[0], origin[1], inv_dx, after)
        passed = 0
        for b in range(hi - lo):  # beyond, in the last block, are the cells of the block before
            passed += int(before[b] != after[b]) + int(before[BLOCK + b] != after[BLOCK + b])
        cell_crossings[0] += passed
        if inverted < 0 and not invertible(Fs[4 * lo : 4 * hi]):
            inverted = lo
    return inverted


@kernel(nothing(Fill, i8, i8, F2, F2, F3, F1, F1, f8, i8, i8, F2, f8, f8, f8, I1, I1), parallel=True)
def g2p(
    fill, K, W, x, v, F, domain, origin, inv_dx, nx, ny, velocity_acceleration, dt, half, flip, inverted, cell_crossings
):
    """Write velocity, a fraction `flip` of FLIP and the rest PIC, position and F of all particles.

    `inverted` (chunks,) is -1, or the first particle of a block in which one is inverted; `cell_crossings` (chunks,)
    counts on: the faces of cells that particles passed.
    """
    for c in prange(inverted.shape[0]):
        start = c * CHUNK
        end = min(x.shape[0], start + CHUNK)
        inverted[c] = g2p_chunk(
            fill, K, W, start, end, x, v, F, domain, origin, inv_dx, nx, ny, velocity_acceleration, dt, half, flip,
            cell_crossings[c : c + 1],
        )  # fmt: skip
