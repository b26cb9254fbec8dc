"""Run and Result of the MMS case, data for store, rule and reports."""

from dataclasses import dataclass, field
from math import inf, isqrt, sqrt
from typing import Any, ClassVar, get_args

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis
from mpm_verify.mms.blind_spots import BlindSpot, BlindSpotCode
from mpm_verify.mms.duration import quarters
from mpm_verify.solver.plugins import (
    LAYOUTS,
    MATERIALS,
    METHODS,
    SMOOTHINGS,
    SOLUTIONS,
    TRANSFERS,
    available,
    create,
    is_file,
    label,
    load,
    optional,
    split,
)
from mpm_verify.solver.stress_update import Stress

QUANTITIES = ("u", "v", "F", "sigma")
NORMS = ("rms", "max", "final", "printed")
STARTS = tuple(f"{v}.{F}.{b}" for v in ("half", "zero") for F in ("now", "before") for b in ("start", "end"))
PRECISIONS = ("double", "single")
PATHS = ("h", "h2", "printed")  # of dt as cells get finer
BEGIN = 8  # cells at which the first two have the same C dt / dx
STRAIGHT = ("axis_aligned", "bar")  # solutions whose F is diagonal:
TURNING = ("green_naghdi", "jaumann")  # rates that are the logarithmic one there
INSIDE = ("none", "damping")  # what can be put into the problem
AXES = {"cells": (8, 16, 32, 64, 128), "ppc": (1, 4, 9)}  # values that nobody asks for; of the rest the defaults
QUICK: dict[str, tuple[Any, ...]] = {
    "solution": ("axis_aligned", "clamped_shear"), "cells": (8, 12, 16, 24, 32), "ppc": (4,)
}  # fmt: skip
SOLID = {"cells": (4, 6, 8, 12, 16), "ppc": (8,)}  # of a solution in three dimensions, whatever else
LINE = {"cells": (16, 32, 64, 128), "ppc": (2,)}  # of one in one dimension


