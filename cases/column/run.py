"""What a run of the column is and gives: ColumnRun, ColumnResult and ColumnStudy, data for store and reports."""

from dataclasses import dataclass, field, replace
from math import inf, sqrt
from typing import Literal, get_args

from mpm_verify.cases.harness.identity import digest
from mpm_verify.cases.harness.study import FORMAT, Failure, Status
from mpm_verify.solver.layout import per_side
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, label

Start = Literal["none", "k0", "oedometric"]
Wall = Literal["roller", "fixed"]
MOST = 1000  # cells: 4 GB of grid
STRIPS = 7  # of the width
AT_REST = 1e-4  # kinetic energy of the grid, of the potential energy at first: a run below it rests
PLUGINS = {"method": METHODS, "law": MATERIALS, "transfer": TRANSFERS, "smoothing": SMOOTHINGS}


@dataclass(frozen=True)
class ColumnRun:
    """One column; defaults are those of the paper's Table 1, what it leaves open is said in cases/column/case.py.

    `method`, `law`, `transfer` and `smoothing` are specifications, smoothing may be "none"; `cells` of the width;
    `damping`: its alpha; `courant`: dt c/dx, c the law's compression wave; `duration` and `gate` (speed at which the
    gate is lifted, inf: gone at once) in SI units; `start`: initial stress; `left`: the wall at x = 0; `stops`: see
    solver.boundary.Walls; `offset` shifts the particles in their cells, by shares of their spacing; `mirror` puts the
    wall to the right. What keeps the column alive: `limit` of the half diagonals of CPDI domains, in cells (inf: none;
    never below what a particle begins with), `void`-strain memory of laws that have one and no cohesion, and the
    exponential `deformation`. Raises ValueError with one line for what no column has.
    """

    method: str = "cpdi"
    cells: int = 14
    ppc: int = 9
    law: str = "mohr_coulomb"
    damping: float = 0.0
    damping_kind: str = "local"
    smoothing: str = "none"
    transfer: str = "flip"
    deformation: str = "exponential"
    limit: float = 0.5
    void: bool = True
    courant: float = 0.4
    duration: float = 1.4
    start: Start = "none"
    left: Wall = "roller"
    gate: float = inf
    stops: bool = True
    offset: tuple[float, float] = (0.0, 0.0)
    mirror: bool = False
    width: float = 0.0905
    aspect: float = 7.0
    channel: float = 18.0
    g: float = 10.0
    case: str = "column"

    def __post_init__(self) -> None:
        per_side(self.ppc)
        if not 2 <= self.cells <= MOST:
            raise ValueError(f"cells = {self.cells} of the width must be 2 or more, and at most {MOST}")
        for name in ("courant", "duration", "gate", "limit", "width", "aspect", "g"):
            if not getattr(self, name) > 0 or (getattr(self, name) == inf and name not in ("gate", "limit")):
                raise ValueError(f"{name} = {getattr(self, name)} must be above zero and finite")
        if abs(self.aspect * self.cells - round(self.aspect * self.cells)) > 1e-9:
            raise ValueError(f"aspect = {self.aspect} must make whole cells of the height: {self.cells} are the width")
        if not 2 <= self.channel <= 100:
            raise ValueError(f"channel = {self.channel} must be from 2 to 100 widths")
        if abs(self.channel * self.cells - round(self.channel * self.cells)) > 1e-9:
            raise ValueError(f"channel = {self.channel} must make whole cells: {self.cells} are the width")
        if self.g > 1e4:
            raise ValueError(f"g = {self.g} must be at most 1e4")
        for name, value, words in (("start", self.start, Start), ("left", self.left, Wall)):
            if value not in get_args(words):
                raise ValueError(f"{name} = {value!r} must be one of {', '.join(get_args(words))}")

    @property
    def height(self) -> float:
        """Of the column at first."""
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
        """Particle updates, roughly: what a run takes grows with it. UBCSAND is stiffer, and slower."""
        stiff = 3.0 if self.law.startswith("ubcsand") else 1.0
        return 230.0 * stiff * self.aspect * self.ppc * self.cells**3 * self.duration / self.courant

    def __str__(self) -> str:
        parts = [f"{label(self.method)} {self.cells} cells wide, {self.ppc} per cell"]
        parts += [f"damping {self.damping:g}"] * bool(self.damping) + [label(self.smoothing)] * (
            self.smoothing != "none"
        )
        return ", ".join(parts)

    @property
    def digest(self) -> str:
        """Name of the Result: hash of the parameters and of all that computes the run. No damping is of no kind."""
        return digest(self if self.damping else replace(self, damping_kind="local"), PLUGINS)


@dataclass(frozen=True)
class ColumnResult:
    """What a ColumnRun gave. `values`: final numbers, see cases/column/measure.py; curves are in the arrays."""

    run: ColumnRun
    digest: str
    status: Status
    values: dict[str, float]
    steps: int
    particles: int
    dt: float
    wall_s: float
    cpu_s: float
    peak_memory_mb: float
    failure: Failure | None = None
    environment: dict[str, str] = field(default_factory=dict)
    parameters: dict[str, float | str] = field(default_factory=dict)  # of the law, the defaults too
    format: int = FORMAT

    @property
    def updates(self) -> int:
        """Particle updates: particles times steps."""
        return self.particles * self.steps


@dataclass(frozen=True)
class ColumnStudy:
    """The runs of a sweep; `axes`: names of the fields that it varies; `words`: what the study is for, by its file.

    `finish`: how many runs must come to rest, declared before any runs; a study of what fails asks for fewer.
    """

    name: str
    title: str
    command: str
    runs: tuple[ColumnRun, ...]
    axes: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    finish: int = 0
    case: str = "column"
    format: int = FORMAT
