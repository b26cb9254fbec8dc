"""Hencky solid: Kirchhoff stress tau = lam ln J I + 2 mu ln V, linear in the logarithmic strain; plane strain.

With d = ln(l1/l2), the difference of the principal logarithms in the plane, cosh d = tr C / 2J and

    W = lam/2 (ln det F)^2 + mu [(ln J)^2/2 + d^2/2 + (ln F33)^2]
    ln V = ln(J)/2 I + (d / sinh d) dev(F F^T) / 2J,   sigma = tau / J,   J and dev of the plane

Of d, arcosh of a number near 1, neither has more than what is analytic there: y = cosh d - 1 is a sum of squares over
2J, the energy has d^2 of it (log_spread.py), and the kernel, written by hand, d / sinh d by log1p or a series.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numba import prange

from mpm_verify.solver._jit import F2, F3, f8, kernel, nothing
from mpm_verify.solver.elastic import Elastic
from mpm_verify.solver.log_spread import written
from mpm_verify.solver.state import Particles

NEAR = 0.01  # y below which the series has d / sinh d; its first term left out is 3e-17


@kernel(inline=True)
def flatness(y):
    """Ratio d / sinh d for y = cosh d - 1: log1p(y + s) / s, s = sinh d; by its series near y = 0, where s is 0."""
    if y < NEAR:
        return 1.0 - y * (
            1.0 / 3.0 - y * (2.0 / 15.0 - y * (2.0 / 35.0 - y * (8.0 / 315.0 - y * (8.0 / 693.0 - y * 16.0 / 3003.0))))
        )
    s = np.sqrt(y * (y + 2.0))
    return np.log1p(y + s) / s


@kernel(nothing(F3, F2, f8, f8), parallel=True)
def stress(F, sigma, lam, mu):
    """Write the Cauchy stress (P,4) of F (P,2,2)."""
    for p in prange(F.shape[0]):
        xx, xy, yx, yy = F[p, 0, 0], F[p, 0, 1], F[p, 1, 0], F[p, 1, 1]
        J = xx * yy - xy * yx
        per_J = 1.0 / J
        volume = np.log(J) * per_J
        y = 0.5 * per_J * ((xx - yy) * (xx - yy) + (xy + yx) * (xy + yx))
        shear = mu * flatness(y) * per_J * per_J
        half = 0.5 * shear * (xx * xx + xy * xy - yx * yx - yy * yy)
        mean = (lam + mu) * volume
        sigma[p, 0] = mean + half
        sigma[p, 1] = mean - half
        sigma[p, 2] = lam * volume
        sigma[p, 3] = shear * (xx * yx + xy * yy)


def spread_squared(y: Any) -> Any:
    """Square d^2 for y = cosh d - 1: numbers, arrays, real or complex, or an expression of SymPy.

    Of an expression it is a function whose derivatives are known, which `sympy.expand_func` writes out.
    """
    if hasattr(y, "free_symbols"):
        from mpm_verify.solver.log_spread_symbol import SpreadSquared

        return SpreadSquared(y, 0)
    return written(y, 0)


def energy(lam: float, mu: float, F: Any, log: Callable[[Any], Any]) -> Any:
    """Energy W per initial volume; F is 3 x 3, of numbers or symbols, `log` the logarithm for them.

    Raises ValueError for an F that is not one of plane strain or with a stretch along z.
    """
    if any(np.any(np.real(c) != 0) for c in (F[0][2], F[1][2], F[2][0], F[2][1])):
        raise ValueError("hencky has an energy in the plane alone; in three dimensions take --material neo_hookean")
    J = F[0][0] * F[1][1] - F[0][1] * F[1][0]
    y = ((F[0][0] - F[1][1]) ** 2 + (F[0][1] + F[1][0]) ** 2) / (2 * J)
    squares = log(J) ** 2 / 2 + spread_squared(y) / 2 + log(F[2][2]) ** 2
    return lam / 2 * log(J * F[2][2]) ** 2 + mu * squares


@dataclass(frozen=True)
class Hencky(Elastic):
    """Hencky solid, a function of F.

    Parameters
    ----------
    E, nu, rho0
        Young's modulus and density above zero, Poisson's ratio between -1 and 0.5.

    Raises
    ------
    ValueError
        For a parameter that is out of range.

    References
    ----------
    Hencky 1928, Z. Tech. Phys. 9, 215; Anand 1979, doi:10.1115/1.3424532.
    """

    formula: ClassVar[str] = "(lam*ln(J)*I + mu*ln(F*F^T))/J, ln of the tensor"

    def energy(self, F: Any, log: Callable[[Any], Any]) -> Any:
        """Energy W per initial volume; F is 3 x 3, of numbers or symbols, `log` the logarithm for them."""
        return energy(self.lam, self.mu, F, log)

    def update(self, particles: Particles, dt: float) -> None:
        """Write particles.sigma (P,4)."""
        stress(particles.F, particles.sigma, self.lam, self.mu)
