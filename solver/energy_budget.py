"""Energy budget and impulse of a step, term by term.

On the grid w is the velocity before the step, u the one after it, a the acceleration that the particles are given, f
the force. The step between moves particles, strains them by the gradient of u, and makes w of the next step from u.
    walls       dt (m a - f) . (w + u)/2        what a wall holds
    transfer    dt/2 f . (u_before - w) + sum of (dt a)^2 m/2 over nodes, less over particles: what FLIP loses on its
                way between particles and grid; velocities that the grid does not see stay with the particles
    convection  work of the force on u, less that of the stress on the strain of the particles: weights that move
    half_step   dt/2 m g . (u_before - u): the force of gravity works on the mean of two velocities, and moves with u
None of these knows the energies of the particles, so that
    kinetic + potential + work + damping - walls + transfer + convection - half_step = constant, to round-off
can fail: in kinetic energy, position and damping against the forces, not in the work of the stress, which convection is
held against. With other transfers than FLIP what they blend is a loss too, known as the gain of the particles alone:
then kinetic energy and walls cancel in that sum, and are held by tests of their own.
A transfer that filters velocities moves particles with others than u: those are u above but in walls, and transfer has
dt/2 f . (filtered - u) too. Its filter leaves w at a node that a wall holds in each step, which no wall has met: there
walls has the velocity that particles moved with last instead of w, and the rest is transfer. The impulse of walls is
that of the equation of motion, by the fraction of FLIP, and what they take in the filter (`Walls.filtered`).
The work of the stress is the mean of that of the stress at the start and at the end of a step.
Transfer and convection are what the method loses, and no energy of the material. Sums are no matrix products: threads
of BLAS wait for the next one at full speed, and take the core from another run.
"""

from dataclasses import dataclass, field

import numpy as np

from mpm_verify.solver._jit import F1, F2, f8, flag, kernel, nothing
from mpm_verify.solver.model import Model, Observer
from mpm_verify.solver.state import Floats, Grid, Particles

TRANSFER, CONVECTION, WALLS, ON_GRID, FORCES, LATE, IMPULSE, HALF_STEP, SUMS = 0, 1, 2, 3, 4, 5, 6, 8, 9


@kernel(nothing(F1, F2, F2, F2, F1, f8, f8, F1))
def between_steps(mass, momentum_force, after, undamped, g, dt, cutoff, sums):
    """Add up what lies between two steps, and keep the forces in `undamped` (n,2).

    To LATE: what the velocities `after` (n,2) of the last step lose until this one. To CONVECTION: half the work of the
    new inner forces on them.
    """
    for i in range(mass.shape[0]):
        if mass[i] > cutoff:
            for a in range(2):
                f = momentum_force[i, 2 + a]
                undamped[i, a] = f
                sums[LATE] += 0.5 * dt * f * (after[i, a] - momentum_force[i, a] / mass[i])
                sums[CONVECTION] += 0.5 * dt * (f - mass[i] * g[a]) * after[i, a]
                sums[HALF_STEP] += 0.5 * dt * mass[i] * g[a] * after[i, a]