def strays_on(material: Any, solution: str) -> bool:
    """Whether the rate of a material, None of one that is not known, makes it another solid on a solution."""
    straight = split(solution)[0] in STRAIGHT and getattr(material, "rate", "") in TURNING
    return bool(getattr(material, "strays", False)) and not straight


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
    ppc: int = axis(4, "Particles per cell, square numbers; of solutions in three dimensions cube numbers, in one any.")
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
    solver: str = axis(
        "", "Solver of your own: a command such as './mine {case} {out}', see docs/own-solver.md.", whole=True
    )
    solver_version: str = axis("", "Version of that solver; usual is a hash of the files that its command names.")
    columns: str = axis("", "Map of the columns that it writes, a TOML file; see docs/own-solver.md.", whole=True)
    order: float = axis(0.0, "Order expected of u; 0: what is registered of the method.", named=False)
    dim: int = axis(
        2,
        "Dimensions of the case for a solver of your own: with 3 a plane-strain solution is one cell thick; usual is "
        "the solution's own.",
    )
    start: str = axis("", "Time levels that it is given by force, see docs/own-solver.md; or all.", choices=STARTS)
    precision: str = axis("double", "Precision that it computes with: double, single.", choices=PRECISIONS)
    time_step: str = axis(
        "h",
        "Path of dt as cells get finer: h; h2, with C dt / dx that of --courant times 8 / cells; or printed, as in the "
        "paper, --courant times sqrt(dx / C) in units of the solution, which only --force runs.",
        choices=PATHS,
    )
    periods: float = axis(0.0, "Periods of the solution that a run lasts; 0: the duration that it states, mostly one.")
    damping: float = axis(0.0, "Local damping, the fraction of the unbalanced force at each node: 0.05 for 5 %.")
    manufacture: str = axis(
        "none", "Put into the problem, so that the motion stays the exact one: none, damping.", choices=INSIDE
    )
    smoothing: str = axis("none", "none, or smoothing of the stress of the internal force.", SMOOTHINGS)
    time_limit: float = axis(600.0, "Seconds that a run of a solver of your own may take.", named=False)
    memory_limit: float = axis(0.0, "Address space that it may have, MB; 0: any.", named=False)
    case: ClassVar[str] = "mms"

    def __post_init__(self) -> None:
        if not 2 <= self.cells <= 4096:
            raise ValueError(
                f"cells = {self.cells} cannot be run; choose whole numbers from 2 to 4096, such as 8,16,32,64"
            )
        if self.dim not in (1, 2, 3):
            raise ValueError(f"dim = {self.dim} must be 2, plane strain or axisymmetric, or 1, uniaxial strain, or 3")
        if self.dim == 2 and (self.ppc < 1 or isqrt(self.ppc) ** 2 != self.ppc):
            raise ValueError(f"{self.ppc} particles per cell is not a square number; choose from 1, 4, 9, 16, ...")
        if not 1e-3 <= self.courant <= 10:
            raise ValueError(f"courant = {self.courant} cannot be run; choose 0.001 to 10, 0.4 is usual")

        if self.start and self.start not in STARTS:
            raise ValueError(f"start = {self.start!r} must be one of {', '.join(STARTS)}")
        if self.precision not in PRECISIONS:
            raise ValueError(f"precision = {self.precision!r} must be one of {', '.join(PRECISIONS)}")
        if self.time_step not in PATHS:
            raise ValueError(f"time_step = {self.time_step!r} must be one of {', '.join(PATHS)}")
        if not 0 <= self.periods <= 100:
            raise ValueError(f"periods = {self.periods} cannot be run; choose 0.01 to 100, or leave it out")
        if not 0 <= self.damping <= 0.9:
            raise ValueError(f"damping = {self.damping} cannot be run; choose 0 to 0.9, 0.05 for 5 %")
        if self.manufacture not in INSIDE:
            raise ValueError(f"manufacture = {self.manufacture!r} must be one of {', '.join(INSIDE)}")
        if not (0 <= self.order <= 10 and self.time_limit > 0 and self.memory_limit >= 0):
            raise ValueError("order must be from 0 to 10, time_limit above 0, and memory_limit 0 or more")

    @property
    def computed_by(self) -> str:
        """Module that runs it: with the reference solver, or with one of somebody else."""
        return f"mpm_verify.cases.mms.{'external.' if self.solver else ''}execute"

    @property
    def plugins(self) -> dict[str, str]:
        """Packages of the fields that name a plug-in which computes."""
        known = super().plugins
        return {name: known[name] for name in ("solution", "material")} if self.solver else known

    @property
    def courant_number(self) -> float:
        """C dt / dx on these cells."""
        if self.time_step == "printed":
            solution = create(SOLUTIONS, self.solution)
            dx = float(solution.upper[0] - solution.lower[0]) / self.cells
            return float(self.courant * sqrt(solution.C / dx))
        return self.courant * (BEGIN / self.cells if self.time_step == "h2" else 1.0)

    @property
    def whole_steps(self) -> bool:
        """Whether dt stays as it is, though the steps do not fill the duration."""
        return self.time_step == "printed"

    @property
    def turns(self) -> int:
        """Number that its steps are a multiple of: of quarters of a period with damping in the problem, else 1.

        The body force jumps where the motion turns. With these steps that is half a step away from each v.
        """
        return quarters(create(SOLUTIONS, self.solution), self.periods) if self.damping_inside else 1

    @property
    def damping_inside(self) -> float:
        """Damping that the problem has too."""
        return self.damping if self.manufacture == "damping" else 0.0

    @property
    def damping_outside(self) -> float:
        """Damping that the problem does not have."""
        return self.damping - self.damping_inside

    @property
    def stiffness(self) -> float:
        """Ratio of bulk to shear modulus; 0 where the material does not state them or the volume ratio is smoothed."""
        material = self.shipped_material
        if not hasattr(material, "mu") or not hasattr(material, "lam") or self.smooths_volume:
            return 0.0
        return float(material.lam / material.mu + 2 / 3)

    @property
    def smooths_volume(self) -> bool:
        """Whether the volume ratio, or its rate, is smoothed."""
        smoothing = optional(SMOOTHINGS, self.smoothing)
        return bool(
            smoothing and smoothing.of != "stress" and (smoothing.volumetric or split(self.smoothing)[0] == "fbar")
        )

    @property
    def strays(self) -> bool:
        """Whether the material has a rate that makes it another solid than the one of its energy."""
        return strays_on(self.shipped_material, self.solution)

    @property
    def edge_noise(self) -> bool:
        """Whether FLIP keeps the noise beside a prescribed edge, which update-stress-last alone damps."""
        if self.solver or self.stress == "usl" or split(self.transfer)[0] != "flip" or not is_file(self.solution):
            return False
        try:
            return "prescribed" in create(SOLUTIONS, self.solution).boundary
        except ValueError:  # its file may be gone when results are read
            return False

    @property
    def shipped_material(self) -> Any:
        """Constitutive model, None of a user's file, which may be gone when its results are read."""
        return None if not self.material or is_file(self.material) else create(MATERIALS, self.material)

    @property
    def tied(self) -> bool:
        """Whether the order is one along a path of dt and dx, so that dt is not halved apart from it."""
        return self.time_step != "h"

    @property
    def again(self) -> bool:
        """Whether a failed Result is run again: somebody may have mended the solver, or the machine."""
        return bool(self.solver)

    @property
    def cost(self) -> float:
        """Particle updates, up to a factor."""
        return self.cells * self.particles / self.courant_number * (self.periods or 1.0)

    @property
    def updates(self) -> float:
        """Particle updates of a square or cube over the duration."""
        return 2.0 * self.cost

    @property
    def particles(self) -> int:
        """Number of particles of a line, square or cube, or of a slice in as many layers as the root of a cell's."""
        if self.solid:
            return self.cells**3 * self.ppc
        return int(self.cells ** min(self.dim, 2)) * self.ppc * (isqrt(self.ppc) if self.dim == 3 else 1)

    @property
    def nodes(self) -> int:
        """Number of nodes of a line, square or cube, or of a slice."""
        if self.solid:
            return (self.cells + 1) ** 3
        return int((self.cells + 1) ** min(self.dim, 2)) * (2 if self.dim == 3 else 1)

    @property
    def solid(self) -> bool:
        """Whether the solution itself has three dimensions."""
        name = split(self.solution)[0]
        return self.dim == 3 and name in available(SOLUTIONS) and getattr(load(SOLUTIONS, name), "coordinates", 2) == 3

    def __str__(self) -> str:
        name = label(self.method)
        thick = ", one cell thick" if self.dim == 3 and not self.solid else ""
        power = "³" if self.solid else "²" if self.dim > 1 else ""
        return f"{name} {self.cells}{power} cells, {self.ppc} per cell{thick}"


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
    log: tuple[str, ...] = ()  # last lines that a solver of somebody else printed
    exit_code: int | None = None  # of that solver
    told: str = ""  # version that its result.json states

    @property
    def strain(self) -> float:
        """Largest component of F - I where the material is one of small strains and these are not; else 0."""
        return max((spot.numbers["strain"] for spot in self.audit if spot.code is BlindSpotCode.MODEL), default=0.0)

    @property
    def still(self) -> bool:
        """Whether nothing moves in an answer of somebody else's solver."""
        return "still" in self.values

    def __post_init__(self) -> None:
        if self.run.solver:
            super().__post_init__()
            return
        values = [self.errors.get(q, {}).get(n, inf) for q in QUANTITIES for n in NORMS]
        if self.status == "finished" and not all(0 <= value < inf for value in values):
            raise ValueError("a finished run has every error of every quantity, finite and not negative")
