"""Jaumann rate by Hughes & Winget (1980): the material works in a frame that turns with the spin W = skew grad v.

The step's rotation is q = (I - W/2)^-1 (I + W/2), W of the middle of the step, exactly orthogonal. Half of it before
the material and half after: so that sees stress and D in the middle of the step, which makes it second order. In large
simple shear its stress oscillates; that is the rate, not an error. The frame is no material one.
"""

from typing import ClassVar

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.frames import half_turn, step_gradient, turn_stress, turned_strain
from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate


@kernel(UNROTATE)
def unrotate(F0, F1, sigma, de):
    """Write q^1/2 sigma q^-1/2 to sigma, and D dt to de."""
    for b in range(sigma.shape[0] // 4):
        _, Lxy, Lyx, _ = step_gradient(b, F0, F1)
        c, s = half_turn(0.5 * (Lyx - Lxy))
        turn_stress(b, sigma, c, s)
        turned_strain(b, de, F0, F1, 1.0, 0.0)


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """Write q^1/2 sigma q^-1/2 to sigma."""
    for b in range(sigma.shape[0] // 4):
        _, Lxy, Lyx, _ = step_gradient(b, F0, F1)
        c, s = half_turn(0.5 * (Lyx - Lxy))
        turn_stress(b, sigma, c, s)


class Jaumann(Rate):
    """Jaumann rate, by the spin of the velocity gradient.

    References
    ----------
    Hughes & Winget 1980, doi:10.1002/nme.1620151210.
    """

    order: ClassVar[float] = 2.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
