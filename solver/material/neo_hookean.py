"""Compressible neo-Hookean solid: W = mu/2 (tr F^T F - 3) - mu ln J + lam/2 (ln J)^2, plane strain (F33 = 1).

P = mu (F - F^-T) + lam ln J F^-T, sigma = [mu (F F^T - I) + lam ln J I] / J. The kernel is written by hand
from sigma; manufactured solutions differentiate `energy`, so the source term never comes from the code under test.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numba import prange

from mpm_verify.solver._jit import BLOCK, F1, F2, F3, f8, kernel, nothing
from mpm_verify.solver.elastic import Elastic
from mpm_verify.solver.state import Particles


@kernel(nothing(F1, F1, f8, f8))
def stress_block(F, sigma, lam, mu):
    """Write the Cauchy stress of a block, flat; logarithms in a loop of their own, so that the other vectorises."""
    n = F.shape[0] // 4
    logJ = np.empty(BLOCK)
    for b in range(n):
        logJ[b] = np.log(F[4 * b] * F[4 * b + 3] - F[4 * b + 1] * F[4 * b + 2])
    for b in range(n):
        xx = F[4 * b]
        xy = F[4 * b + 1]
        yx = F[4 * b + 2]
        yy = F[4 * b + 3]
        per_J = 1.0 / (xx * yy - xy * yx)
        shear = mu * per_J
        bulk = lam * per_J * logJ[b] - shear
        sigma[4 * b] = shear * (xx * xx + xy * xy) + bulk
        sigma[4 * b + 1] = shear * (yx * yx + yy * yy) + bulk
        sigma[4 * b + 2] = shear + bulk
        sigma[4 * b + 3] = shear * (xx * yx + xy * yy)


@kernel(nothing(F3, F2, f8, f8), parallel=True)
def stress(F, sigma, lam, mu):
    """Write the Cauchy stress (P,4) of F (P,2,2)."""
    Fs = F.reshape(-1)
    sigmas = sigma.reshape(-1)
    for block in prange((F.shape[0] + BLOCK - 1) // BLOCK):
        lo = 4 * BLOCK * block
        hi = min(lo + 4 * BLOCK, Fs.shape[0])
        stress_block(Fs[lo:hi], sigmas[lo:hi], lam, mu)


@dataclass(frozen=True)
class NeoHookean(Elastic):
    """Compressible neo-Hookean solid; the defaults are those of the paper's section 2.1.

    Parameters
    ----------
    E, nu, rho0
        Young's modulus and density above zero, Poisson's ratio between -1 and 0.5.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    formula: ClassVar[str] = "(mu*(F*F^T - I) + lam*ln(J)*I)/J"

    def energy(self, F: Any, log: Callable[[Any], Any]) -> Any:
        """Energy W per initial volume; F is 3 x 3, of numbers or symbols, `log` the logarithm for them."""
        determinant = (
            F[0][0] * (F[1][1] * F[2][2] - F[1][2] * F[2][1])
            - F[0][1] * (F[1][0] * F[2][2] - F[1][2] * F[2][0])
            + F[0][2] * (F[1][0] * F[2][1] - F[1][1] * F[2][0])
        )
        trace = sum(F[i][j] ** 2 for i in range(3) for j in range(3))
        return self.mu / 2 * (trace - 3) - self.mu * log(determinant) + self.lam / 2 * log(determinant) ** 2

    def update(self, particles: Particles, dt: float) -> None:
        """Write particles.sigma (P,4)."""
        stress(particles.F, particles.sigma, self.lam, self.mu)
