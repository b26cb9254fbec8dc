"""The yardstick: each method as two loops fused by hand: weights in registers, no table, slabs or checks, one thread.

Compiled with the same flags as the solver. This is what the split into fills and transfers is measured against.
"""

import numpy as np

from mpm_verify.solver._jit import F1, F2, F3, f8, i8, kernel, nothing


@kernel(inline=True)
def give(i, N, gx, gy, px, py, bx, by, sxx, syy, sxy, mp, mass, given):
    momentum_x = given[i, 0] + N * px
    momentum_y = given[i, 1] + N * py
    force_x = given[i, 2] + (N * bx + (sxx * gx + sxy * gy))
    force_y = given[i, 3] + (N * by + (sxy * gx + syy * gy))
    mass[i] += N * mp
    given[i, 0] = momentum_x
    given[i, 1] = momentum_y
    given[i, 2] = force_x
    given[i, 3] = force_y


@kernel(inline=True)
def give_corner(x, y, w, gx, gy, ny, px, py, bx, by, sxx, syy, sxy, mp, mass, given):
    i = int(x)
    j = int(y)
    r = x - i
    a = y - j
    n = np.uint64(i * ny + j)
    up = np.uint64(1)
    right = np.uint64(ny)
    S = (1 - r) * (1 - a)
    give(n, w * S, gx * S, gy * S, px, py, bx, by, sxx, syy, sxy, mp, mass, given)
    S = (1 - r) * a
    give(n + up, w * S, gx * S, gy * S, px, py, bx, by, sxx, syy, sxy, mp, mass, given)
    S = r * (1 - a)
    give(n + right, w * S, gx * S, gy * S, px, py, bx, by, sxx, syy, sxy, mp, mass, given)
    S = r * a
    give(n + right + up, w * S, gx * S, gy * S, px, py, bx, by, sxx, syy, sxy, mp, mass, given)


@kernel(inline=True)
def take(i, N, gx, gy, A, motion):
    ux = motion[i, 0]
    uy = motion[i, 1]
    return (
        A[0] + N * ux, A[1] + N * uy, A[2] + N * motion[i, 2], A[3] + N * motion[i, 3],
        A[4] + ux * gx, A[5] + ux * gy, A[6] + uy * gx, A[7] + uy * gy,
    )  # fmt: skip


@kernel(inline=True)
def take_corner(x, y, w, gx, gy, ny, A, motion):
    i = int(x)
    j = int(y)
    r = x - i
    a = y - j
    n = np.uint64(i * ny + j)
    up = np.uint64(1)
    right = np.uint64(ny)
    S = (1 - r) * (1 - a)
    A = take(n, w * S, gx * S, gy * S, A, motion)
    S = (1 - r) * a
    A = take(n + up, w * S, gx * S, gy * S, A, motion)
    S = r * (1 - a)
    A = take(n + right, w * S, gx * S, gy * S, A, motion)
    S = r * a
    return take(n + right + up, w * S, gx * S, gy * S, A, motion)


@kernel(inline=True)
def move(p, A, x, v, F, sigma, dt, lam, mu):
    vx, vy, ax, ay, Lxx, Lxy, Lyx, Lyy = A
    x[p, 0] += dt * vx
    x[p, 1] += dt * vy
    v[p, 0] += dt * ax
    v[p, 1] += dt * ay
    a = F[p, 0, 0]
    b = F[p, 0, 1]
    c = F[p, 1, 0]
    d = F[p, 1, 1]
    xx = a + dt * (Lxx * a + Lxy * c)
    xy = b + dt * (Lxx * b + Lxy * d)
    yx = c + dt * (Lyx * a + Lyy * c)
    yy = d + dt * (Lyx * b + Lyy * d)
    F[p, 0, 0] = xx
    F[p, 0, 1] = xy
    F[p, 1, 0] = yx
    F[p, 1, 1] = yy
    J = xx * yy - xy * yx
    per_J = 1.0 / J
    shear = mu * per_J
    bulk = lam * per_J * np.log(J) - shear
    sigma[p, 0] = shear * (xx * xx + xy * xy) + bulk
    sigma[p, 1] = shear * (yx * yx + yy * yy) + bulk
    sigma[p, 2] = shear + bulk
    sigma[p, 3] = shear * (xx * yx + xy * yy)


@kernel(inline=True)
def grid(mass, given, motion, held, dt, cutoff):
    for i in range(mass.shape[0]):
        inverse = 1.0 / mass[i] if mass[i] > cutoff else 0.0
        for a in range(2):
            motion[i, a] = 0.0 if held[i, a] else inverse * (given[i, a] + dt * given[i, 2 + a])
            motion[i, 2 + a] = 0.0 if held[i, a] else inverse * given[i, 2 + a]


SIGNATURE = nothing(F2, F2, F3, F2, F1, F1, F2, F2, F1, f8, i8, F1, F2, F2, F2, f8, f8, f8, f8)


