"""One explicit step, as in the flow chart: particles to grid, equation of motion, grid to particles, stress.

When the stress is updated, see solver/stress_update.py; how velocities go between particles and grid is a plug-in of
solver/transfers. The usual step, FLIP and update-stress-last, is one pass to the grid and one back.
"""

from typing import TYPE_CHECKING, cast

import numpy as np

from mpm_verify.solver._jit import BLOCK
from mpm_verify.solver.boundary import solve
from mpm_verify.solver.context import fail
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.material_model import Material
from mpm_verify.solver.model import Load, Model, Observer, Scheme, check_time_step
from mpm_verify.solver.state import Floats, Ints
from mpm_verify.solver.transfer import g2p, p2g

if TYPE_CHECKING:
    from mpm_verify.solver.rate_material import RateMaterial

__all__ = ["Load", "Material", "Model", "Observer", "Scheme", "advance", "check_time_step"]


def advance(model: Model, load: Load) -> None:
    """Advance a model by one step.

    Parameters
    ----------
    model
        Changed in place.
    load
        ``load(particles, t)`` writes the body force per mass, particles.b (P,2), at the time t of the step's start.

    Raises
    ------
    RunFailed
        Where a particle is inverted, leaves the grid or is not finite: the run cannot go on.
    """
    load(model.particles, model.time)
    STRESS_UPDATES[model.scheme.stress](model)
    if model.pooling:
        model.pooling.pool(model)
    model.steps += 1
    model.tell("after_step")


def stress_last(model: Model) -> None:
    """Step with update-stress-last: v, x and F in one pass over the particles, then sigma."""
    particles_to_grid(model)
    equation_of_motion(model)
    x = model.basis.on_grid(model.particles)
    x = x.copy() if model.smoothing else x
    grid_to_particles(model)
    update_stress(model, x)


def stress_modified_last(model: Model) -> None:
    """Step with modified update-stress-last: v, then F from the nodes' velocities that v gives, by the old weights."""
    from mpm_verify.solver.transfers._passes import advect, spread, walled

    particles_to_grid(model)
    equation_of_motion(model)
    new_velocities(model)
    momentum = spread(model, model.particles.v)
    model.scheme.transfer.give(model, momentum)
    mapped, x = walled(model, momentum), model.basis.on_grid(model.particles).copy()
    model.scheme.transfer.filter(model, mapped)
    advect(model, model.grid.velocity_acceleration, mapped, model.scheme.half(model.dt))
    model.basis.convect(model.particles, model.grid, model.dt)
    fail_if_inverted(model)
    update_stress(model, x)


def stress_first(model: Model) -> None:
    """Step with update-stress-first: F and sigma, then the forces, v and x. Weights of the forces know the new F."""
    from mpm_verify.solver.transfers._passes import advect, walled

    rest = np.zeros_like(model.grid.velocity_acceleration)
    particles_to_grid(model)
    model.walls.move(model.grid, model.time, model.dt)
    before = walled(model, model.grid.momentum_force, before=True)
    model.scheme.transfer.filter(model, before)
    advect(model, rest, before, model.scheme.half(model.dt))
    fail_if_inverted(model)
    update_stress(model, model.basis.on_grid(model.particles))
    particles_to_grid(model)
    equation_of_motion(model)
    new_velocities(model)
    advect(model, model.grid.velocity_acceleration, rest, model.scheme.half(model.dt))
    model.basis.convect(model.particles, model.grid, model.dt)
    fail_if_inverted(model)


STRESS_UPDATES = {"usl": stress_last, "musl": stress_modified_last, "usf": stress_first}


def particles_to_grid(model: Model) -> None:
    """Write mass, momentum and force at the nodes; sort particles that strayed, widen slabs that are too narrow."""
    g, p, s = model.grid, model.particles, model.slabs
    if model.smoothing:
        model.smoothing.stress(model)
    for attempt in range(8):
        p2g(
            model.basis.fill, model.basis.support, model.basis.domain_size, s.start, s.slab_columns,
            s.first, s.last, p.x, p.v, p.F, p.sigma_smoothed if p.sigma_smoothed.size else p.sigma, p.m, p.V0, p.b,
            p.domain.ravel(), g.origin, 1.0 / g.dx, g.nx, g.ny, g.mass, g.momentum_force, s.strayed,
        )  # fmt: skip
        if (s.strayed < 0).all():
            model.scheme.transfer.give(model, g.momentum_force)
            return
        fail_if_outside(model, s.strayed[s.strayed >= 0])
        s.slab_columns *= 2 if attempt else 1
        s.sort(g, p, model.basis.on_grid(p))
    raise RunFailed(FailureKind.SLAB, model.steps)


