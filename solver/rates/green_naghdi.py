"""Green-Naghdi rate: the law works in the frame that turns with R of F = R U (Kamojjala & Brannon 2011).

The stress is unrotated by R at the start of the step, D by R in its middle, and the new stress is rotated by R at its
end. That is what the paper's section 2.2 means; what its formulas say is in solver/negative_controls. The frame is the
material's own, so a law may tell its axes apart. Second order in time, as all rates here (tests/test_rates.py).
"""

from typing import ClassVar

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.frames import rotation_between, rotation_of, turn_stress, turned_strain
from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate


@kernel(UNROTATE)
def unrotate(F0, F1, sigma, de):
    """sigma <- R0^T sigma R0; de = Rm^T (D dt) Rm."""
    for b in range(sigma.shape[0] // 4):
        c, s = rotation_of(b, F0)
        turn_stress(b, sigma, c, -s)
        cm, sm = rotation_between(b, F0, F1)
        turned_strain(b, de, F0, F1, cm, -sm)


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """sigma <- R1 sigma R1^T."""
    for b in range(sigma.shape[0] // 4):
        c, s = rotation_of(b, F1)
        turn_stress(b, sigma, c, s)


class GreenNaghdi(Rate):
    """Polar rotation."""

    order: ClassVar[float] = 2.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