@kernel(SIGNATURE)
def cpdi(x, v, F, sigma, m, V0, b, domain, origin, inv_dx, ny, mass, given, motion, held, dt, cutoff, lam, mu):
    """One step of CPDI."""
    mass[:] = 0.0
    given[:] = 0.0
    for back in range(2):
        if back:
            grid(mass, given, motion, held, dt, cutoff)
        for p in range(np.uint64(x.shape[0])):
            r1x = F[p, 0, 0] * domain[p, 0] + F[p, 0, 1] * domain[p, 1]
            r1y = F[p, 1, 0] * domain[p, 0] + F[p, 1, 1] * domain[p, 1]
            r2x = F[p, 0, 0] * domain[p, 2] + F[p, 0, 1] * domain[p, 3]
            r2y = F[p, 1, 0] * domain[p, 2] + F[p, 1, 1] * domain[p, 3]
            per_area = 0.25 / (r1x * r2y - r1y * r2x)
            gx1 = (r1y - r2y) * per_area
            gy1 = (r2x - r1x) * per_area
            gx2 = (r1y + r2y) * per_area
            gy2 = -(r1x + r2x) * per_area
            X = (x[p, 0] - origin[0]) * inv_dx
            Y = (x[p, 1] - origin[1]) * inv_dx
            sx = (r1x + r2x) * inv_dx
            sy = (r1y + r2y) * inv_dx
            dx = (r1x - r2x) * inv_dx
            dy = (r1y - r2y) * inv_dx
            if back:
                A = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
                A = take_corner(X - sx, Y - sy, 0.25, gx1, gy1, ny, A, motion)
                A = take_corner(X + dx, Y + dy, 0.25, gx2, gy2, ny, A, motion)
                A = take_corner(X + sx, Y + sy, 0.25, -gx1, -gy1, ny, A, motion)
                A = take_corner(X - dx, Y - dy, 0.25, -gx2, -gy2, ny, A, motion)
                move(p, A, x, v, F, sigma, dt, lam, mu)
            else:
                mp = m[p]
                px = mp * v[p, 0]
                py = mp * v[p, 1]
                bx = mp * b[p, 0]
                by = mp * b[p, 1]
                V = V0[p] * (F[p, 0, 0] * F[p, 1, 1] - F[p, 0, 1] * F[p, 1, 0])
                sxx = -V * sigma[p, 0]
                syy = -V * sigma[p, 1]
                sxy = -V * sigma[p, 3]
                give_corner(X - sx, Y - sy, 0.25, gx1, gy1, ny, px, py, bx, by, sxx, syy, sxy, mp, mass, given)
                give_corner(X + dx, Y + dy, 0.25, gx2, gy2, ny, px, py, bx, by, sxx, syy, sxy, mp, mass, given)
                give_corner(X + sx, Y + sy, 0.25, -gx1, -gy1, ny, px, py, bx, by, sxx, syy, sxy, mp, mass, given)
                give_corner(X - dx, Y - dy, 0.25, -gx2, -gy2, ny, px, py, bx, by, sxx, syy, sxy, mp, mass, given)


@kernel(SIGNATURE)
def mpm(x, v, F, sigma, m, V0, b, domain, origin, inv_dx, ny, mass, given, motion, held, dt, cutoff, lam, mu):
    """One step of MPM."""
    mass[:] = 0.0
    given[:] = 0.0
    for back in range(2):
        if back:
            grid(mass, given, motion, held, dt, cutoff)
        for p in range(np.uint64(x.shape[0])):
            X = (x[p, 0] - origin[0]) * inv_dx
            Y = (x[p, 1] - origin[1]) * inv_dx
            i = int(X)
            j = int(Y)
            r = X - i
            a = Y - j
            q = 1 - r
            c = 1 - a
            n = np.uint64(i * ny + j)
            up = np.uint64(1)
            right = np.uint64(ny)
            gr = r * inv_dx
            ga = a * inv_dx
            gq = q * inv_dx
            gc = c * inv_dx
            if back:
                A = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
                A = take(n, q * c, -gc, -gq, A, motion)
                A = take(n + up, q * a, -ga, gq, A, motion)
                A = take(n + right, r * c, gc, -gr, A, motion)
                A = take(n + right + up, r * a, ga, gr, A, motion)
                move(p, A, x, v, F, sigma, dt, lam, mu)
            else:
                mp = m[p]
                px = mp * v[p, 0]
                py = mp * v[p, 1]
                bx = mp * b[p, 0]
                by = mp * b[p, 1]
                V = V0[p] * (F[p, 0, 0] * F[p, 1, 1] - F[p, 0, 1] * F[p, 1, 0])
                sxx = -V * sigma[p, 0]
                syy = -V * sigma[p, 1]
                sxy = -V * sigma[p, 3]
                give(n, q * c, -gc, -gq, px, py, bx, by, sxx, syy, sxy, mp, mass, given)
                give(n + up, q * a, -ga, gq, px, py, bx, by, sxx, syy, sxy, mp, mass, given)
                give(n + right, r * c, gc, -gr, px, py, bx, by, sxx, syy, sxy, mp, mass, given)
                give(n + right + up, r * a, ga, gr, px, py, bx, by, sxx, syy, sxy, mp, mass, given)