def update_stress(model: Model, x: Floats) -> None:
    """Update the stress by the strain of the step, or by what smoothing makes of it in cells of x, where it began.

    Raises ValueError for a material that leaves a stress of another shape.
    """
    p = model.particles
    F_smoothed = model.smoothing.strain(model, x) if model.smoothing else None
    if F_smoothed is None:
        model.material.update(p, model.dt)
    elif model.material.rate is None:
        F, p.F = p.F, F_smoothed  # for the stress alone
        model.material.update(p, model.dt)
        p.F = F
    else:
        cast("RateMaterial", model.material).update(p, model.dt, F_smoothed)
    if p.sigma.shape != (len(p), 4):  # a kernel would read beyond it
        raise ValueError(f"update leaves particles.sigma with the shape {p.sigma.shape}, which must be {(len(p), 4)}")


def equation_of_motion(model: Model) -> None:
    """Write velocities and accelerations at the nodes, and what the transfer makes of them."""
    g, w, nodes = model.grid, model.walls, model.slabs.nodes
    w.move(g, model.time, model.dt)
    if model.surface:
        model.surface.act(model)
    model.tell("before_forces")
    w.touch(g, model.dt, model.cutoff)
    if model.damping:
        model.damped += w.damp(model.damping.apply, g, model.dt, model.cutoff)
    solve(
        g.mass[nodes], g.momentum_force[nodes], g.velocity_acceleration[nodes], w.held[nodes], w.value[nodes],
        w.rate[nodes], w.stops, model.dt, model.cutoff, g.ny,
    )  # fmt: skip
    model.tell("after_motion")
    model.scheme.transfer.filter(model, g.velocity_acceleration)
    model.scheme.transfer.take(model)
    if model.surface:
        model.surface.move(model)


def grid_to_particles(model: Model) -> None:
    """Write v, x and F at the end of the step."""
    g, p = model.grid, model.particles
    g2p(
        model.basis.fill, model.basis.support, model.basis.domain_size, p.x, p.v, p.F, p.domain.ravel(), g.origin,
        1.0 / g.dx,
        g.nx, g.ny, g.velocity_acceleration, model.dt, model.scheme.half(model.dt), model.scheme.transfer.flip_fraction,
        model.inverted,
        model.cell_crossings,
    )  # fmt: skip
    model.tell("after_particles")
    model.basis.convect(p, g, model.dt)
    fail_if_inverted(model)


def new_velocities(model: Model) -> None:
    """Write v alone at the end of the step."""
    from mpm_verify.solver.transfers._passes import collect

    p, flip = model.particles, model.scheme.transfer.flip_fraction
    taken = collect(model, model.grid.velocity_acceleration)
    p.v[:] = flip * (p.v + model.dt * taken[:, 2:]) + (1.0 - flip) * taken[:, :2]
    model.tell("after_particles")


def fail_if_inverted(model: Model) -> None:
    """Raise RunFailed for the first particle that the last pass has found inverted."""
    if (model.inverted >= 0).any():
        lo = int(model.inverted[model.inverted >= 0][0])
        F = model.particles.F[lo : lo + BLOCK]
        with np.errstate(all="ignore"):  # the kernel's formula: det() rounds in another way
            J = F[:, 0, 0] * F[:, 1, 1] - F[:, 0, 1] * F[:, 1, 0]
        fail(model, lo + int(np.flatnonzero(~((J > 0) & (J < np.inf)))[0]), FailureKind.INVERTED)


def fail_if_outside(model: Model, blocks: Ints) -> None:
    """Raise RunFailed for the first particle of the blocks that start at `blocks` which has left the grid."""
    g, p = model.grid, model.particles
    table, node = np.empty(3 * model.basis.support * BLOCK), np.empty(model.basis.support * BLOCK, np.int64)
    for lo in blocks:
        for i in range(lo, min(lo + BLOCK, len(p))):
            arrays = (p.x[i], p.F[i].ravel(), p.domain[i])
            box = (0.0, g.nx - 1.0, 0.0, g.ny - 1.0)
            if not model.basis.fill(*arrays, *g.origin, 1.0 / g.dx, g.nx, g.ny, *box, table, node):
                fail(model, i, *model.basis.fault(p.F[i], p.domain[i], g.dx))
