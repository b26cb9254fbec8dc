"""ColumnRun, ColumnResult and ColumnStudy, data for store and reports."""

from dataclasses import dataclass, replace
from math import inf, isqrt, sqrt
from typing import ClassVar, Literal, get_args

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, Study, axis
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, label, load, split

KINDS = ("local", "objective")
Start = Literal["none", "k0", "oedometric"]
Wall = Literal["roller", "fixed", "frictional"]
MOST = 1000  # cells: 4 GB of grid
STRIPS = 7  # of the width
AT_REST = 1e-4  # kinetic energy of the grid, of the potential energy at first: a run below it rests


@dataclass(frozen=True)
class ColumnRun(RunRecord):
    """One column; defaults are those of the paper's Table 1, what it leaves open is said in cases/column/case.py.

    `method`, `material`, `transfer` and `smoothing` are specifications, smoothing may be "none"; `cells` of the
    width; `damping`: its alpha; `courant`: dt c/dx, c the compression wave; `duration` and `gate` (speed at which
    the gate is lifted, inf: gone at once) in SI units; `start`: initial stress; `floor`, and `left`, the wall at x = 0;
    `mu`: see solver/friction.py; `stops`: see solver.boundary.Walls; `offset` shifts the particles in their cells, by
    fractions of their spacing; `mirror`
    puts the wall to the right. What keeps the column alive: `limit` of the half diagonals of CPDI domains, in cells
    (inf: none; never below what a particle begins with), `void`-strain memory of materials that have one and part
    free of stress, and the exponential `deformation`. `pooling`: solver/pooling.py.
    Raises ValueError with one line for what no column has.
    """

    method: str = axis("cpdi", "Basis of the method.", METHODS)
    cells: int = axis(14, "Cells of the column's width; the paper prints 135.")
    ppc: int = axis(9, "Particles per cell, square numbers.")
    material: str = axis("mohr_coulomb", "Constitutive model in rate form.", MATERIALS)
    damping: float = axis(0.0, "Fraction of the unbalanced force at each node, 0.05 for 5 %.")
    damping_kind: str = axis("local", "local (component by component) or objective.", choices=KINDS)
    smoothing: str = axis("none", "none, or smoothing of rates and stresses.", SMOOTHINGS)
    transfer: str = axis("flip", "Transfer between particles and grid.", TRANSFERS)
    pooling: bool = axis(False, "Pool void strain, compression and stress in cells; relieve crowded particles.")
    deformation: str = axis(
        "exponential", "Update of F: exponential, or linear as printed.", choices=("exponential", "linear")
    )
    limit: float = axis(0.5, "Longest half diagonal of a CPDI domain, in cells; inf for none.")
    void: bool = axis(True, "Void-strain memory of the constitutive model.")
    courant: float = axis(0.4, "dt c / dx, c the compression wave of the constitutive model.")
    duration: float = axis(1.4, "Seconds.")
    start: Start = axis("none", "Stress at first: none, k0 or oedometric.")
    floor: Wall = axis("fixed", "The floor: fixed (nothing slips), roller, or frictional.")
    left: Wall = axis("roller", "The wall: roller, fixed (nothing slips), or frictional.")
    mu: float = axis(0.47, "Friction coefficient of floor and wall where they are frictional.")
    gate: float = axis(inf, "Speed at which the gate is lifted, m/s; inf: gone at once.")
    stops: bool = axis(True, "Walls hand their reaction on to the particles.")
    offset: tuple[float, float] = axis((0.0, 0.0), "Shift of the particles, in fractions of their spacing.")
    mirror: bool = axis(False, "Wall to the right.")
    width: float = axis(0.0905, "Width of the column, m.")
    aspect: float = axis(7.0, "Height over width.")
    channel: float = axis(18.0, "Length of the channel, in widths.")
    g: float = axis(10.0, "Gravity, m/s2; the paper has 10.")
    case: ClassVar[str] = "column"

    def __post_init__(self) -> None:
        if self.ppc < 1 or isqrt(self.ppc) ** 2 != self.ppc:
            raise ValueError(f"{self.ppc} particles per cell is not a square number; choose from 1, 4, 9, 16, ...")
        if not 2 <= self.cells <= MOST:
            raise ValueError(
                f"cells = {self.cells} cannot be run; choose whole numbers from 2 to {MOST} over the width"
            )
        for name in ("courant", "duration", "width", "aspect", "g"):
            if not 0 < getattr(self, name) < inf:
                raise ValueError(f"{name} = {getattr(self, name)} must be above zero and finite")
        if not 0 <= self.mu < inf:
            raise ValueError(f"mu = {self.mu} must be zero or more, and finite; 0.47 is usual")
        for name in ("gate", "limit"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} = {getattr(self, name)} must be above zero, or inf")
        if abs(self.aspect * self.cells - round(self.aspect * self.cells)) > 1e-9:
            raise ValueError(f"aspect = {self.aspect} must make whole cells of the height: {self.cells} are the width")
        if not 2 <= self.channel <= 100:
            raise ValueError(f"channel = {self.channel} must be from 2 to 100 widths")
        if abs(self.channel * self.cells - round(self.channel * self.cells)) > 1e-9:
            raise ValueError(f"channel = {self.channel} must make whole cells: {self.cells} are the width")
        if self.g > 1e4:
            raise ValueError(f"g = {self.g} must be at most 1e4")
        walls = get_args(Wall)
        for name, words in (("start", get_args(Start)), ("floor", walls), ("left", walls), ("damping_kind", KINDS)):
            if getattr(self, name) not in words:
                raise ValueError(f"{name} = {getattr(self, name)!r} must be one of {', '.join(words)}")

    @property
    def height(self) -> float:
        """Initial height of the column."""
        return self.width * self.aspect

    @property
    def strip(self) -> float:
        """Width of the strips of a profile: a seventh of the column's, on any grid whose cells are no wider."""
        return self.width / min(STRIPS, self.cells)

    @property
    def tau(self) -> float:
        """Time sqrt(h0/g) that the collapse is counted in."""
        return sqrt(self.height / self.g)

    @property
    def cost(self) -> float:
        """Particle updates, roughly: what a run takes grows with it. What stiffens with s is stiffer, and slower."""
        stiff = 3.0 if load(MATERIALS, split(self.material)[0]).moduli else 1.0
        return 230.0 * stiff * self.aspect * self.ppc * self.cells**3 * self.duration / self.courant

    @property
    def particles(self) -> int:
        """Number of particles of the column."""
        return round(self.aspect * self.cells**2 * self.ppc)

    @property
    def nodes(self) -> int:
        """Number of nodes of the channel, with one column's width above the column."""
        return round((self.channel * self.cells + 1) * ((self.aspect + 1) * self.cells + 1))

    def __str__(self) -> str:
        parts = [label(self.method), f"cells={self.cells}", f"ppc={self.ppc}"]
        parts += [f"damping={self.damping:g}"] * bool(self.damping)
        parts += [f"smoothing={label(self.smoothing)}"] * (self.smoothing != "none")
        parts += ["pooled"] * self.pooling
        return ", ".join(parts)

    @property
    def digest(self) -> str:
        """Name of the Result, 16 hex digits. No damping is of no kind, and no friction of no coefficient."""
        same = self if self.damping else replace(self, damping_kind="local")
        return (same if "frictional" in (self.floor, self.left) else replace(same, mu=ColumnRun.mu)).named()


@dataclass(frozen=True, kw_only=True)
class ColumnResult(ResultRecord[ColumnRun]):
    """Outcome of a ColumnRun. `values`: final numbers, see cases/column/measure.py; curves are in the arrays."""

    run: ColumnRun


ColumnStudy = Study[ColumnRun]
