"""Formulas of the paper's section 2.2 as they are printed: F0^T sigma F0, the material, then F1^T sigma F1.

With F = R U the first is U (R^T sigma R) U, a stress weighted by stretch, and the second turns by -R where R is
meant. It does not converge. D is treated alike, as the text says.
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
    """Write F1^T sigma F1 to sigma."""
    for b in range(sigma.shape[0] // 4):
        push_stress(b, sigma, F1[4 * b], F1[4 * b + 2], F1[4 * b + 1], F1[4 * b + 3], 1.0)


class Printed(Rate):
    """Rate with F transposed at both ends."""

    order: ClassVar[float] = 0.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
