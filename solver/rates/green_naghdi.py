"""Green-Naghdi rate: the law works in the frame that turns with R of F = R U (Kamojjala & Brannon 2011).

The stress is unrotated by R at the start of the step, D by R in its middle, and the new stress is rotated by R at its
end. That is what the paper's section 2.2 means; what its formulas say is in solver/misreadings. The frame is the
material's own, so a law may tell its axes apart. Second order in time. Source: K. Kamojjala and R. M. Brannon (2011);
measured orders in tests/test_rates.py.
"""

from typing import ClassVar

from solver._jit import kernel
from solver.frames import polar, step_gradient, turned
from solver.objective import ROTATE, UNROTATE, Rate


@kernel(UNROTATE)
def unrotate(F0, F1, sigma, de):
    """sigma <- R0^T sigma R0; de = Rm^T (D dt) Rm."""
    for b in range(sigma.shape[0] // 4):
        Lxx, Lxy, Lyx, Lyy = step_gradient(b, F0, F1)
        c, s = polar(F0[4 * b], F0[4 * b + 1], F0[4 * b + 2], F0[4 * b + 3])
        xx, yy, xy = turned(sigma[4 * b], sigma[4 * b + 1], sigma[4 * b + 3], c, -s)
        sigma[4 * b] = xx
        sigma[4 * b + 1] = yy
        sigma[4 * b + 3] = xy
        cm, sm = polar(
            F0[4 * b] + F1[4 * b], F0[4 * b + 1] + F1[4 * b + 1], F0[4 * b + 2] + F1[4 * b + 2],
            F0[4 * b + 3] + F1[4 * b + 3],
        )  # fmt: skip
        dxx, dyy, dxy = turned(Lxx, Lyy, 0.5 * (Lxy + Lyx), cm, -sm)
        de[3 * b] = dxx
        de[3 * b + 1] = dyy
        de[3 * b + 2] = dxy


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """sigma <- R1 sigma R1^T."""
    for b in range(sigma.shape[0] // 4):
        c, s = polar(F1[4 * b], F1[4 * b + 1], F1[4 * b + 2], F1[4 * b + 3])
        xx, yy, xy = turned(sigma[4 * b], sigma[4 * b + 1], sigma[4 * b + 3], c, s)
        sigma[4 * b] = xx
        sigma[4 * b + 1] = yy
        sigma[4 * b + 3] = xy


class GreenNaghdi(Rate):
    """Polar rotation."""

    order: ClassVar[float] = 2.0
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
