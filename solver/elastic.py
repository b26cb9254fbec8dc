"""Elastic constants, validated once for every elastic material."""

from dataclasses import dataclass
from math import inf, sqrt

from mpm_verify.solver.material_model import Material
from mpm_verify.solver.state import Floats


@dataclass(frozen=True)
class Elastic(Material):
    """Isotropic elastic constants.

    The defaults are those of the paper's section 2.1, free of units: lengths in L, speeds in sqrt(E / rho0) / 100.

    Parameters
    ----------
    E
        Young's modulus, above zero.
    nu
        Poisson's ratio, between -1 and 0.5.
    rho0
        Density at reference, above zero.

    Raises
    ------
    ValueError
        For a constant that is out of range.
    """

    E: float = 1e4
    nu: float = 0.3
    rho0: float = 1.0

    def __post_init__(self) -> None:
        if not (0 < self.E < inf and 0 < self.rho0 < inf):
            raise ValueError(f"E = {self.E} and rho0 = {self.rho0} must be above zero and finite")
        if not -1 < self.nu < 0.5:
            raise ValueError(f"nu = {self.nu} must lie between -1 and 0.5")

    @property
    def mu(self) -> float:
        """Shear modulus."""
        return self.E / (2 * (1 + self.nu))

    @property
    def lam(self) -> float:
        """Lame's first constant."""
        return self.E * self.nu / ((1 + self.nu) * (1 - 2 * self.nu))

    def wave_speed(self, s: float | None = None) -> float:
        """Speed of the compression wave, sqrt((lam + 2 mu) / rho0), the same under any mean stress `s`."""
        return sqrt((self.lam + 2 * self.mu) / self.rho0)

    def stored_energy(self, sigma: Floats) -> Floats:
        """Energy per volume that linear elasticity stores.

        Parameters
        ----------
        sigma
            Cauchy stress xx, yy, zz, xy, (P,4).

        Returns
        -------
        ndarray
            Energy per volume (P,), in the unit of stress.
        """
        trace = sigma[:, :3].sum(axis=1)
        squares = (sigma[:, :3] ** 2).sum(axis=1) + 2 * sigma[:, 3] ** 2
        energy: Floats = (squares - self.nu / (1 + self.nu) * trace**2) / (4 * self.mu)
        return energy
