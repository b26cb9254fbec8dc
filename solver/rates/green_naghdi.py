"""Green-Naghdi rate: the material works in the frame that turns with R of F = R U (Kamojjala & Brannon 2011).

The stress is unrotated by R at the start of the step, D by R in its middle, and the new stress is rotated by R at its
end. That is what the paper's section 2.2 means; what its formulas say is in solver/negative_controls. The frame is the
material's own, so it may tell its axes apart. Second order in time, as all rates here (tests/test_rates.py).
"""

from typing import ClassVar

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.frames import rotation_between, rotation_of, turn_stress, turned_strain
from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate


@kernel(UNROTATE)
def unrotate(F0, F1, sigma, de):
    """Write R0^T sigma R0 to sigma, and Rm^T (D dt) Rm to de."""
    for b in range(sigma.shape[0] // 4):
        c, s = rotation_of(b, F0)
        turn_stress(b, sigma, c, -s)
        cm, sm = rotation_between(b, F0, F1)
        turned_strain(b, de, F0, F1, cm, -sm)


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """Write R1 sigma R1^T to sigma."""
    for b in range(sigma.shape[0] // 4):
        c, s = rotation_of(b, F1)
        turn_stress(b, sigma, c, s)


class GreenNaghdi(Rate):
    """Green-Naghdi rate, by the polar rotation.

    References
    ----------
    Green & Naghdi 1965, doi:10.1007/BF00251666.
    """

    order: ClassVar[float] = 2.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
