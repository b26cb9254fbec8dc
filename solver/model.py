"""What a run holds between two steps, and how a run that cannot go on ends."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, Protocol, get_args

import numpy as np

from mpm_verify.solver.boundary import MASS_CUTOFF, Walls
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.slabs import Slabs
from mpm_verify.solver.state import Grid, Ints, Particles
from mpm_verify.solver.stress_update import check_stress_update
from mpm_verify.solver.transfer import CHUNK
from mpm_verify.solver.transfers._base import Transfer
from mpm_verify.solver.transfers.flip import Flip
from mpm_verify.solver.weights import Basis

if TYPE_CHECKING:  # their kernels take seconds to compile, and most runs have neither
    from mpm_verify.solver.damping import Damping
    from mpm_verify.solver.energy_budget import Budget
    from mpm_verify.solver.smoothing._base import Smoothing

Load = Callable[[Particles, float], None]
Deformation = Literal["linear", "exponential"]


class Material(Protocol):
    """A law: writes particles.sigma (and its history) once a step, from the new F."""

    @property
    def rho0(self) -> float:
        """Density at reference."""

    def start(self, particles: Particles) -> None:
        """History at the start of a run."""

    def update(self, particles: Particles, dt: float) -> None:
        """Stress at the end of a step of length dt."""

    def wave_speed(self) -> float:
        """Speed of the fastest wave in the undeformed state."""


@dataclass(frozen=True)
class Scheme:
    """`transfer`: see solver/transfers; `stress`: when it is updated, solver/stress_update.py; `staggered`: v at half
    steps.

    The start of a staggered run is v at t = -dt/2; without it the first order of time is lost. `deformation`: "linear",
    F <- (I + A) F with A = dt L (paper eq. (4)), or "exponential", F <- (I + A + A^2/2) F, exp(A) to second
    order. A rigid turn by w dt makes the first grow det F by 1 + (w dt)^2 a step, the second by 1 + (w dt)^4/4. The
    second keeps det F > 0 in any step unless A has the eigenvalues -1 +- i; the first loses it at det(I + A) = 0.
    """

    transfer: Transfer = field(default_factory=Flip)
    stress: str = "usl"
    staggered: bool = True
    deformation: Deformation = "linear"

    def __post_init__(self) -> None:
        check_stress_update(self.stress)
        if self.deformation not in get_args(Deformation):
            raise ValueError(f"no deformation {self.deformation!r}; choose from {', '.join(get_args(Deformation))}")

    def half(self, dt: float) -> float:
        """Weight of A^2 F in the transfers, over dt."""
        return 0.5 * dt if self.deformation == "exponential" else 0.0


@dataclass
class Model:
    """All that one run holds. `time` is that of x, F and sigma; v is half a step behind it in a staggered run."""

    grid: Grid
    particles: Particles
    basis: Basis
    material: Material
    walls: Walls
    dt: float
    scheme: Scheme = Scheme()
    damping: "Damping | None" = None
    smoothing: "Smoothing | None" = None
    budget: "Budget | None" = None
    steps: int = 0
    damped: float = 0.0  # energy that damping has taken so far
    slabs: Slabs = field(default_factory=Slabs)
    inverted: Ints = field(init=False)
    cell_crossings: Ints = field(init=False)

    def __post_init__(self) -> None:
        self.inverted = np.full(-(-len(self.particles) // CHUNK), -1)
        self.cell_crossings = np.zeros(len(self.inverted), np.int64)
        if self.smoothing:
            self.smoothing.check(self.material)
        self.material.start(self.particles)
        self.slabs.sort(self.grid, self.particles)
        self.scheme.transfer.start(self)

    @property
    def crossings(self) -> int:
        """Faces of cells that particles have passed so far."""
        return int(self.cell_crossings.sum())

    @property
    def time(self) -> float:
        """Steps times dt, so that no rounding piles up."""
        return self.steps * self.dt

    @property
    def cutoff(self) -> float:
        """Mass below which a node has no velocity."""
        return MASS_CUTOFF * float(self.particles.m.max())


def check_time_step(model: Model) -> None:
    """Raise RunFailed where dt is above dx / (c + |v|), the time a wave needs to cross a cell."""
    speed = model.material.wave_speed() + float(np.hypot(*model.particles.v.T).max())
    limit = model.grid.dx / speed
    if model.dt > limit:
        raise RunFailed(FailureKind.UNSTABLE_STEP, numbers={"dt": model.dt, "limit": limit})


def fail(model: Model, row: int, kind: FailureKind, numbers: dict[str, float] | None = None) -> None:
    """Raise RunFailed for the particle in that row; what is not finite is named first, since it is the cause."""
    p = model.particles
    finite = all(np.isfinite(a[row]).all() for a in (p.x, p.v, p.F, p.sigma))
    cell = tuple(model.grid.cell(p.x[row]).tolist()) if (np.abs(p.x[row]) < 1e9 * model.grid.dx).all() else None
    if not finite:
        kind, numbers = FailureKind.NOT_FINITE, None
    raise RunFailed(kind, model.steps, int(p.id[row]), cell, numbers)
