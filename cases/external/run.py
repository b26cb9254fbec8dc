"""Run and Result of somebody else's solver on a manufactured solution, data for store, rule and reports."""

from dataclasses import dataclass, field
from math import isqrt
from typing import ClassVar

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis
from mpm_verify.mms.blind_spots import BlindSpot
from mpm_verify.solver.plugins import MATERIALS, METHODS, SOLUTIONS, available, label

QUANTITIES = ("u", "v", "F", "sigma")
NORMS = ("rms", "max", "final")
AXES = {"cells": (8, 16, 32, 64), "ppc": (4,)}
QUICK = {"cells": (8, 12, 16, 24, 32), "ppc": (4,)}
FRAMES = 16


@dataclass(frozen=True)
class Run(RunRecord):
    """One grid of a sweep that another program computes.

    `solver` is its command, in which {case} and {out} stand for folders, and `version` what tells one build of it from
    another. `method` is the method that it is judged as; with an `order` above zero that order is expected instead.
    Raises ValueError with one line for what no run has.
    """

    solver: str = axis("", "Command of the solver; {case} and {out} stand for the folders that it reads and writes.")
    version: str = axis("", "Version of the solver; usual is the hash of the program and of the files in its command.")
    method: str = axis("cpdi", "Method that it is judged as.", choices=tuple(available(METHODS)))
    order: float = axis(0.0, "Order that is expected of u; 0 is that of the method.")
    solution: str = axis("clamped_shear", "Manufactured solution, or a file of your own.", SOLUTIONS)
    material: str = axis("", "Constitutive model; usual is the solution's own.", MATERIALS)
    cells: int = axis(8, "Cells along a side of the domain.")
    ppc: int = axis(4, "Particles per cell, square numbers.")
    courant: float = axis(0.4, "C dt / dx, C the reference speed of the solution.")
    frames: int = axis(FRAMES, "Frames that the solver writes, spread over the run.")
    offset: tuple[float, float] = axis((0.0, 0.0), "Shift of the particles, in fractions of their spacing.")
    case: ClassVar[str] = "external"

    def __post_init__(self) -> None:
        if not 2 <= self.cells <= 4096:
            raise ValueError(
                f"cells = {self.cells} cannot be run; choose whole numbers from 2 to 4096, such as 8,16,32,64"
            )
        if self.ppc < 1 or isqrt(self.ppc) ** 2 != self.ppc:
            raise ValueError(f"{self.ppc} particles per cell is not a square number; choose from 1, 4, 9, 16, ...")
        if not 1e-3 <= self.courant <= 10:
            raise ValueError(f"courant = {self.courant} cannot be run; choose 0.001 to 10, 0.4 is usual")
        if not 0 <= self.order <= 10:
            raise ValueError(f"order = {self.order} cannot be expected; choose 0 to 10, 2 is usual")
        if not 1 <= self.frames <= 10_000:
            raise ValueError(f"frames = {self.frames} cannot be written; choose 1 to 10000, {FRAMES} is usual")

    @property
    def cost(self) -> float:
        """Particle updates, up to a factor."""
        return self.cells**3 * self.ppc / self.courant

    @property
    def updates(self) -> float:
        """Particle updates of a square over the usual duration."""
        return 2.0 * self.cost

    @property
    def particles(self) -> int:
        """Number of particles of a square."""
        return self.cells**2 * self.ppc

    @property
    def nodes(self) -> int:
        """Number of nodes of a square."""
        return (self.cells + 1) ** 2

    def __str__(self) -> str:
        return f"{self.solver.split()[0] if self.solver else ''} on {label(self.solution)} {self.cells}² cells"


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    """Outcome of one Run: errors of what the solver wrote, the last lines of its log, and the blind spots.

    `told` is the version that the solver's own result.json states.
    """

    run: Run
    log: tuple[str, ...] = field(default=())
    exit_code: int | None = None
    told: str = ""
    audit: tuple[BlindSpot, ...] = field(default=())
