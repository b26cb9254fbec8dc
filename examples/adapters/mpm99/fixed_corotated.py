"""Fixed-corotated solid: W = mu |F - R|^2 + lam/2 (J - 1)^2, plane strain, R the rotation of F.

In the plane |F - R|^2 = F:F - 2 s + 2 with s = sqrt((Fxx + Fyy)^2 + (Fxy - Fyx)^2) the sum of the two stretches, and
sigma = (2 mu (F - R) F^T + lam J (J - 1) I) / J. Source: Stomakhin et al. 2012, doi:10.2312/SCA/SCA12/025-032.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from mpm_verify.solver.elastic import Elastic


@dataclass(frozen=True)
class FixedCorotated(Elastic):
    """Parameters E, nu, rho0."""

    formula: ClassVar[str] = "(2*mu*(F - R)*F^T + lam*J*(J - 1)*I)/J"

    def energy(self, F, log):
        """W per initial volume, of F (3 x 3) with F33 near 1; its derivatives give sigma_zz too."""
        J = F[2][2] * (F[0][0] * F[1][1] - F[0][1] * F[1][0])
        stretches = ((F[0][0] + F[1][1]) ** 2 + (F[0][1] - F[1][0]) ** 2) ** 0.5
        squares = sum(F[i][j] ** 2 for i in range(2) for j in range(2)) - 2 * stretches + 2 + (F[2][2] - 1) ** 2
        return self.mu * squares + self.lam / 2 * (J - 1) ** 2

    def update(self, particles, dt):
        """Write particles.sigma (P,4): xx, yy, zz, xy."""
        F, J = particles.F, np.linalg.det(particles.F)
        cosine, sine = F[:, 0, 0] + F[:, 1, 1], F[:, 1, 0] - F[:, 0, 1]
        R = np.stack([cosine, -sine, sine, cosine], axis=-1).reshape(-1, 2, 2) / np.hypot(cosine, sine)[:, None, None]
        tau = 2 * self.mu * np.einsum("pij,pkj->pik", F - R, F)
        pressure = self.lam * (J - 1)
        particles.sigma[:, 0] = tau[:, 0, 0] / J + pressure
        particles.sigma[:, 1] = tau[:, 1, 1] / J + pressure
        particles.sigma[:, 2] = pressure
        particles.sigma[:, 3] = tau[:, 0, 1] / J
