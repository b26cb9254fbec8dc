"""Logarithmic rate (Xiao, Bruhns & Meyers 1997): the one whose strain, integrated, is ln V of F = V R.

Its spin is W - f D12 in the plane, D12 the shear of D between the axes n1, n2 of B = F F^T, b1 and b2 its eigenvalues,
f = (1 + r)/(1 - r) + 2/ln r with r = b1/b2. With m and d the mean and half the difference of b1 and b2 and z = d/m this
is f = 1/atanh z - 1/z, and f D12 = [(z/atanh z - 1)/z^2] [Bxy (Dyy - Dxx) + (Bxx - Byy) Dxy] / (2 m): no axes needed,
and smooth where b1 = b2. All is that of the middle of the step; the rotation by the spin as in jaumann.py.
"""

from typing import ClassVar

import numpy as np

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.frames import half_turn, step_gradient, turn_stress, turned_strain
from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate


@kernel(inline=True)
def bend(z):
    """Factor (z/atanh z - 1)/z^2; by its series where the difference would lose digits."""
    zz = z * z
    if z < 0.05:
        return -1.0 / 3.0 - zz * (4.0 / 45.0 + zz * (44.0 / 945.0 + zz * (428.0 / 14175.0 + zz * (10196.0 / 467775.0))))
    return (2.0 * z / np.log((1.0 + z) / (1.0 - z)) - 1.0) / zz


@kernel(inline=True)
def spin(b, F0, F1):
    """Logarithmic spin of the step, an angle."""
    Lxx, Lxy, Lyx, Lyy = step_gradient(b, F0, F1)
    xx = F0[4 * b] + F1[4 * b]
    xy = F0[4 * b + 1] + F1[4 * b + 1]
    yx = F0[4 * b + 2] + F1[4 * b + 2]
    yy = F0[4 * b + 3] + F1[4 * b + 3]
    Bxx = xx * xx + xy * xy
    Byy = yx * yx + yy * yy
    Bxy = xx * yx + xy * yy
    mean = 0.5 * (Bxx + Byy)
    half = 0.5 * (Bxx - Byy)
    z = np.sqrt(half * half + Bxy * Bxy) / mean
    sheared = 0.5 * (Bxy * (Lyy - Lxx) + half * (Lxy + Lyx)) / mean
    return 0.5 * (Lyx - Lxy) - bend(z) * sheared


@kernel(UNROTATE)
def unrotate(F0, F1, sigma, de):
    """Turn sigma by half the step's rotation, and write D dt to de."""
    for b in range(sigma.shape[0] // 4):
        c, s = half_turn(spin(b, F0, F1))
        turn_stress(b, sigma, c, s)
        turned_strain(b, de, F0, F1, 1.0, 0.0)


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """Turn sigma by the other half."""
    for b in range(sigma.shape[0] // 4):
        c, s = half_turn(spin(b, F0, F1))
        turn_stress(b, sigma, c, s)


class Logarithmic(Rate):
    """Logarithmic rate, by its spin.

    References
    ----------
    Xiao, Bruhns & Meyers 1997, doi:10.1007/BF01213020.
    """

    order: ClassVar[float] = 2.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
