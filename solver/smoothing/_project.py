"""Projection of particle values onto constants of cells, or through nodes and back; weighted by volume.

    cell   each particle gets the mean of the particles whose centres share its cell: a projector, applied twice as once
    node   mean of each node by hat functions of the centres, and back: a filter, which changes linear fields a little

Both are adjoint to themselves in sum V a b, so smoothed stress on rates does the work of stress on smoothed rates.
Serial loops: one order of sums for any number of threads.
"""

import numpy as np

from mpm_verify.solver._jit import F1, F2, F3, f8, flag, i8, kernel, nothing


@kernel(nothing(F2, F1, F2, F1, f8, i8, i8, flag, F2))
def project(x, V, values, origin, inv_dx, nx, ny, nodes, out):
    """Write the projected values (P,C) of particles at x (P,2) with volumes V (P,) to `out` (P,C)."""
    count, columns = values.shape
    sums = np.zeros((nx * ny, columns))
    volume = np.zeros(nx * ny)
    reach = 2 if nodes else 1
    for way in range(2):
        for p in range(count):
            sx = (x[p, 0] - origin[0]) * inv_dx
            sy = (x[p, 1] - origin[1]) * inv_dx
            i = np.floor(sx)
            j = np.floor(sy)
            at = np.int64(i) * ny + np.int64(j)
            if way == 1:
                for c in range(columns):
                    out[p, c] = 0.0
            for right in range(reach):
                for up in range(reach):
                    weight = 1.0
                    if nodes:
                        weight = (sx - i if right else 1.0 - (sx - i)) * (sy - j if up else 1.0 - (sy - j))
                    k = at + right * ny + up
                    if way == 0:
                        volume[k] += weight * V[p]
                        for c in range(columns):
                            sums[k, c] += weight * V[p] * values[p, c]
                    elif volume[k] > 0.0:
                        for c in range(columns):
                            out[p, c] += weight * sums[k, c] / volume[k]


@kernel(nothing(F2, F3, F2))
def strains(F_old, F, out):
    """Write the strain increments of the middle of the step xx, yy, xy, and the spin, (P,4); F_old (P,4), F (P,2,2)."""
    for p in range(F.shape[0]):
        axx, axy = 0.5 * (F_old[p, 0] + F[p, 0, 0]), 0.5 * (F_old[p, 1] + F[p, 0, 1])
        ayx, ayy = 0.5 * (F_old[p, 2] + F[p, 1, 0]), 0.5 * (F_old[p, 3] + F[p, 1, 1])
        dxx, dxy = F[p, 0, 0] - F_old[p, 0], F[p, 0, 1] - F_old[p, 1]
        dyx, dyy = F[p, 1, 0] - F_old[p, 2], F[p, 1, 1] - F_old[p, 3]
        per = 1.0 / (axx * ayy - axy * ayx)
        xy = (dxy * axx - dxx * axy) * per
        yx = (dyx * ayy - dyy * ayx) * per
        out[p, 0] = (dxx * ayy - dxy * ayx) * per
        out[p, 1] = (dyy * axx - dyx * axy) * per
        out[p, 2] = 0.5 * (xy + yx)
        out[p, 3] = 0.5 * (xy - yx)


@kernel(nothing(F2, F2, F3))
def strained(F_old, increments, out):
    """Write the F (P,2,2) that strain increments and spins (P,4) make of F_old: (I - A/2)^-1 (I + A/2) F_old."""
    for p in range(out.shape[0]):
        xx, yy = 0.5 * increments[p, 0], 0.5 * increments[p, 1]
        xy, yx = 0.5 * (increments[p, 2] + increments[p, 3]), 0.5 * (increments[p, 2] - increments[p, 3])
        per = 1.0 / ((1.0 - xx) * (1.0 - yy) - xy * yx)
        cxx = per * ((1.0 - yy) * (1.0 + xx) + xy * yx)  # the Cayley transform of A
        cxy = per * 2.0 * xy
        cyx = per * 2.0 * yx
        cyy = per * ((1.0 - xx) * (1.0 + yy) + xy * yx)
        out[p, 0, 0] = cxx * F_old[p, 0] + cxy * F_old[p, 2]
        out[p, 0, 1] = cxx * F_old[p, 1] + cxy * F_old[p, 3]
        out[p, 1, 0] = cyx * F_old[p, 0] + cyy * F_old[p, 2]
        out[p, 1, 1] = cyx * F_old[p, 1] + cyy * F_old[p, 3]
