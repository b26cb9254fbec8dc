"""Jaumann rate by an explicit step: sigma + (W sigma - sigma W) dt + C : D dt.

First order in time, and the stress grows in a rotation without strain: its deviator by 2 (w dt)^2 a step.
"""

from typing import ClassVar

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.frames import step_gradient, turned_strain
from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate


@kernel(UNROTATE)
def unrotate(F0, F1, sigma, de):
    """Write sigma + (W sigma - sigma W) dt to sigma, and D dt to de."""
    for b in range(sigma.shape[0] // 4):
        _, Lxy, Lyx, _ = step_gradient(b, F0, F1)
        w = 0.5 * (Lyx - Lxy)
        xx, yy, xy = sigma[4 * b], sigma[4 * b + 1], sigma[4 * b + 3]
        sigma[4 * b] = xx - 2.0 * w * xy
        sigma[4 * b + 1] = yy + 2.0 * w * xy
        sigma[4 * b + 3] = xy + w * (xx - yy)
        turned_strain(b, de, F0, F1, 1.0, 0.0)


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """Do nothing: the stress is where the end of the step is."""


class ExplicitJaumann(Rate):
    """Jaumann rate whose spin acts by one explicit step."""

    order: ClassVar[float] = 1.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
