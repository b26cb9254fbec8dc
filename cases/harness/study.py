"""What is run and what is expected of it: Run, Result and Study, data that the store writes and the report reads."""

from dataclasses import dataclass, field
from math import inf
from typing import Literal

from mpm_verify.cases.harness.identity import digest
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.mms.blind_spots import BlindSpot
from mpm_verify.solver.plugins import LAYOUTS, MATERIALS, METHODS, SOLUTIONS, TRANSFERS, label

FORMAT = 1  # of study.json and of every Result; a reader refuses another number
QUANTITIES = ("u", "v", "F", "sigma")
NORMS = ("rms", "max", "final", "printed")
Status = Literal["finished", "failed"]
PLUGINS = {"method": METHODS, "solution": SOLUTIONS, "material": MATERIALS, "transfer": TRANSFERS, "layout": LAYOUTS}


@dataclass(frozen=True)
class Run:
    """One frozen point of a sweep; its digest is its name.

    `solution`, `material` and `transfer` are specifications: a name, or a name with parameters
    (`axis_aligned:A=0.01,phase=0.5`); `stress` is a word of solver/stress_update.py.
    `courant` is C dt / dx, with C the reference speed of the solution. `offset` shifts the particles in their cells, by
    shares of their spacing, or, of a body without walls, the grid by shares of a cell; `layout` is how they are spread.
    """

    method: str
    solution: str
    material: str
    cells: int
    ppc: int
    courant: float
    transfer: str = "flip"
    stress: str = "usl"
    staggered: bool = True
    force: bool = False
    case: str = "mms"
    offset: tuple[float, float] = (0.0, 0.0)
    layout: str = "uniform"

    def __post_init__(self) -> None:
        if self.cells < 1 or self.ppc < 1 or not 0 < self.courant < inf:
            raise ValueError(f"no run: cells = {self.cells}, ppc = {self.ppc}, courant = {self.courant}")

    @property
    def cost(self) -> float:
        """Particle updates, up to a factor: what a run takes grows with it."""
        return self.cells**3 * self.ppc / self.courant

    def __str__(self) -> str:
        return f"{label(self.method)} {self.cells}² cells, {self.ppc} per cell"

    @property
    def digest(self) -> str:
        """Name of the Result: hash of the parameters and of all that computes the run, 16 hex digits."""
        return digest(self, PLUGINS)


@dataclass(frozen=True)
class Failure:
    """Why a run could not go on: a result, not a crash. `particle` is its index in the initial layout, -1 if none."""

    reason: str
    step: int = 0
    particle: int = -1
    cell: tuple[int, int] | None = None

    def __str__(self) -> str:
        where = f", particle {self.particle}" if self.particle >= 0 else ""
        where += f" in cell {self.cell}" if self.cell else ""
        return f"{self.reason} at step {self.step}{where}"


@dataclass(frozen=True)
class Packed:
    """How well particles were packed. `fewest` in a cell that the body filled, over the run, and such a cell.

    None where the body never filled one. `widest` is the largest side of a domain at first, in cells, and `steepest`
    the largest ratio of the volumes of two neighbours.
    """

    fewest: int | None
    cell: tuple[int, int] | None
    widest: float
    steepest: float


@dataclass(frozen=True)
class Result:
    """What one Run gave. `errors[quantity][norm]`; all in the units of the problem."""

    run: Run
    digest: str
    status: Status
    errors: dict[str, dict[str, float]]
    steps: int
    particles: int
    dt: float
    wall_s: float
    peak_memory_mb: float
    scale: dict[str, float] = field(default_factory=dict)  # rms of the exact quantity, to make errors relative
    floor: dict[str, float] = field(default_factory=dict)  # round-off floor of the quantity
    failure: Failure | None = None
    environment: dict[str, str] = field(default_factory=dict)
    crossings: int = 0  # faces of cells that particles passed
    cpu_s: float = 0.0  # processor time of the steps, all threads, with body force and norms
    gap: float | None = None  # see cases.mms.gaps.Gaps; None for methods that know points only
    packed: Packed | None = None  # see cases.mms.packing.Packing; None where nobody looked
    audit: tuple[BlindSpot, ...] = ()  # what a study of the solution cannot see, and what it can
    parameters: dict[str, float] = field(default_factory=dict)  # of solution and material, the defaults too
    format: int = FORMAT

    def __post_init__(self) -> None:
        values = [self.errors.get(q, {}).get(n, inf) for q in QUANTITIES for n in NORMS]
        if self.status == "finished" and not all(0 <= value < inf for value in values):
            raise ValueError("a finished run has every error of every quantity, finite and not negative")

    @property
    def updates(self) -> int:
        """Particle updates: particles times steps."""
        return self.particles * self.steps


@dataclass(frozen=True)
class QuantityPlan:
    """A quantity the study judges, or only shows, with what is expected of it; declared before the study runs."""

    method: str
    solution: str
    ppc: int
    quantity: str
    norm: str
    judged: bool
    expectation: Expectation | None

    def __post_init__(self) -> None:
        if self.quantity not in QUANTITIES or self.norm not in NORMS:
            raise ValueError(f"no quantity {self.quantity!r} in norm {self.norm!r}")


@dataclass(frozen=True)
class Study:
    """The runs of one sweep and what is declared of them. `command` repeats it."""

    name: str
    title: str
    command: str
    runs: tuple[Run, ...]
    plans: tuple[QuantityPlan, ...]
    format: int = FORMAT