@kernel(nothing(F1, F2, F2, F2, F2, flag[:, ::1], f8, f8, F1, f8, f8, F1))
def in_step(mass, momentum_force, velocity_acceleration, undamped, after, held, flip, kept, g, dt, cutoff, sums):
    """Add up what the step does on the grid; write the kinetic energy after it to ON_GRID, and u to `after`.

    `flip`: fraction of FLIP; `kept`: that of w in the velocity that a wall meets, 1 or 0, the rest is the last step's.
    """
    sums[ON_GRID] = 0.0
    for i in range(mass.shape[0]):
        if mass[i] > cutoff:
            for a in range(2):
                u = velocity_acceleration[i, a]
                change = dt * velocity_acceleration[i, 2 + a]
                w = momentum_force[i, a] / mass[i]
                mean = 0.5 * (w + u)
                taken = flip * change + (1.0 - flip) * (u - w)
                impulse = mass[i] * taken - dt * momentum_force[i, 2 + a]
                sums[ON_GRID] += 0.5 * mass[i] * u * u
                sums[TRANSFER] += 0.5 * mass[i] * change * change
                sums[FORCES] += dt * momentum_force[i, 2 + a] * mean
                sums[CONVECTION] += 0.5 * dt * (undamped[i, a] - mass[i] * g[a]) * u
                sums[HALF_STEP] -= 0.5 * dt * mass[i] * g[a] * u
                sums[IMPULSE + a] += dt * (momentum_force[i, 2 + a] - undamped[i, a])
                if held[i, a]:
                    sums[WALLS] += impulse * (mean + 0.5 * (1.0 - kept) * (after[i, a] - w))
                    sums[IMPULSE + a] += impulse
        for a in range(2):
            after[i, a] = velocity_acceleration[i, a] if mass[i] > cutoff else 0.0


@kernel(nothing(F1, F2, F2, F2, F2, F1, f8, f8, F1))
def in_filter(mass, velocity_acceleration, undamped, after, filtered, g, dt, cutoff, sums):
    """Add up what a filter does to the velocities behind `in_step`, which are in `after`; write those of now there."""
    sums[ON_GRID] = 0.0
    for i in range(mass.shape[0]):
        if mass[i] > cutoff:
            for a in range(2):
                moved = velocity_acceleration[i, a]
                more = moved - after[i, a]
                sums[ON_GRID] += 0.5 * mass[i] * moved * moved
                sums[LATE] += 0.5 * dt * undamped[i, a] * more
                sums[CONVECTION] += 0.5 * dt * (undamped[i, a] - mass[i] * g[a]) * more
                sums[HALF_STEP] -= 0.5 * dt * mass[i] * g[a] * more
                sums[IMPULSE + a] -= mass[i] * filtered[i, a]
        for a in range(2):
            after[i, a] = velocity_acceleration[i, a] if mass[i] > cutoff else 0.0


def lumped(grid: Grid, cutoff: float) -> Floats:
    """Velocities of the nodes (n,2) before the first step, which has none before it."""
    mass = grid.mass[:, None]
    velocity: Floats = np.divide(grid.momentum, mass, out=np.zeros((len(mass), 2)), where=mass > cutoff)
    return velocity


def kinetic(particles: Particles) -> float:
    """Kinetic energy of the particles, that of velocities which the grid does not see included."""
    p = particles
    return 0.5 * float((p.m * (p.v[:, 0] ** 2 + p.v[:, 1] ** 2)).sum())


def work(particles: Particles) -> float:
    """Work of the stress so far, of a material in rate form."""
    return 0.5 * float((particles.V0 * particles.work.sum(axis=1)).sum())


def given(model: Model) -> float:
    """Work per thickness of the stress on what pooling takes off crowded volumes: no motion and no force does it."""
    return model.pooling.crowding.given if model.pooling else 0.0


@kernel(f8(F1, F2, F2))
def kicked(m, before, v):
    """Sum of m |v - before|^2 / 2 over particles, (P,2)."""
    total = 0.0
    for p in range(m.shape[0]):
        x = v[p, 0] - before[p, 0]
        y = v[p, 1] - before[p, 1]
        total += 0.5 * m[p] * (x * x + y * y)
    return total


