"""Run and Result of a benchmark of speed."""

from dataclasses import dataclass
from math import isqrt
from typing import ClassVar

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, available

AXES = {"method": tuple(available(METHODS))}
QUICK = AXES | {"cells": (32,), "pairs": (9,)}
STEPS = 10  # of one body before the next one's turn: the cache holds one of them


@dataclass(frozen=True)
class Run(RunRecord):
    """Speed of one method, over that of another. Raises ValueError with one line for what cannot be timed."""

    method: str = axis("cpdi", "Basis of the method.", METHODS)
    over: str = axis("mpm", "Basis of the method whose time is 1.", METHODS)
    material: str = axis("neo_hookean", "Constitutive model of both.", MATERIALS)
    transfer: str = axis("flip", "Transfer between particles and grid, of both.", TRANSFERS)
    smoothing: str = axis("none", "none, or smoothing of rates and stresses, of the method alone.", SMOOTHINGS)
    cells: int = axis(128, "Cells along a side of the square.")
    ppc: int = axis(4, "Particles per cell, square numbers.")
    pairs: int = axis(41, f"Turns of {STEPS} steps of each.")
    parallel: int = axis(2, "Threads that are held against one.")
    case: ClassVar[str] = "bench"

    def __post_init__(self) -> None:
        if not 4 <= self.cells <= 2000:
            raise ValueError(f"cells = {self.cells} cannot be timed; choose whole numbers from 4 to 2000, such as 128")
        if self.ppc < 1 or isqrt(self.ppc) ** 2 != self.ppc:
            raise ValueError(f"{self.ppc} particles per cell is not a square number; choose from 1, 4, 9, 16, ...")
        if not 3 <= self.pairs <= 10_000:
            raise ValueError(f"pairs = {self.pairs} must be from 3 to 10000; 41 are usual")
        if not 1 <= self.parallel <= 1024:
            raise ValueError(f"parallel = {self.parallel} must be from 1 to 1024 threads")

    @property
    def updates(self) -> float:
        """Particle updates. `cost` is that of a short run: several at once would time one another."""
        return 3.0 * STEPS * (self.pairs + 1) * self.particles

    @property
    def particles(self) -> int:
        """Number of particles of the three bodies."""
        return 3 * self.cells**2 * self.ppc

    @property
    def nodes(self) -> int:
        """Number of nodes of the three bodies."""
        return 3 * (self.cells + 5) ** 2

    def __str__(self) -> str:
        return f"{self.method} over {self.over}, {self.cells} cells, {self.ppc} per cell"


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    """Outcome of one Run: `values` are those of cases/bench/execute.py, `environment` has the processor."""

    run: Run
