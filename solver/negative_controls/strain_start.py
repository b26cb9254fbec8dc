"""Green-Naghdi with the strain increment in the frame of the step's start: R0^T D R0.

Only first order in time, and right where the body turns without strain or strains without turning.
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
        cd, sd = rotation_of(b, F0)
        turned_strain(b, de, F0, F1, cd, -sd)


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """Write R1 sigma R1^T to sigma."""
    for b in range(sigma.shape[0] // 4):
        c, s = rotation_of(b, F1)
        turn_stress(b, sigma, c, s)


class StrainStart(Rate):
    """Green-Naghdi rate with D turned by the rotation of the start."""

    order: ClassVar[float] = 1.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
