"""Run and Result of the wave bar."""

from dataclasses import dataclass
from math import isqrt
from typing import ClassVar

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis
from mpm_verify.solver.plugins import MATERIALS, METHODS, TRANSFERS

AXES = {"cells": (8, 16, 32, 64, 128), "ppc": (4,)}
QUICK = {"cells": (8, 12, 16, 24, 32), "ppc": (4,)}


@dataclass(frozen=True)
class Run(RunRecord):
    """One bar. Raises ValueError with one line for what no bar has."""

    method: str = axis("cpdi", "Basis of the method.", METHODS)
    material: str = axis("neo_hookean", "Constitutive model with a stress from F.", MATERIALS)
    cells: int = axis(16, "Cells along the bar.")
    ppc: int = axis(4, "Particles per cell, square numbers.")
    courant: float = axis(0.4, "c dt / dx, c the compression wave; with more, the finest cells run with each.")
    transfer: str = axis("flip", "Transfer between particles and grid.", TRANSFERS)
    amplitude: float = axis(1e-6, "Largest velocity at first, over that of the wave.")
    periods: float = axis(2.0, "Periods of the mode.")
    offset: tuple[float, float] = axis((0.0, 0.0), "Shift of the particles, in fractions of their spacing.")
    case: ClassVar[str] = "wave_bar"

    def __post_init__(self) -> None:
        if not 4 <= self.cells <= 4096:
            raise ValueError(
                f"cells = {self.cells} cannot be run; choose whole numbers from 4 to 4096, such as 8,16,32"
            )
        if self.ppc < 1 or isqrt(self.ppc) ** 2 != self.ppc:
            raise ValueError(f"{self.ppc} particles per cell is not a square number; choose from 1, 4, 9, 16, ...")
        if not 1e-3 <= self.courant <= 10:
            raise ValueError(f"courant = {self.courant} cannot be run; choose 0.001 to 10, 0.4 is usual")
        if not 0 < self.amplitude <= 0.1 or not 1 <= self.periods <= 1000:
            raise ValueError("choose an amplitude above 0 and at most 0.1, and periods from 1 to 1000")

    @property
    def cost(self) -> float:
        """Particle updates."""
        return self.particles * 2 * self.periods * self.cells / self.courant

    @property
    def particles(self) -> int:
        """Number of particles in four rows of cells."""
        return 4 * self.cells * self.ppc

    @property
    def nodes(self) -> int:
        """Number of nodes of four rows of cells."""
        return 5 * (self.cells + 1)

    def __str__(self) -> str:
        return f"{self.method} {self.cells} cells, {self.ppc} per cell"


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    """Outcome of one Run: the relative error of the frequency, and the frequency itself."""

    run: Run
