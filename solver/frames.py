"""Helpers of the objective rates: strain increment, rotation, other frames. Plane tensors as xx, yy, xy."""

import numpy as np

from mpm_verify.solver._jit import kernel


@kernel(inline=True)
def step_gradient(b, F0, F1):
    """L dt of particle b in the middle of the step: xx, xy, yx, yy; not a number where the mean F is inverted."""
    axx = 0.5 * (F0[4 * b] + F1[4 * b])
    axy = 0.5 * (F0[4 * b + 1] + F1[4 * b + 1])
    ayx = 0.5 * (F0[4 * b + 2] + F1[4 * b + 2])
    ayy = 0.5 * (F0[4 * b + 3] + F1[4 * b + 3])
    dxx = F1[4 * b] - F0[4 * b]
    dxy = F1[4 * b + 1] - F0[4 * b + 1]
    dyx = F1[4 * b + 2] - F0[4 * b + 2]
    dyy = F1[4 * b + 3] - F0[4 * b + 3]
    det = axx * ayy - axy * ayx
    per = 1.0 / det if det > 0.0 else np.nan
    return (
        (dxx * ayy - dxy * ayx) * per,
        (dxy * axx - dxx * axy) * per,
        (dyx * ayy - dyy * ayx) * per,
        (dyy * axx - dyx * axy) * per,
    )


@kernel(inline=True)
def polar(xx, xy, yx, yy):
    """Cosine and sine of R in F = R U, for det F > 0: tan = (F_yx - F_xy) / (F_xx + F_yy)."""
    c = xx + yy
    s = yx - xy
    per = 1.0 / np.sqrt(c * c + s * s)
    return c * per, s * per


@kernel(inline=True)
def turned(xx, yy, xy, c, s):
    """R a R^T, R = [[c, -s], [s, c]]; with -s it is R^T a R."""
    cc = c * c
    ss = s * s
    cs = c * s
    return cc * xx + ss * yy - 2.0 * cs * xy, ss * xx + cc * yy + 2.0 * cs * xy, cs * (xx - yy) + (cc - ss) * xy


@kernel(inline=True)
def pushed(xx, yy, xy, axx, axy, ayx, ayy):
    """A a A^T for any A."""
    txx = axx * xx + axy * xy
    txy = axx * xy + axy * yy
    tyx = ayx * xx + ayy * xy
    tyy = ayx * xy + ayy * yy
    return txx * axx + txy * axy, tyx * ayx + tyy * ayy, txx * ayx + txy * ayy


@kernel(inline=True)
def turn_stress(b, sigma, c, s):
    """Turn the stress of particle b by (c, s), in place; zz stays."""
    xx, yy, xy = turned(sigma[4 * b], sigma[4 * b + 1], sigma[4 * b + 3], c, s)
    sigma[4 * b] = xx
    sigma[4 * b + 1] = yy
    sigma[4 * b + 3] = xy


@kernel(inline=True)
def push_stress(b, sigma, Axx, Axy, Ayx, Ayy, scale):
    """Push the stress of particle b by A and multiply it by `scale`, in place; zz is scaled alone."""
    xx, yy, xy = pushed(sigma[4 * b], sigma[4 * b + 1], sigma[4 * b + 3], Axx, Axy, Ayx, Ayy)
    sigma[4 * b] = scale * xx
    sigma[4 * b + 1] = scale * yy
    sigma[4 * b + 2] = scale * sigma[4 * b + 2]
    sigma[4 * b + 3] = scale * xy


@kernel(inline=True)
def turned_strain(b, de, F0, F1, c, s):
    """Write the strain increment of the middle of the step, turned by (c, s), of particle b to `de`."""
    Lxx, Lxy, Lyx, Lyy = step_gradient(b, F0, F1)
    xx, yy, xy = turned(Lxx, Lyy, 0.5 * (Lxy + Lyx), c, s)
    de[3 * b] = xx
    de[3 * b + 1] = yy
    de[3 * b + 2] = xy


@kernel(inline=True)
def half_turn(w):
    """Cosine and sine of half the rotation of a spin w: that of the Cayley map, by 2 atan(w/2), orthogonal exactly."""
    c = 1.0 / np.sqrt(1.0 + 0.25 * w * w)
    return c, 0.5 * w * c


@kernel(inline=True)
def rotation_of(b, F):
    """Cosine and sine of R of particle b."""
    return polar(F[4 * b], F[4 * b + 1], F[4 * b + 2], F[4 * b + 3])


@kernel(inline=True)
def rotation_between(b, F0, F1):
    """Cosine and sine of R of (F0 + F1)/2, the middle of the step."""
    xx, xy = F0[4 * b] + F1[4 * b], F0[4 * b + 1] + F1[4 * b + 1]
    yx, yy = F0[4 * b + 2] + F1[4 * b + 2], F0[4 * b + 3] + F1[4 * b + 3]
    return polar(xx, xy, yx, yy)


@kernel(inline=True)
def pulled_strain(b, de, F0, F1):
    """Write F0^T D F0 dt of particle b to `de`: some negative controls have F0 where R0 belongs."""
    Lxx, Lxy, Lyx, Lyy = step_gradient(b, F0, F1)
    xx, yy, xy = pushed(
        Lxx, Lyy, 0.5 * (Lxy + Lyx), F0[4 * b], F0[4 * b + 2], F0[4 * b + 1], F0[4 * b + 3]
    )  # fmt: skip
    de[3 * b] = xx
    de[3 * b + 1] = yy
    de[3 * b + 2] = xy
