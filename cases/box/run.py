"""Run and Result of the box of sand."""

from dataclasses import dataclass
from math import ceil, inf, isqrt
from typing import ClassVar

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, label

QUICK = {"duration": (1.0,)}  # the sand rests by then; on 4 cells the box fails
ROWS = 7  # in which stresses are summed, over the height of the column
LOW = round(ROWS * 2 / 3)  # rows with their middle below two thirds of the height


@dataclass(frozen=True)
class Run(RunRecord):
    """One box; lengths in m, seconds. Raises ValueError with one line for what no box has."""

    method: str = axis("cpdi", "Basis of the method.", METHODS)
    material: str = axis("mohr_coulomb:psi=0", "Constitutive model in rate form.", MATERIALS)
    cells: int = axis(7, "Cells of the width.")
    ppc: int = axis(9, "Particles per cell, square numbers.")
    transfer: str = axis("flip", "Transfer between particles and grid.", TRANSFERS)
    smoothing: str = axis("none", "none, or smoothing of rates and stresses.", SMOOTHINGS)
    pooling: bool = axis(True, "Pool void strain, compression and stress in cells; relieve crowded particles.")
    damping: float = axis(0.05, "Fraction of the unbalanced force at each node.")
    drop: float = axis(0.08, "Height of the fall, m.")
    jitter: float = axis(0.3, "Largest shift of a particle along each axis, in spacings.")
    seed: int = axis(1, "Seed of these shifts.")
    courant: float = axis(0.4, "dt c / dx, c the compression wave of the constitutive model.")
    duration: float = axis(2.0, "Seconds.")
    width: float = axis(0.0905, "Width of the box, m.")
    aspect: float = axis(3.0, "Height of the column over its width.")
    limit: float = axis(0.5, "Longest half diagonal of a CPDI domain, in cells; inf for none.")
    g: float = axis(10.0, "Gravity, m/s2.")
    control: bool = axis(False, "Failing control: nothing slips on the sides, so that they carry weight.")
    case: ClassVar[str] = "box"

    def __post_init__(self) -> None:
        if not 2 <= self.cells <= 500:
            raise ValueError(f"cells = {self.cells} cannot be run; choose whole numbers from 2 to 500 over the width")
        if self.ppc < 1 or isqrt(self.ppc) ** 2 != self.ppc:
            raise ValueError(f"{self.ppc} particles per cell is not a square number; choose from 1, 4, 9, 16, ...")
        for name in ("duration", "width", "aspect", "g", "limit"):
            value = getattr(self, name)
            if not value > 0 or (value == inf and name != "limit"):
                raise ValueError(f"{name} = {value} must be above zero" + " and finite" * (name != "limit"))
        if not 1e-3 <= self.courant <= 1:
            raise ValueError(f"courant = {self.courant} cannot be run; choose 0.001 to 1, 0.4 is usual")
        if not 0 <= self.drop <= 100 * self.width:
            raise ValueError(f"drop = {self.drop} must be from 0 to 100 widths of the box")
        if not 0 <= self.jitter < 0.5:
            raise ValueError(f"jitter = {self.jitter} must lie from 0 to below 0.5 spacings; 0.3 is usual")
        if self.seed < 0:
            raise ValueError(f"seed = {self.seed} must be zero or more")
        if abs(self.aspect * self.cells - round(self.aspect * self.cells)) > 1e-9:
            raise ValueError(f"aspect = {self.aspect} must make whole cells of the height: {self.cells} are the width")

    @property
    def dx(self) -> float:
        """Side of a cell."""
        return self.width / self.cells

    @property
    def height(self) -> float:
        """Height of the column."""
        return self.width * self.aspect

    @property
    def rows(self) -> int:
        """Cells of the height of the column."""
        return round(self.aspect * self.cells)

    @property
    def cells_above(self) -> int:
        """Cells above the floor that the grid has: the column, its fall, and room to bounce."""
        return self.rows + ceil(self.drop / self.dx) + max(3, self.rows // 4)

    @property
    def cost(self) -> float:
        """Particle updates, with the wave of the usual sand."""
        return 21.0 * self.particles * self.duration / (self.courant * self.dx)

    @property
    def particles(self) -> int:
        """Number of particles."""
        return self.rows * self.cells * self.ppc

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return (self.cells + 5) * (self.cells_above + 5)

    def __str__(self) -> str:
        told = f"{label(self.method)}, {self.cells} cells wide, {self.ppc} per cell"
        told += f", {label(self.smoothing)} smoothing" * (self.smoothing != "none")
        return told + ", not pooled" * (not self.pooling) + ", failing control" * self.control


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    """Outcome of a Run. `values`: numbers of the sand at rest, see cases/box/measure.py; curves are in the arrays."""

    run: Run
