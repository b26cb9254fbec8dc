"""Hughes-Winget with D added as it is: q sigma q^T + C : D dt.

The stress is brought to the end of the step and D is left in its middle: first order in time.
"""

from typing import ClassVar

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.frames import half_turn, step_gradient, turn_stress, turned_strain
from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate


@kernel(UNROTATE)
def unrotate(F0, F1, sigma, de):
    """Write q sigma q^T to sigma, and D dt to de."""
    for b in range(sigma.shape[0] // 4):
        _, Lxy, Lyx, _ = step_gradient(b, F0, F1)
        c, s = half_turn(0.5 * (Lyx - Lxy))
        turn_stress(b, sigma, c * c - s * s, 2.0 * c * s)
        turned_strain(b, de, F0, F1, 1.0, 0.0)


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """Do nothing: the stress is where the end of the step is."""


class StrainFixed(Rate):
    """Jaumann rate with D not turned."""

    order: ClassVar[float] = 1.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
