"""Axes of the paper's rotated block: what a run of it is."""

from dataclasses import dataclass
from math import ceil, isqrt, pi
from typing import TYPE_CHECKING, ClassVar

from mpm_verify.cases.harness.identity import identity
from mpm_verify.cases.harness.study import RunRecord, axis
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, RATES, USUAL_RATE, available

if TYPE_CHECKING:
    from mpm_verify.solver.material.hypoelastic import Hypoelastic

OMEGA = pi / 2  # a quarter turn in a second
BLOCK, KINEMATIC = "block", "kinematic"  # a CPDI run, or rates along prescribed motions


@dataclass(frozen=True)
class Block(RunRecord):
    """Rotated block. E, nu are the paper's; the density, not given there, is that of its Table 1, g of its section 3.

    Raises ValueError for a number of cells or particles per cell that no block has.
    """

    L: float = axis(1.0, "Side of the block, m; the paper has a unit square.")
    E: float = axis(500e3, "Young's modulus, Pa.")
    nu: float = axis(0.3, "Poisson's ratio.")
    rho0: float = axis(2650.0, "Density, kg/m3.")
    g: float = axis(10.0, "Gravity, m/s2.")
    cells: int = axis(8, "Cells along a side of the block, from 4 on.")
    ppc: int = axis(4, "Particles per cell, square numbers.")
    courant: float = axis(0.4, "dt c / dx, c the compression wave.")
    rate: str = axis(USUAL_RATE, "Objective rate, or a negative control.")
    frame: bool = axis(False, "The box at rest, with the inertial forces of the turning box.")
    part: str = axis(BLOCK, "block: a CPDI run; kinematic: rates along prescribed motions.")
    case: ClassVar[str] = "objectivity"

    def __post_init__(self) -> None:
        if self.ppc < 1 or isqrt(self.ppc) ** 2 != self.ppc:
            raise ValueError(f"{self.ppc} particles per cell is not a square number; choose from 1, 4, 9, 16, ...")
        if not 4 <= self.cells <= 128:
            raise ValueError(f"{self.cells} cells along the block must be from 4 to 128: its walls are a cell thick")
        if self.rate not in (*available(RATES), *available(NEGATIVE_CONTROLS)):
            raise ValueError(f"no rate {self.rate!r}; choose from {', '.join(available(RATES))}")
        if self.part not in (BLOCK, KINEMATIC):
            raise ValueError(f"no part {self.part!r}; choose from {BLOCK}, {KINEMATIC}")
        if not min(self.L, self.E, self.rho0, self.g, self.courant) > 0 or not -1 < self.nu < 0.5:
            raise ValueError("L, E, rho0, g and courant must be above zero, and nu between -1 and 0.5")

    @property
    def computed_by(self) -> str:
        """Module that runs its part: what only steps on a grid need is no part of the name of the other."""
        return f"mpm_verify.cases.objectivity.{'execute' if self.part == BLOCK else 'prescribed'}"

    @property
    def material(self) -> "Hypoelastic":
        """Linear elastic material of the paper."""
        from mpm_verify.solver.material.hypoelastic import Hypoelastic

        return Hypoelastic(E=self.E, nu=self.nu, rho0=self.rho0, rate=self.rate)

    @property
    def steps(self) -> int:
        """Number of time steps in each second."""
        return ceil(self.material.wave_speed() / (self.courant * self.L / self.cells))

    @property
    def sigma_v(self) -> float:
        """Mean vertical stress at the end of the ramp, -rho0 g L / 2."""
        return -self.rho0 * self.g * self.L / 2

    @property
    def inertial_fraction(self) -> float:
        """Inertial fraction w^2 L / g."""
        return OMEGA**2 * self.L / self.g

    @property
    def particles(self) -> int:
        """Number of particles of the block."""
        return self.cells**2 * self.ppc

    @property
    def nodes(self) -> int:
        """Number of nodes of a grid that holds the block at every angle."""
        return (3 * self.cells // 2 + 3) ** 2

    @property
    def cost(self) -> float:
        """Particle updates, with the time that goes into each step of a small block."""
        return 2.0 * self.steps * (self.particles + 2000) if self.part == BLOCK else 1e7

    @property
    def digest(self) -> str:
        """Name of the Result, 16 hex digits; rates and negative controls count where they are used."""
        used = {RATES: [self.rate]} if self.rate in available(RATES) else {NEGATIVE_CONTROLS: [self.rate]}
        if self.part == KINEMATIC:
            used = {package: available(package) for package in (RATES, NEGATIVE_CONTROLS)}
        return self.named(" ".join(identity(package, name) for package, names in used.items() for name in names))

    def __str__(self) -> str:
        if self.part == KINEMATIC:
            return "rates along prescribed motions"
        return f"block of {self.L:g} m, {self.rate}{', box at rest' * self.frame}, {self.cells} cells"
