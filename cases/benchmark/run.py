"""Run and Result of a benchmark: a problem with a known answer, on one grid."""

from dataclasses import dataclass
from math import isqrt
from typing import Any, ClassVar

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis
from mpm_verify.solver.plugins import MATERIALS, METHODS, PROBLEMS, SMOOTHINGS, TRANSFERS, create, label


@dataclass(frozen=True)
class Run(RunRecord):
    """One problem on one grid. Raises ValueError with one line for what no problem has."""

    problem: str = axis("self_weight", "Problem.", PROBLEMS)
    method: str = axis("cpdi", "Basis of the method.", METHODS)
    material: str = axis("", "Constitutive model; usual is that of the problem.", MATERIALS)
    cells: int = axis(16, "Cells along the body, as the problem says.")
    ppc: int = axis(4, "Particles per cell, square numbers.")
    courant: float = axis(0.4, "c dt / dx, c the fastest wave; with more, the finest cells run with each.")
    transfer: str = axis("flip", "Transfer between particles and grid.", TRANSFERS)
    smoothing: str = axis("none", "Smoothing of strain and stress, or none.", SMOOTHINGS)
    offset: tuple[float, float] = axis((0.0, 0.0), "Shift of the particles, in fractions of their spacing.")
    control: bool = axis(False, "Failing control: the problem with a mistake in it, which must not pass.")
    case: ClassVar[str] = "benchmark"

    def __post_init__(self) -> None:
        if not 2 <= self.cells <= 4096:
            raise ValueError(
                f"cells = {self.cells} cannot be run; choose whole numbers from 2 to 4096, such as 8,16,32"
            )
        if self.ppc < 1 or isqrt(self.ppc) ** 2 != self.ppc:
            raise ValueError(f"{self.ppc} particles per cell is not a square number; choose from 1, 4, 9, 16, ...")
        if not all(-0.5 < one < 0.5 for one in self.offset):
            raise ValueError(f"offset = {self.offset} cannot be run; choose two above -0.5 and below 0.5, as 0.25,0.25")
        if not 1e-3 <= self.courant <= 1:
            raise ValueError(f"courant = {self.courant} cannot be run; choose 0.001 to 1, 0.4 is usual")

    @property
    def stated(self) -> Any:
        """Problem with its parameters, see cases/benchmark/problem.py."""
        return create(PROBLEMS, self.problem)

    @property
    def tied(self) -> bool:
        """Whether there is no time step that could be halved apart from the cells."""
        return bool(self.stated.tied)

    @property
    def particles(self) -> int:
        """Number of particles, about."""
        return int(self.stated.particles(self))

    @property
    def nodes(self) -> int:
        """Number of nodes, about."""
        return 2 * self.particles + 100

    @property
    def cost(self) -> float:
        """Particle updates, about."""
        return float(self.stated.updates(self))

    def __str__(self) -> str:
        told = f"{label(self.problem)}, {label(self.method)}, {self.cells} cells, {self.ppc} per cell"
        return told + ", failing control" * self.control


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    """Outcome of one Run: its errors, and the numbers that are held against what is known."""

    run: Run
