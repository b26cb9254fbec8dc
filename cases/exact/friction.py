"""Walls with friction: bodies that slide, stick and leave on a grid that is a wall everywhere, and a step beside two.

Where each node is a wall a body moves as one, as a rigid block on a plane does: no stress is needed to carry the
reaction up to it. So its velocity is known after each step, with every basis, transfer and stress update.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import partial
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.exact.body import DX, FILLED, Subject, Variant, by_id, grid, layout, modelled, populated, shaken
from mpm_verify.cases.exact.body import variants as every
from mpm_verify.cases.exact.dense import Dense, Sigma, Weights
from mpm_verify.cases.exact.motion import still, taken
from mpm_verify.cases.exact.step import KNOWN
from mpm_verify.cases.exact.symmetry import moved
from mpm_verify.mms.constitutive.driver import random
from mpm_verify.mms.constitutive.tested import (
    FAILED,
    Pairs,
    Part,
    Reason,
    Tested,
    attempt,
    bound,
    farthest,
    not_asked,
    off,
)
from mpm_verify.solver.boundary import Walls, box
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.energy_budget import Budget, kinetic, residual
from mpm_verify.solver.friction import FrictionalWalls, Sides
from mpm_verify.solver.state import Floats
from mpm_verify.solver.step import advance

MU, PRESSED = 0.4, 0.02  # friction coefficient, and the force into the wall over c / dt
HALF = 0.5  # of the force, damped
SIDES: Sides = (0.3, "free", 0.5, "free")
TURNED: dict[str, Sides] = {"mirror": ("free", 0.3, 0.5, "free"), "quarter_turn": ("free", 0.5, 0.3, "free")}
STEPS, COURSE = 4, 14
# Axis of the normal, tangential over normal force, velocity at first over c: two go faster, two come to rest.
SLIDES = ((0, 0.7, 0.3), (1, -0.7, -0.3), (1, 0.1, 0.02), (0, 0.1, -0.02))


def tests(subject: Subject) -> list[Tested]:
    """Every transfer and stress update in each test."""
    found: list[Tested] = []
    for variant in every():
        for name, ask in (("friction_slide", slide), ("friction_stick", stick), ("friction_leave", leave),
                          ("friction_damped", damped),
                          ("friction_course", course)):  # fmt: skip
            found += attempt(f"{name} {variant}", Part.FRICTION, partial(ask, subject, variant))
        found += attempt(f"friction_budget {variant}", Part.FRICTION, partial(budget, subject, variant))
        found += attempt(f"friction_mirror {variant}", Part.FRICTION, partial(turned, subject, variant))
        if variant.transfer in KNOWN:
            found += attempt(f"friction_step {variant}", Part.FRICTION, partial(formulas, subject, variant))
    return found


def everywhere(axis: int) -> FrictionalWalls:
    """Friction at every node; the normal of the wall is on an axis."""
    plain, normal = box(grid(), "free"), np.zeros(grid().nodes.shape)
    normal[:, axis] = 1.0
    return FrictionalWalls(plain.held.copy(), plain.value.copy(), plain.rate.copy(), plain, normal, MU * normal)


def carry(
    subject: Subject, variant: Variant, axis: int, pull: float | Floats, press: Sequence[float], v: float,
    away: float = 0.0, damping: Damping | None = None
) -> tuple[Floats, float, float]:  # fmt: skip
    """Tangential and normal shifts and velocities (P,4) after some steps, what F and sigma changed by, energy damped.

    `pull` is the tangential force per mass, of all steps or of each, `press` the normal one of each, times dt over c;
    `v` is the tangential velocity at first over c, and `away` the normal one.
    """
    p = populated(subject, layout(), np.eye(2))
    p.v[:, [1 - axis, axis]] = np.array([v, away]) * subject.speed
    model = modelled(subject, p, variant, everywhere(axis), damping=damping)
    force, x = np.zeros(2), by_id(p, "x")
    for along, one in zip(np.broadcast_to(pull, len(press)), press, strict=True):
        force[[1 - axis, axis]] = np.array([along, -one]) * subject.speed / model.dt
        advance(model, lambda particles, t: np.copyto(particles.b, np.broadcast_to(force, particles.b.shape)))
    columns = [1 - axis, axis]
    moves = (by_id(model.particles, "x") - x)[:, columns] / DX
    rows = np.hstack([moves, by_id(model.particles, "v")[:, columns] / subject.speed])
    return rows, still(subject, model), model.damped / (float(p.m.sum()) * subject.speed**2)


def slide(subject: Subject, variant: Variant) -> Tested:
    """Body that slides: it goes faster by g_t - mu g_n, or slows down, turns round and sticks where |g_t| < mu g_n."""
    worst = 0.0
    for axis, part, v in SLIDES:
        rows, other, _ = carry(subject, variant, axis, part * PRESSED, STEPS * (PRESSED,), v)
        moved, speed = 0.0, v
        for _ in range(STEPS):
            speed += part * PRESSED
            speed -= np.copysign(min(abs(speed), MU * PRESSED), speed)
            moved += subject.dt * subject.speed / DX * speed
        worst = max(worst, off(rows, np.array([moved, 0.0, speed, 0.0]), 1.0), other)
    return Tested(f"friction_slide {variant}", worst, bound(2 * STEPS * subject.support), Part.FRICTION)


def stick(subject: Subject, variant: Variant) -> Tested:
    """Body at rest under a tangential force of 0.99 mu g_n: it does not move, to the last bit."""
    rows, _, _ = carry(subject, variant, 1, 0.99 * MU * PRESSED, STEPS * (PRESSED,), 0.0)
    return Tested(f"friction_stick {variant}", off(rows, 0.0, 1.0), 0.0, Part.FRICTION)


def course(subject: Subject, variant: Variant) -> Tested:
    """Body under random forces: it sticks, slips, leaves, falls back, and does each of them again.

    Forces are some that take it away from where it begins: beside the edge of a domain nodes have hardly any mass.
    """
    forces = PRESSED * (random(COURSE, 2, seed=142) * [1.0, 1.5] + [0.0, 0.1])
    rows, other, _ = carry(subject, variant, 0, forces[:, 0], forces[:, 1].tolist(), 0.0)
    v, moved, told = np.zeros(2), np.zeros(2), ""  # leaves, sticks, slips
    for force in forces * [1.0, -1.0]:
        v = v + force
        rubbed = MU * max(-v[1], 0.0)
        told += "l" if v[1] > 0 else "k" if abs(v[0]) <= rubbed else "p"
        v = np.array([v[0] - np.copysign(min(abs(v[0]), rubbed), v[0]), max(v[1], 0.0)])
        moved = moved + subject.dt * subject.speed / DX * v
    worst = max(off(rows, np.concatenate([moved, v]), 1.0), other)
    again = all([one for one, _ in groupby(told)].count(kind) > 1 for kind in "lkp")
    residual = worst if again else FAILED
    return Tested(f"friction_course {variant}", residual, bound(2 * COURSE * subject.support), Part.FRICTION)


def leave(subject: Subject, variant: Variant) -> Tested:
    """Body that is pressed for two steps and then torn off the wall, and one that is thrown off a floor.

    Nothing holds them, and nothing rubs, any more; nor does the floor strain the one that leaves it with a velocity.
    """
    press = np.array([1.0, 1.0, -1.0, -1.0]) * PRESSED
    rows, other, _ = carry(subject, variant, 1, PRESSED, tuple(press), 0.3)
    gained = np.stack([PRESSED - MU * np.maximum(press, 0.0), np.maximum(-press, 0.0)], axis=1)
    speeds = np.array([0.3, 0.0]) + np.cumsum(gained, axis=0)
    moved = subject.dt * subject.speed / DX * speeds.sum(axis=0)
    worst = max(off(rows, np.concatenate([moved, speeds[-1]]), 1.0), other, thrown(subject, variant))
    return Tested(f"friction_leave {variant}", worst, bound(2 * STEPS * subject.support), Part.FRICTION)


def thrown(subject: Subject, variant: Variant) -> float:
    """Distance from the known motion of a body, without stress, that is thrown off a floor on which it lies."""
    p, v = populated(subject, layout(filled=True), np.eye(2)), subject.speed * np.array([0.05, 0.1])
    p.v[:] = v
    model, x = modelled(subject, p, variant, ("free", "free", MU, "free"), FILLED), by_id(p, "x")
    for _ in range(STEPS):
        advance(model, lambda particles, t: particles.b.fill(0.0))
    moved = by_id(model.particles, "x") - x
    return max(off(moved, STEPS * model.dt * v, DX), off(model.particles.v, v, subject.speed), still(subject, model))


def damped(subject: Subject, variant: Variant) -> Tested:
    """Body whose flight the force slows down and damping would turn into the wall: it stops there, and is rubbed."""
    worst, force = 0.0, PRESSED * np.array([1.0, -0.9])
    for kind in ("local", "objective"):
        damping, v, moved, work = Damping(HALF, kind), PRESSED * np.array([0.25, 1.0]), np.zeros(2), 0.0
        rows, other, found = carry(subject, variant, 1, force[0], STEPS * (-force[1],), v[0], v[1], damping)
        for _ in range(STEPS):
            flies = (v + force)[1] > 0  # else it touches, and is not damped
            against = taken(damping, force, v) if flies else 0 * force
            new = v + force - against
            new = np.array([max(new[0] - MU * max(-new[1], 0.0), 0.0), max(new[1], 0.0)])
            work += float(against @ (v + new)) / 2
            v, moved = new, moved + subject.dt * subject.speed / DX * new
        worst = max(worst, off(rows, np.concatenate([moved, v]), 1.0), other, off(found, work, 1.0))
    return Tested(f"friction_damped {variant}", worst, bound(2 * STEPS * subject.support), Part.FRICTION)


def budget(subject: Subject, variant: Variant) -> list[Tested]:
    """Energies of a body that strikes a floor with friction add up; and the momentum of a step in which all slides.

    Of the tangential momentum friction takes mu times the normal one that the floor gives. All domains shrink: beside
    one that grows is a node of hardly any mass, which its force may send the other way.
    """
    names = f"friction_budget {variant}", f"friction_momentum {variant}"
    p = populated(subject, layout(filled=True), np.eye(2))
    p.v[:] = subject.speed * (0.02 * (random(len(p), 2) + 0.5 * FILLED - p.x / DX) + [0.5, -0.2])
    model = modelled(subject, p, variant, ("free", "free", MU, "free"), FILLED)
    g, m = np.array([0.05, -0.1]) * subject.speed**2 / DX, p.m.copy()
    known = Budget(g, kinetic(p))
    model.watch(known)
    rows, momentum = [known.terms(model)], [(m[:, None] * p.v).sum(axis=0)]
    for _ in range(2):
        advance(model, lambda particles, t: np.copyto(particles.b, np.broadcast_to(g, particles.b.shape)))
        rows.append(known.terms(model))
        momentum.append((model.particles.m[:, None] * model.particles.v).sum(axis=0))
    given = momentum[1] - momentum[0] - m.sum() * g * model.dt
    scale, most = float(m.sum()) * subject.speed, bound(4 * subject.support)
    found = []
    if variant.scheme.transfer.filters_walls:
        found.append(not_asked(names[1], Part.FRICTION, Reason.BUDGET))
    else:
        found.append(Tested(names[1], off(given[0], -MU * given[1], scale), most, Part.FRICTION))
    if subject.material.rate is None or variant.stress != "usl":
        reason = Reason.NO_RATE_FORM if subject.material.rate is None else Reason.BUDGET
        return [*found, not_asked(names[0], Part.FRICTION, reason)]
    energy = max(map(abs, rows[0].values()))
    worst = max(off(residual(row, rows[0]), 0.0, energy) for row in rows)
    return [*found, Tested(names[0], worst, most, Part.FRICTION)]


def turned(subject: Subject, variant: Variant) -> Tested:
    """Body beside two walls with friction, as it is, mirrored and turned."""
    both = moved(subject, variant, SIDES, TURNED)
    worst = max(both, key=lambda one: one.residual)
    return Tested(f"friction_mirror {variant}", worst.residual, worst.bound, Part.FRICTION, worst.reason)


def formulas(subject: Subject, variant: Variant) -> Tested:
    """Step of random v, F, sigma and b in the corner of two walls with friction, against full matrices of weights."""
    p = shaken(subject, populated(subject, layout(filled=True), np.eye(2)))
    model = modelled(subject, p, variant, SIDES, FILLED)
    b, order, dense = by_id(model.particles, "b"), model.particles.id.copy(), Rubbed(copy(model), variant.flip)
    dense.model.walls = Known(grid(FILLED).nodes)
    expected = dense.step(model.particles.b.copy(), Sigma(model))
    advance(model, lambda particles, t: np.copyto(particles.b, b[particles.id]))
    rows, q = np.argsort(order), model.particles
    pairs: Pairs = [
        (by_id(q, "x"), expected.x[rows], DX),
        (by_id(q, "v"), expected.v[rows], subject.speed),
        (by_id(q, "F"), expected.F[rows], 1.0),
        (by_id(q, "sigma"), expected.sigma[rows], subject.stress),
    ]
    return Tested(f"friction_step {variant}", farthest(pairs), bound(4 * subject.support), Part.FRICTION)


class Known(Walls):
    """Walls of a step whose friction is written out below: a left one and a floor, of SIDES."""

    def __init__(self, nodes: Floats) -> None:
        super().__init__(np.zeros(nodes.shape, bool), np.zeros(nodes.shape), np.zeros(nodes.shape), stops=True)
        self.near = nodes < 1e-9 * DX  # left wall, floor
        self.strains = np.zeros(nodes.shape, bool)  # nothing touches before the first step

    def in_strain(self) -> tuple[NDArray[np.bool_], Floats, Floats]:
        """Components that have the wall's velocity."""
        return self.strains, np.zeros(self.held.shape), self.rate


@dataclass(frozen=True)
class Rubbed(Dense):
    """Formulas of a step beside walls with friction."""

    touches: dict[str, float] = field(default_factory=dict)

    def motion(self, w: Weights, momentum: Floats, force: Floats) -> tuple[Floats, Floats]:
        """Velocity and acceleration of the nodes (n,2) at the end of the step, and what sticks, slips or leaves."""
        walls = self.model.walls
        assert isinstance(walls, Known)
        v = self.over_mass(w, momentum) + self.model.dt * self.over_mass(w, force)
        touches = walls.near & (v < 0)
        alone = touches & ~touches[:, ::-1]
        most = np.where(alone, -v * [SIDES[0], SIDES[2]], 0.0)[:, ::-1]  # of the other component
        other = alone[:, ::-1]
        sticks = other & (np.abs(v) <= most)
        walls.held[:] = touches | other
        walls.strains[:] = touches | sticks
        walls.value[:] = np.where(other & ~sticks, np.sign(v) * (np.abs(v) - most), 0.0)
        return super().motion(w, momentum, force)