@dataclass
class Budget(Observer):
    """Energy budget since the start, by sums over the steps.

    Holds for update-stress-last and materials in rate form, where the stress of a step's start and end is that of the
    forces.

    Parameters
    ----------
    gravity
        Body force per mass, (2,).
    before
        Kinetic energy of the particles at the start.
    """

    gravity: Floats
    before: float = 0.0
    sums: Floats = field(default_factory=lambda: np.zeros(SUMS))
    after: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    undamped: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    v: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    bounds: tuple[int, int] = (0, 0)  # of the nodes that the particles can touch

    def before_forces(self, model: Model) -> None:
        """Add what lies between two steps, with forces that are not damped yet."""
        g = model.grid
        if not len(self.after):
            self.after, self.undamped = np.zeros((len(g.mass), 2)), np.zeros((len(g.mass), 2))
            self.sums[HALF_STEP] += 0.5 * model.dt * float((g.force * lumped(g, model.cutoff)).sum())
        dt, nodes = model.dt if model.steps else 0.0, model.slabs.nodes  # nothing lies before the first step
        if self.bounds != (nodes.start, nodes.stop):  # what the particles have left is at rest
            kept, before = self.after[nodes].copy(), slice(*self.bounds)
            self.after[before], self.after[nodes] = 0.0, kept
            self.bounds = nodes.start, nodes.stop
        between_steps(
            g.mass[nodes], g.momentum_force[nodes], self.after[nodes], self.undamped[nodes], self.gravity, dt,
            model.cutoff, self.sums,
        )  # fmt: skip

    def after_motion(self, model: Model) -> None:
        """Add what the step does on the grid."""
        g, nodes, transfer = model.grid, model.slabs.nodes, model.scheme.transfer
        in_step(
            g.mass[nodes], g.momentum_force[nodes], g.velocity_acceleration[nodes], self.undamped[nodes],
            self.after[nodes], model.walls.held[nodes], transfer.flip_fraction, float(not transfer.filters),
            self.gravity, model.dt, model.cutoff, self.sums,
        )  # fmt: skip
        self.v = model.particles.v.copy()

    def after_particles(self, model: Model) -> None:
        """Add what a filter does to the velocities, and take off what the particles took of the step."""
        g, p, nodes = model.grid, model.particles, model.slabs.nodes
        if model.scheme.transfer.filters:
            taken = model.walls.filtered if len(model.walls.filtered) else np.zeros((len(g.mass), 2))
            in_filter(
                g.mass[nodes], g.velocity_acceleration[nodes], self.undamped[nodes], self.after[nodes], taken[nodes],
                self.gravity, model.dt, model.cutoff, self.sums,
            )  # fmt: skip
        self.sums[TRANSFER] -= kicked(p.m, self.v, p.v)

    def terms(self, model: Model) -> dict[str, float]:
        """Energies after a step.

        Returns
        -------
        dict
            kinetic, on_grid, potential (zero where the particles have x = 0), work of the motion (what pooling gives
            is none), damping, walls, transfer, convection, half_step: energies per thickness.
        """
        p, sums = model.particles, self.sums
        done, transfer = work(p) - given(model), float(sums[TRANSFER] + sums[LATE])
        if model.scheme.transfer.flip_fraction != 1.0 or p.affine_velocity.size:
            transfer = float(sums[FORCES] + sums[WALLS] + sums[LATE]) - (kinetic(p) - self.before)
        return {
            "kinetic": kinetic(p),
            "on_grid": float(sums[ON_GRID]),
            "potential": -float((p.m * (p.x * self.gravity).sum(axis=1)).sum()),
            "work": done,
            "damping": model.damped,
            "walls": float(sums[WALLS]),
            "transfer": transfer,
            "convection": -done - float(sums[CONVECTION]),
            "half_step": float(sums[HALF_STEP]),
        }

    @property
    def impulse(self) -> Floats:
        """Momentum (2,) that walls and damping have given."""
        return self.sums[IMPULSE : IMPULSE + 2]


def residual(terms: dict[str, float], first: dict[str, float]) -> float:
    """Energy that the terms of a budget have gained since the first ones, and should not."""
    plus = ("kinetic", "potential", "work", "damping", "transfer", "convection")
    signs = dict.fromkeys(plus, 1) | {"walls": -1, "half_step": -1}
    return sum(sign * (terms[name] - first[name]) for name, sign in signs.items())
