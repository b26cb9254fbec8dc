"""No force: velocities stay as they are, whatever walls hold; and sliding along rollers."""

from dataclasses import dataclass
from functools import partial
from typing import get_args

import numpy as np

from mpm_verify.cases.exact.body import (
    DX,
    FILLED,
    FREE,
    Subject,
    Variant,
    by_id,
    grid,
    layout,
    modelled,
    populated,
    rest,
    variants,
)
from mpm_verify.mms.constitutive.driver import random
from mpm_verify.mms.constitutive.tested import FAILED, Part, Reason, Tested, attempt, bound, not_asked, off
from mpm_verify.solver.boundary import Kind, box
from mpm_verify.solver.material_model import Material
from mpm_verify.solver.pushed import pushed
from mpm_verify.solver.reaction import Reaction
from mpm_verify.solver.state import Floats, Particles
from mpm_verify.solver.step import Load, advance

STEPS = 3


def tests(subject: Subject) -> list[Tested]:
    """Random velocities with each kind of wall, and a uniform one along rollers, with every step."""
    found = []
    for variant in variants():
        found += attempt(f"slide {variant}", Part.WALLS, partial(sliding, subject, variant))
        found += attempt(f"no_force_free {variant}", Part.WALLS, partial(forceless, subject, variant))
        found += attempt(f"reaction {variant}", Part.WALLS, partial(pushed_back, subject, variant))
        found += attempt(f"pushed {variant}", Part.WALLS, partial(driven, subject, variant))
    return found


def sliding(subject: Subject, variant: Variant) -> Tested:
    """Body between rollers that moves along them."""
    p = populated(subject, layout(filled=True), np.eye(2))
    p.v[:] = v = subject.speed * np.array([0.0, 0.1])
    advance(modelled(subject, p, variant, ("roller", "roller", "free", "free"), FILLED), rest)
    return Tested(f"slide {variant}", off(p.v, v, subject.speed), bound(subject.support), Part.WALLS)


def forceless(subject: Subject, variant: Variant) -> list[Tested]:
    """Body without stress, each particle with a velocity of its own, in a box of each kind."""
    found = []
    for kind in get_args(Kind):
        name = f"no_force_{kind} {variant}"
        if variant.flip < 1:
            found.append(not_asked(name, Part.WALLS, Reason.BLENDS))
            continue
        p = populated(subject, layout(filled=True), np.eye(2))
        p.v[:] = v = 0.05 * subject.speed * random(len(p), 2)
        model = modelled(subject, p, variant, kind, FILLED)
        model.material = Powerless(subject.speed)
        advance(model, rest)
        found.append(Tested(name, off(by_id(p, "v"), v, subject.speed), bound(1), Part.WALLS))
    return found


def uniform(force: Floats) -> Load:
    """Load of a force per mass (2,) on all particles."""

    def load(particles: Particles, t: float) -> None:
        particles.b[:] = force

    return load


def driven(subject: Subject, variant: Variant) -> Tested:
    """Body all of whose nodes are pushed along an axis, faster and faster, and fall along the other unless it is rough.

    After each step the particles have the velocity that the nodes had in it, and have gone as far.
    """
    worst, c, dt = 0.0, subject.speed, subject.dt
    g, fell = 0.02 * c / dt, np.arange(1.0, STEPS + 1)

    def travel(t: float) -> float:
        return 0.1 * c * t * (1 + t / (3 * dt) - (t / (7 * dt)) ** 2)

    gone = np.array([travel(n * dt) for n in range(-1, STEPS + 1)])
    for axis, rough in ((0, False), (1, False), (0, True)):
        p = populated(subject, layout(), np.eye(2))
        p.v[:, axis] = (gone[1] - gone[0]) / dt
        free = box(grid(), FREE)
        walls = pushed(free, np.ones(len(free.held), bool), axis, travel, rough)
        model = modelled(subject, p, variant, walls)
        x, force = by_id(p, "x"), np.zeros(2)
        force[1 - axis] = g
        for _ in range(STEPS):
            advance(model, uniform(force))
        v, shift = np.zeros(2), np.zeros(2)
        v[axis], shift[axis] = (gone[-1] - gone[-2]) / dt, gone[-1] - gone[1]
        if not rough:
            v[1 - axis], shift[1 - axis] = g * dt * fell[-1], g * dt**2 * fell.sum()
        moved = by_id(model.particles, "x") - x
        worst = max(worst, off(moved, shift, DX), off(model.particles.v, v, c), off(model.particles.F, np.eye(2), 1.0))
    return Tested(f"pushed {variant}", worst, bound(2 * STEPS * subject.support), Part.WALLS)


def pushed_back(subject: Subject, variant: Variant) -> Tested:
    """Body between walls, struck, under a force: the reactions of a half of the nodes and of the other explain a step.

    Of the change of momentum over dt they are what the body force is not: inner forces cancel.
    """
    name = f"reaction {variant}"
    if variant.scheme.transfer.filters_walls:
        return not_asked(name, Part.WALLS, Reason.FILTERED)
    p = populated(subject, layout(filled=True), np.eye(2))
    p.v[:] = 0.05 * subject.speed * random(len(p), 2)
    p.sigma[:] = 1e-3 * subject.stress * (0.2 * random(len(p), 4, seed=3) - (1.0, 1.0, 1.0, 0.0))
    model = modelled(subject, p, variant, ("roller", "free", "fixed", "free"), FILLED)
    left = model.grid.nodes[:, 0] + 0.3 * model.grid.nodes[:, 1] < 0.3 * DX * FILLED.sum()
    halves = Reaction(left), Reaction(~left)
    model.watch(*halves)
    g = 0.5 * subject.speed**2 / DX * np.array([0.3, -0.8])
    p, m, before = model.particles, model.particles.m[:, None].copy(), model.particles.v.copy()
    order = p.id.copy()
    advance(model, uniform(g))
    change = (m * (by_id(p, "v")[order] - before)).sum(axis=0) / model.dt
    found = np.stack([one.force for one in halves])
    residual = off(found.sum(axis=0), change - m.sum() * g, float(m.sum()) * subject.speed / model.dt)
    acts = bool((np.abs(found).max(axis=1) > 0).all())
    return Tested(name, residual if acts else FAILED, bound(4 * subject.support), Part.WALLS)


@dataclass(frozen=True)
class Powerless(Material):
    """Material that has no stress, whatever its strain; waves have the speed `c`."""

    c: float

    def update(self, particles: Particles, dt: float) -> None:
        """Write no stress."""
        particles.sigma[:] = 0.0

    def wave_speed(self, s: float | None = None) -> float:
        """Speed of the fastest wave, as given."""
        return self.c
