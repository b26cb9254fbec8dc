"""Words that the rates share: strain increment, rotation, other frames. Plane tensors as xx, yy, xy."""

import numpy as np

from solver._jit import kernel


@kernel(inline=True)
def step_gradient(b, F0, F1):
    """L dt of particle b in the middle of the step: xx, xy, yx, yy."""
    axx = 0.5 * (F0[4 * b] + F1[4 * b])
    axy = 0.5 * (F0[4 * b + 1] + F1[4 * b + 1])
    ayx = 0.5 * (F0[4 * b + 2] + F1[4 * b + 2])
    ayy = 0.5 * (F0[4 * b + 3] + F1[4 * b + 3])
    dxx = F1[4 * b] - F0[4 * b]
    dxy = F1[4 * b + 1] - F0[4 * b + 1]
    dyx = F1[4 * b + 2] - F0[4 * b + 2]
    dyy = F1[4 * b + 3] - F0[4 * b + 3]
    per = 1.0 / (axx * ayy - axy * ayx)
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
