"""Run and Result of the MMS case, data for store, rule and reports."""

from dataclasses import dataclass, field
from math import inf, isqrt
from typing import ClassVar, get_args

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis
from mpm_verify.mms.blind_spots import BlindSpot
from mpm_verify.solver.plugins import LAYOUTS, MATERIALS, METHODS, SOLUTIONS, TRANSFERS, label
from mpm_verify.solver.stress_update import Stress

QUANTITIES = ("u", "v", "F", "sigma")
NORMS = ("rms", "max", "final", "printed")
AXES = {"cells": (8, 16, 32, 64, 128), "ppc": (1, 4, 9)}  # values that nobody asks for; of the rest the defaults
QUICK = {"cells": (8, 12, 16, 24, 32), "ppc": (4,)}


@dataclass(frozen=True)
class Run(RunRecord):
    """One frozen point of a sweep; its digest is its name.

    `method`, `solution`, `material`, `transfer` and `layout` are specifications: a name, or a name with parameters
    (`axis_aligned:A=0.01,phase=0.5`); `stress` is a word of solver/stress_update.py. `courant` is C dt / dx, with C the
    reference speed of the solution. `offset` shifts the particles in their cells, by fractions of their spacing, or, of
    a free body that is no square, the grid by fractions of a cell.
    Raises ValueError with one line for what no run has.
    """

    method: str = axis("cpdi", "Basis of the method.", METHODS)
    solution: str = axis("axis_aligned", "Manufactured solution, or a file of your own.", SOLUTIONS)
    material: str = axis("", "Constitutive model; usual is the solution's own.", MATERIALS)
    cells: int = axis(8, "Cells along a side of the domain.")
    ppc: int = axis(4, "Particles per cell, square numbers.")
    courant: float = axis(
        0.4,
        "C dt / dx, C the reference speed of the solution; with more, 0.4,0.2,0.1, the finest cells run with each, and "
        "the report has an axis of time.",
    )
    transfer: str = axis("flip", "Transfer between particles and grid.", TRANSFERS)
    stress: str = axis(
        "usl", "When stress is updated: usl, musl or usf (last, modified last, first).", choices=get_args(Stress)
    )
    staggered: bool = axis(True, "Start v half a step before x.")
    force: bool = axis(False, "Run time steps above the stability limit too.")
    offset: tuple[float, float] = axis((0.0, 0.0), "Shift of the particles, in fractions of their spacing.")
    layout: str = axis("uniform", "How particles are spread.", LAYOUTS)
    case: ClassVar[str] = "mms"

    def __post_init__(self) -> None:
        if not 2 <= self.cells <= 4096:
            raise ValueError(
                f"cells = {self.cells} cannot be run; choose whole numbers from 2 to 4096, such as 8,16,32,64"
            )
        if self.ppc < 1 or isqrt(self.ppc) ** 2 != self.ppc:
            raise ValueError(f"{self.ppc} particles per cell is not a square number; choose from 1, 4, 9, 16, ...")
        if not 1e-3 <= self.courant <= 10:
            raise ValueError(f"courant = {self.courant} cannot be run; choose 0.001 to 10, 0.4 is usual")

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
        return f"{label(self.method)} {self.cells}² cells, {self.ppc} per cell"


@dataclass(frozen=True)
class Packed:
    """Packing of the particles. `fewest` in a cell that the body filled, over the run, and such a cell.

    None where the body never filled one. `widest` is the largest side of a domain at first, in cells, and `steepest`
    the largest ratio of the volumes of two adjacent domains.
    """

    fewest: int | None
    cell: tuple[int, int] | None
    widest: float
    steepest: float


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    """Outcome of one Run: errors of every quantity in every norm, how particles were packed, and the blind spots."""

    run: Run
    packed: Packed | None = None  # see cases/mms/packing.py; None where nobody looked
    audit: tuple[BlindSpot, ...] = field(default=())  # what a study of the solution cannot see, and what it can

    def __post_init__(self) -> None:
        values = [self.errors.get(q, {}).get(n, inf) for q in QUANTITIES for n in NORMS]
        if self.status == "finished" and not all(0 <= value < inf for value in values):
            raise ValueError("a finished run has every error of every quantity, finite and not negative")
