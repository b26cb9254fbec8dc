"""Known answers of states that no sound run has: particles inverted or beyond the grid, rows in any order.

Also the exponential deformation, which columns use and no manufactured solution does.
"""

from itertools import pairwise
from typing import Any

import numpy as np

from mpm_verify.cases.judging.records import Outcome
from mpm_verify.solver.boundary import box
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.failure import Failure, FailureKind, RunFailed
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.model import Model, Scheme
from mpm_verify.solver.plugins import MATERIALS, METHODS, create
from mpm_verify.solver.slabs import Slabs
from mpm_verify.solver.state import Grid, Particles
from mpm_verify.solver.step import advance, grid_to_particles

Answer = tuple[str, str]
CELLS, CLOSE = 24, 1e-12


def body(method: str, deformation: Any = "linear", order: Any = None) -> Model:
    """Body of unit cells without walls, three slabs wide, its particles in some order; rows are told by F."""
    grid = Grid(1.0, np.zeros(2), np.array([float(CELLS), 6.0]))
    basis, material = create(METHODS, method), create(MATERIALS, "neo_hookean")
    particles = basis.populate(rectangle(np.array([2.0, 2.0]), np.array([CELLS - 2.0, 4.0]), 1.0, 4), 1.0)
    if order is not None:
        particles.reorder(order)
    return Model(
        grid,
        particles,
        basis,
        material,
        box(grid, "free"),
        0.1 / material.wave_speed(),
        Scheme(deformation=deformation),
    )


def no_load(particles: Particles, t: float) -> None:
    """No body force acts."""


def ended(model: Model) -> Failure | None:
    """Failure that ends the next step, if one does."""
    try:
        advance(model, no_load)
    except RunFailed as end:
        return end.failure
    return None


def failures(method: str) -> list[tuple[str, bool]]:
    """Whether a step ends where a particle is inverted or leaves the grid, and names it."""
    turned, out = body(method), body(method)
    row = len(turned.particles) // 2
    turned.particles.F[row] = [[-0.4, 0.1], [0.0, 0.6]]
    turned.particles.sigma[row] = 0.0
    turned.particles.id[:] = turned.particles.id[::-1].copy()
    name = int(turned.particles.id[row])
    found = ended(turned)
    out.particles.x[row] += (0.0, 500.0)
    if out.particles.domain.shape[1] == 8:  # corners of their own
        out.particles.domain[row] += np.tile((0.0, 500.0), 4)
    lost = ended(out)
    return [
        ("an inverted particle ends the step", found is not None and found.kind is not FailureKind.NOT_FINITE),
        ("it is named", found is not None and found.particle == name),
        ("one that has left ends it", lost is not None and lost.kind is FailureKind.OUTSIDE_GRID),
    ]


def orders(method: str) -> list[tuple[str, bool]]:
    """Whether particles in any order give the same step, and every array goes along."""
    usual = body(method)
    mixed = body(method, order=np.random.default_rng(3).permutation(len(usual.particles)))
    for model in (usual, mixed):
        model.particles.v[:] = 0.01 * np.sin(model.particles.X)
        advance(model, no_load)
    pairs = [(m.particles.in_initial_order("v"), m.particles.in_initial_order("F")) for m in (usual, mixed)]
    same = all(np.abs(a - b).max() < CLOSE for a, b in zip(*pairs, strict=True))
    p = Particles(np.arange(8.0).reshape(4, 2), np.arange(4.0), np.arange(4.0), np.arange(4.0)[:, None])
    for name in ("F_old", "history", "sigma_smoothed", "work", "affine_velocity", "carried"):
        setattr(p, name, np.arange(8.0).reshape(4, 2))
    p.F[:, 0, 0], p.sigma[:, 0] = np.arange(4.0), np.arange(4.0)
    before = {name: getattr(p, name).copy() for name in vars(p)}
    p.reorder(np.array([2, 0, 3, 1]))
    along = all(np.array_equal(getattr(p, name), array[[2, 0, 3, 1]]) for name, array in before.items())
    slabs = Slabs()
    slabs.sort(mixed.grid, mixed.particles)
    column = np.floor(mixed.particles.x[:, 0] - mixed.grid.origin[0]).astype(int) // slabs.slab_columns
    parts = [np.unique(column[a:b]).tolist() for a, b in pairwise(slabs.start)]
    told = all(part in ([], [s]) for s, part in enumerate(parts)) and slabs.start[-1] == len(column)
    return [("any order gives the same step", same), ("every array goes along", along), ("slabs hold theirs", told)]


def deformation(method: str) -> list[tuple[str, bool]]:
    """Whether F follows a uniform velocity gradient by (I + A + A^2/2) F, and by (I + A) F; A = dt L."""
    L, F = np.array([[0.2, -0.5], [0.3, 0.1]]), np.array([[1.1, 0.2], [-0.1, 0.9]])
    found = []
    for word, second in (("exponential", 0.5), ("linear", 0.0)):
        model = body(method, word)
        A = model.dt * 100 * L
        model.grid.velocity_acceleration[:, :2] = model.grid.nodes @ (100 * L).T
        if method != "cpdi2":  # corners of its own have no F yet
            model.particles.F[:] = F
        before = model.particles.F.copy()
        grid_to_particles(model)
        expected = (np.eye(2) + A + second * A @ A) @ before
        found.append((f"{word} deformation", bool(np.abs(model.particles.F - expected).max() < CLOSE)))
    return found


def undamped(method: str) -> list[tuple[str, bool]]:
    """Whether damping by nothing is no damping, to the bit."""
    usual, damped = body(method), body(method)
    damped.damping = Damping(0.0)
    for model in (usual, damped):
        model.particles.v[:] = 0.01 * np.sin(model.particles.X)
        advance(model, no_load)
        advance(model, no_load)
    return [("damping of zero is none", bool((usual.particles.v == damped.particles.v).all()))]


def ask(method: str) -> Answer:
    """First known answer that is not given."""
    held = [*failures(method), *orders(method), *deformation(method), *undamped(method)]
    wrong = next((name for name, holds in held if not holds), "")
    return (str(Outcome.FAIL), wrong) if wrong else (str(Outcome.PASS), "")
