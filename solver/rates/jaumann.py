"""Jaumann rate by Hughes & Winget (1980): the law works in a frame that turns with the spin W = skew grad v.

The step's rotation is q = (I - W/2)^-1 (I + W/2), W of the middle of the step, exactly orthogonal. Half of it before
the law and half after: so the law sees stress and D in the middle of the step, which makes it second order. In large
simple shear its stress oscillates; that is the rate, not an error. The frame is no material one.
"""

from typing import ClassVar

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.frames import half_turn, step_gradient, turn_stress, turned_strain
from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate


@kernel(UNROTATE)
def unrotate(F0, F1, sigma, de):
    """sigma <- q^1/2 sigma q^-1/2; de = D dt."""
    for b in range(sigma.shape[0] // 4):
        _, Lxy, Lyx, _ = step_gradient(b, F0, F1)
        c, s = half_turn(0.5 * (Lyx - Lxy))
        turn_stress(b, sigma, c, s)
        turned_strain(b, de, F0, F1, 1.0, 0.0)


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """sigma <- q^1/2 sigma q^-1/2."""
    for b in range(sigma.shape[0] // 4):
        _, Lxy, Lyx, _ = step_gradient(b, F0, F1)
        c, s = half_turn(0.5 * (Lyx - Lxy))
        turn_stress(b, sigma, c, s)


class Jaumann(Rate):
    """Spin of the velocity gradient."""

    order: ClassVar[float] = 2.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
