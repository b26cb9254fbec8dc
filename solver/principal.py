"""Principal stresses of plane strain: two in the plane and zz, sorted, and the way back. Closed form, no trigonometry.

zz is a principal stress like the others and takes part in the sort: under plane strain it need not be the intermediate
one. Tension positive. Squares are taken as they are: stresses below 1e-150 or above 1e150 under- or overflow.
"""

import numpy as np

from mpm_verify.solver._jit import kernel


@kernel(inline=True)
def in_plane(xx, yy, xy):
    """Larger and smaller principal stress in the plane, and half their difference."""
    mean = 0.5 * (xx + yy)
    half = 0.5 * (xx - yy)
    radius = np.sqrt(half * half + xy * xy)
    return mean + radius, mean - radius, radius


@kernel(inline=True)
def in_order(up, down, zz):
    """Sorted, t1 >= t2 >= t3, for up >= down."""
    return max(up, zz), max(down, min(up, zz)), min(down, zz)


@kernel(inline=True)
def unsorted(s1, s2, s3, up, down, zz):
    """New principal stresses in the plane and zz, from sorted ones: what became of each of up, down, zz."""
    return (
        s2 if zz > up else s1,
        s2 if zz < down else s3,
        s1 if zz > up else (s3 if zz < down else s2),
    )


@kernel(inline=True)
def on_axes(up, down, xx, yy, xy, radius):
    """xx, yy, xy of new principal stresses on the axes of the old stress; for radius = 0 any axes serve, and up = down.

    The new stress need not keep its distance from isotropy, only its axes: they go back by a ratio of radii.
    """
    mean = 0.5 * (up + down)
    scale = 0.5 * (up - down) / radius if radius > 0.0 else 0.0
    half = 0.5 * (xx - yy) * scale
    return mean + half, mean - half, xy * scale


@kernel(inline=True)
def advance_elastic(lam, shear, sigma, de, plane):
    """Write the trial stress in place; to `plane` both principal stresses in the plane, larger first, and radius."""
    for b in range(sigma.shape[0] // 4):
        bulk = lam * (de[3 * b] + de[3 * b + 1])
        xx = sigma[4 * b] + (bulk + shear * de[3 * b])
        yy = sigma[4 * b + 1] + (bulk + shear * de[3 * b + 1])
        xy = sigma[4 * b + 3] + shear * de[3 * b + 2]
        sigma[4 * b] = xx
        sigma[4 * b + 1] = yy
        sigma[4 * b + 2] += bulk
        sigma[4 * b + 3] = xy
        plane[3 * b], plane[3 * b + 1], plane[3 * b + 2] = in_plane(xx, yy, xy)
