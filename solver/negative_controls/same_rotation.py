"""One rotation at both ends of the step, that of its start: the "constant F_n" that the paper itself warns of.

The stress never turns with the body. It does not converge.
"""

from typing import ClassVar

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.frames import rotation_of, turn_stress, turned_strain
from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate


@kernel(UNROTATE)
def unrotate(F0, F1, sigma, de):
    """Write R0^T sigma R0 to sigma, and R0^T (D dt) R0 to de."""
    for b in range(sigma.shape[0] // 4):
        c, s = rotation_of(b, F0)
        turn_stress(b, sigma, c, -s)
        turned_strain(b, de, F0, F1, c, -s)


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """Write R0 sigma R0^T to sigma."""
    for b in range(sigma.shape[0] // 4):
        c, s = rotation_of(b, F0)
        turn_stress(b, sigma, c, s)


class SameRotation(Rate):
    """Rate with R of the start at both ends."""

    order: ClassVar[float] = 0.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
