"""Context of a step: what transfers, smoothing and damping work on; they know nothing of each other."""

from dataclasses import dataclass, field
from typing import Never

import numpy as np

from mpm_verify.solver.boundary import MASS_CUTOFF, Walls
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.material_model import Material
from mpm_verify.solver.slabs import Slabs
from mpm_verify.solver.state import Grid, Ints, Particles
from mpm_verify.solver.transfer import CHUNK
from mpm_verify.solver.weights import Basis


@dataclass
class Context:
    """A body on its grid between two steps; `time` is the time level of x, F and sigma."""

    grid: Grid
    particles: Particles
    basis: Basis
    material: Material
    walls: Walls
    dt: float
    steps: int = field(default=0, kw_only=True)
    slabs: Slabs = field(default_factory=Slabs, kw_only=True)
    inverted: Ints = field(init=False)
    cell_crossings: Ints = field(init=False)

    def __post_init__(self) -> None:
        self.inverted = np.full(-(-len(self.particles) // CHUNK), -1)
        self.cell_crossings = np.zeros(len(self.inverted), np.int64)

    @property
    def crossings(self) -> int:
        """Number of cell faces that particles have passed so far; none where they stay at X on the grid."""
        return 0 if self.basis.reference else int(self.cell_crossings.sum())

    @property
    def time(self) -> float:
        """Product of steps and dt, so that no rounding piles up."""
        return self.steps * self.dt

    @property
    def cutoff(self) -> float:
        """Mass below which a node has no velocity."""
        return MASS_CUTOFF * float(self.particles.m.max())


def fail(context: Context, row: int, kind: FailureKind, numbers: dict[str, float] | None = None) -> Never:
    """Raise RunFailed for the particle in a row; what is not finite is named first, since it is the cause."""
    p, grid = context.particles, context.grid
    at = context.basis.on_grid(p)[row]
    finite = all(np.isfinite(a[row]).all() for a in (p.x, p.v, p.F, p.sigma))
    cell = tuple(grid.cell(at).tolist()) if (np.abs(at) < 1e9 * grid.dx).all() else None
    if not finite:
        kind, numbers = FailureKind.NOT_FINITE, None
    raise RunFailed(kind, context.steps, int(p.id[row]), cell, numbers)
