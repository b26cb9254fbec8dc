"""One explicit step, as in the flow chart: particles to grid, equation of motion, grid to particles, stress.

Update-stress-last, FLIP with a share of PIC, leapfrog start (v half a step behind x): see Scheme.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from solver._jit import BLOCK
from solver.boundary import MASS_CUTOFF, Walls, solve
from solver.slabs import Slabs
from solver.state import Grid, Ints, Particles
from solver.transfer import CHUNK, g2p, p2g
from solver.weights import Basis

Load = Callable[[Particles, float], None]


class Material(Protocol):
    """A law: writes particles.sigma (and its history) at the end of a step."""

    rho0: float

    def update(self, particles: Particles, dt: float) -> None:
        """Stress at the end of a step of length dt."""

    def wave_speed(self) -> float:
        """Speed of the fastest wave in the undeformed state."""


class RunFailed(Exception):  # noqa: N818 - a failed run is a result, not an error
    """The run cannot go on. `particle`: its row in the initial layout, -1 if none; `cell`: where it is."""

    def __init__(self, reason: str, step: int = 0, particle: int = -1, cell: tuple[int, int] | None = None) -> None:
        super().__init__(reason)
        self.reason, self.step, self.particle, self.cell = reason, step, particle, cell


@dataclass(frozen=True)
class Scheme:
    """`flip`: share of FLIP in the particle velocity, the rest is PIC. `staggered`: velocities live at half steps.

    The start of a staggered run is v at t = -dt/2; without it the first order of time is lost.
    """

    flip: float = 1.0
    staggered: bool = True

    def __post_init__(self) -> None:
        if not 0.0 <= self.flip <= 1.0:
            raise ValueError(f"flip = {self.flip} is no share; choose 0 (PIC) to 1 (FLIP)")


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
    steps: int = 0
    slabs: Slabs = field(default_factory=Slabs)
    lost: Ints = field(init=False)
    crossed: Ints = field(init=False)

    def __post_init__(self) -> None:
        self.lost = np.full(-(-len(self.particles) // CHUNK), -1)
        self.crossed = np.zeros(len(self.lost), np.int64)
        self.slabs.sort(self.grid, self.particles)

    @property
    def crossings(self) -> int:
        """Faces of cells that particles have passed so far."""
        return int(self.crossed.sum())

    @property
    def time(self) -> float:
        """Steps times dt, so that no rounding piles up."""
        return self.steps * self.dt


def check_time_step(model: Model) -> None:
    """Raise RunFailed where dt is above dx / (c + |v|), the time a wave needs to cross a cell."""
    speed = model.material.wave_speed() + float(np.hypot(*model.particles.v.T).max())
    limit = model.grid.dx / speed
    if model.dt > limit:
        raise RunFailed(f"dt = {model.dt:.3g} is above the stability limit {limit:.3g} (--force runs it all the same)")


def advance(model: Model, load: Load) -> None:
    """One step; `load` writes particles.b at the time it is given. Raises RunFailed."""
    load(model.particles, model.time)
    particles_to_grid(model)
    equation_of_motion(model)
    grid_to_particles(model)
    model.material.update(model.particles, model.dt)
    model.steps += 1


def particles_to_grid(model: Model) -> None:
    """Mass, momentum and force at the nodes; particles that strayed are sorted anew, slabs too narrow are widened."""
    g, p, s = model.grid, model.particles, model.slabs
    for attempt in range(8):
        p2g(
            model.basis.fill, model.basis.support, model.basis.width, s.start, s.width,
            p.x, p.v, p.F, p.sigma, p.m, p.V0, p.b, p.domain.ravel(), g.origin, 1.0 / g.dx, g.nx, g.ny,
            g.mass, g.given, s.strayed,
        )  # fmt: skip
        if (s.strayed < 0).all():
            return
        refuse_outside(model, s.strayed[s.strayed >= 0])
        s.width *= 2 if attempt else 1
        s.sort(g, p)
    raise RunFailed("a particle domain is as wide as the grid", model.steps)


def equation_of_motion(model: Model) -> None:
    """Velocities and accelerations at the nodes."""
    g, w, cutoff = model.grid, model.walls, MASS_CUTOFF * float(model.particles.m.max())
    w.move(g, model.time, model.dt)
    solve(g.mass, g.given, g.motion, w.held, w.value, w.rate, model.dt, cutoff, g.ny)


def grid_to_particles(model: Model) -> None:
    """v, x and F at the end of the step."""
    g, p = model.grid, model.particles
    g2p(
        model.basis.fill, model.basis.support, model.basis.width, p.x, p.v, p.F, p.domain.ravel(), g.origin, 1.0 / g.dx,
        g.nx, g.ny, g.motion, model.dt, model.scheme.flip, model.lost, model.crossed,
    )  # fmt: skip
    model.basis.convect(p, g, model.dt)
    if (model.lost >= 0).any():
        lo = int(model.lost[model.lost >= 0][0])
        F = p.F[lo : lo + BLOCK]
        with np.errstate(all="ignore"):  # by the kernel's formula: det() rounds in another way
            J = F[:, 0, 0] * F[:, 1, 1] - F[:, 0, 1] * F[:, 1, 0]
        fail(model, lo + int(np.flatnonzero(~((J > 0) & (J < np.inf)))[0]), "det F <= 0")


def refuse_outside(model: Model, blocks: Ints) -> None:
    """Raise RunFailed for the first particle of the blocks that start at `blocks` which reaches out of the grid."""
    g, p = model.grid, model.particles
    table, node = np.empty(3 * model.basis.support * BLOCK), np.empty(model.basis.support * BLOCK, np.int64)
    for lo in blocks:
        for i in range(lo, min(lo + BLOCK, len(p))):
            arrays = (p.x[i], p.F[i].ravel(), p.domain[i])
            box = (0.0, g.nx - 1.0, 0.0, g.ny - 1.0)
            if not model.basis.fill(*arrays, *g.origin, 1.0 / g.dx, g.nx, g.ny, *box, table, node):
                fail(model, i, model.basis.limit)


def fail(model: Model, row: int, reason: str) -> None:
    """Raise RunFailed for the particle in that row; what is not finite is named first, since it is the cause."""
    p = model.particles
    finite = all(np.isfinite(a[row]).all() for a in (p.x, p.v, p.F, p.sigma))
    cell = tuple(model.grid.cell(p.x[row]).tolist()) if np.isfinite(p.x[row]).all() else None
    raise RunFailed(reason if finite else "a value that is not finite", model.steps, int(p.id[row]), cell)
