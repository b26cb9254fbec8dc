"""F in place of R, with the transpose where it belongs: F0^T sigma F0, the material, then F1 sigma F1^T.

The sense of the rotation is right, and the stress is multiplied by the stretches squared, step after step: for small
strain nearly right, and it does not converge.
"""

from typing import ClassVar

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.frames import pulled_strain, push_stress
from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate


@kernel(UNROTATE)
def unrotate(F0, F1, sigma, de):
    """Write F0^T sigma F0 to sigma, and F0^T (D dt) F0 to de."""
    for b in range(sigma.shape[0] // 4):
        push_stress(b, sigma, F0[4 * b], F0[4 * b + 2], F0[4 * b + 1], F0[4 * b + 3], 1.0)
        pulled_strain(b, de, F0, F1)


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """Write F1 sigma F1^T to sigma."""
    for b in range(sigma.shape[0] // 4):
        push_stress(b, sigma, F1[4 * b], F1[4 * b + 1], F1[4 * b + 2], F1[4 * b + 3], 1.0)


class StretchedFrame(Rate):
    """Rate with F where R belongs."""

    order: ClassVar[float] = 0.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
