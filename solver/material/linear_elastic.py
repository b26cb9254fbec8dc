"""Linear elasticity for small amplitudes: sigma = lam tr(e) I + 2 mu e, e = sym(F - I), plane strain.

The energy gives the first Piola stress P = sigma, and Cauchy stress and P differ by terms of order amplitude squared.
So this material is consistent with its energy to that order only: a study with it ends on a floor of the relative size
of the strain. Use it at amplitudes of 1e-4 and below.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from numba import prange

from mpm_verify.solver._jit import F2, F3, f8, kernel, nothing
from mpm_verify.solver.elastic import Elastic
from mpm_verify.solver.state import Particles


@kernel(nothing(F3, F2, f8, f8), parallel=True)
def stress(F, sigma, lam, mu):
    """Write the stress (P,4) of F (P,2,2)."""
    for p in prange(F.shape[0]):
        exx = F[p, 0, 0] - 1.0
        eyy = F[p, 1, 1] - 1.0
        bulk = lam * (exx + eyy)
        sigma[p, 0] = bulk + 2.0 * mu * exx
        sigma[p, 1] = bulk + 2.0 * mu * eyy
        sigma[p, 2] = bulk
        sigma[p, 3] = mu * (F[p, 0, 1] + F[p, 1, 0])


@dataclass(frozen=True)
class LinearElastic(Elastic):
    """Linear elastic solid for small amplitudes.

    Parameters
    ----------
    E, nu, rho0
        Young's modulus and density above zero, Poisson's ratio between -1 and 0.5.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    small_strain: ClassVar[bool] = True
    formula: ClassVar[str] = "P*F^T/J with P = lam*tr(e)*I + 2*mu*e and e = (F + F^T)/2 - I"

    def energy(self, F: Any, log: Callable[[Any], Any]) -> Any:
        """Energy W = lam/2 tr(e)^2 + mu e:e per initial volume; F is 3 x 3, of numbers or symbols."""
        e = [[(F[i][j] + F[j][i]) / 2 - int(i == j) for j in range(3)] for i in range(3)]
        trace = e[0][0] + e[1][1] + e[2][2]
        return self.lam / 2 * trace**2 + self.mu * sum(e[i][j] ** 2 for i in range(3) for j in range(3))

    def update(self, particles: Particles, dt: float) -> None:
        """Write particles.sigma (P,4)."""
        stress(particles.F, particles.sigma, self.lam, self.mu)
