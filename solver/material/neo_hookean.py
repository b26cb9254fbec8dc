"""Compressible neo-Hookean solid: W = mu/2 (tr F^T F - 3) - mu ln J + lam/2 (ln J)^2, plane strain (F33 = 1).

P = mu (F - F^-T) + lam ln J F^-T, sigma = [mu (F F^T - I) + lam ln J I] / J (PHYSICS 9). The kernel is written by hand
from sigma; manufactured solutions differentiate `energy`, so the source term never comes from the code under test.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import prange

from solver._jit import F2, F3, f8, kernel, nothing
from solver.elastic import Elastic
from solver.state import Particles


@kernel(nothing(F3, F2, f8, f8), parallel=True)
def stress(F, sigma, lam, mu):
    """Cauchy stress (P,4) of F (P,2,2)."""
    for p in prange(F.shape[0]):
        xx, xy, yx, yy = F[p, 0, 0], F[p, 0, 1], F[p, 1, 0], F[p, 1, 1]
        J = xx * yy - xy * yx
        shear = mu / J
        bulk = (lam * np.log(J) - mu) / J
        sigma[p, 0] = shear * (xx * xx + xy * xy) + bulk
        sigma[p, 1] = shear * (yx * yx + yy * yy) + bulk
        sigma[p, 2] = shear + bulk
        sigma[p, 3] = shear * (xx * yx + xy * yy)


@dataclass(frozen=True)
class NeoHookean(Elastic):
    """Parameters E, nu, rho0 as in the paper's section 2.1."""

    def energy(self, F: Any, log: Callable[[Any], Any]) -> Any:
        """W per initial volume; F is 3 x 3, of numbers or symbols, `log` the logarithm for them."""
        determinant = (
            F[0][0] * (F[1][1] * F[2][2] - F[1][2] * F[2][1])
            - F[0][1] * (F[1][0] * F[2][2] - F[1][2] * F[2][0])
            + F[0][2] * (F[1][0] * F[2][1] - F[1][1] * F[2][0])
        )
        trace = sum(F[i][j] ** 2 for i in range(3) for j in range(3))
        return self.mu / 2 * (trace - 3) - self.mu * log(determinant) + self.lam / 2 * log(determinant) ** 2

    def update(self, particles: Particles, dt: float) -> None:
        """Write particles.sigma."""
        stress(particles.F, particles.sigma, self.lam, self.mu)
