"""Rigid motion under uniform forces: fall, throw and oscillator, with damping, against sums over the steps."""

from collections.abc import Callable
from functools import partial
from math import pi

import numpy as np

from mpm_verify.cases.exact.body import DX, FILLED, Subject, Variant, by_id, layout, modelled, populated, variants
from mpm_verify.mms.constitutive.driver import random
from mpm_verify.mms.constitutive.tested import Part, Reason, Tested, attempt, bound, not_asked, off
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.energy_budget import Budget, kinetic, residual
from mpm_verify.solver.state import Floats, Particles
from mpm_verify.solver.step import Model, advance

PART = {True: Part.MOTION, False: Part.DAMPING}
STEPS, ALPHA = 6, 0.3
Force = Callable[[Floats, float], Floats]  # of the shift (2,) of the body and the time: force per mass (2,)


def tests(subject: Subject) -> list[Tested]:
    """Free fall with every step; a throw with each damping, and an oscillator."""
    c, dt = subject.speed, subject.dt
    g, more = 0.02 * c / dt * np.array([0.2, -0.9]), 0.003 * c / dt**2 * np.array([0.4, 0.5])
    thrown = c * np.array([0.3, 0.12])

    def growing(shift: Floats, t: float) -> Floats:
        return g + more * t

    def spring(shift: Floats, t: float) -> Floats:
        return -((2 * pi / (8.3 * dt)) ** 2) * (shift - 0.1 * DX)

    asked: list[tuple[str, Variant, Damping | None, Force, Floats]] = [
        ("fall", variant, None, growing, thrown) for variant in variants()
    ]
    found = [one for v in variants() for one in attempt(f"budget {v}", Part.BUDGET, partial(budget, subject, v))]
    for kind in ("local", "objective"):
        damping = Damping(ALPHA, kind)
        asked.append((f"throw_damped_{kind}", Variant(), damping, growing, thrown))
        asked.append((f"oscillator_{kind}", Variant(), damping, spring, 0 * thrown))
    for one in asked:
        found += attempt(f"{one[0]} {one[1]}", PART[one[2] is None], partial(rigid, subject, *one))
    return found


def budget(subject: Subject, variant: Variant) -> Tested:
    """Energies of a body between walls, struck, under gravity and damped: their sum over the kinetic energy."""
    name, rate = f"budget {variant}", subject.material.rate
    if rate is None or variant.stress != "usl":
        return not_asked(name, Part.BUDGET, Reason.NO_RATE_FORM if rate is None else Reason.BUDGET)
    p = populated(subject, layout(filled=True), np.eye(2))
    p.v[:] = 0.02 * subject.speed * random(len(p), 2)
    g = np.array([0.0, -0.01 * subject.speed**2 / DX])
    model = modelled(subject, p, variant, ("roller", "free", "fixed", "free"), FILLED, damping=Damping(ALPHA))
    known = Budget(g, kinetic(p))
    model.watch(known)
    rows = [known.terms(model)]
    for _ in range(STEPS):
        advance(model, lambda particles, t: np.copyto(particles.b, np.broadcast_to(g, particles.b.shape)))
        rows.append(known.terms(model))
    scale = max(map(abs, rows[0].values()))
    worst = max(off(residual(row, rows[0]), 0.0, scale) for row in rows)
    return Tested(name, worst, bound(2 * STEPS * subject.support), Part.BUDGET)


def rigid(subject: Subject, name: str, variant: Variant, damping: Damping | None, force: Force, v0: Floats) -> Tested:
    """Test of a body that moves as one: x, v, F and sigma of all particles against a sum over the steps."""
    p = populated(subject, layout(), np.eye(2))
    p.v[:] = v0
    model = modelled(subject, p, variant, damping=damping)
    X, v, shift = by_id(p, "x"), v0.copy(), np.zeros(2)
    worst = 0.0
    for step in range(STEPS):
        acceleration = force(shift, step * model.dt)
        advance(model, loaded(force, X))
        v = v + model.dt * (acceleration - taken(damping, acceleration, v))
        shift = shift + model.dt * v
        worst = max(
            worst, off(by_id(p, "x"), X + shift, DX), off(by_id(p, "v"), v, subject.speed), still(subject, model)
        )
    return Tested(f"{name} {variant}", worst, bound(2 * STEPS * subject.support), PART[damping is None])


def loaded(force: Force, X: Floats) -> Callable[[Particles, float], None]:
    """Load of a force per mass on all particles, by the mean shift of the body from X."""

    def load(particles: Particles, t: float) -> None:
        particles.b[:] = force((particles.x - X[particles.id]).mean(axis=0), t)

    return load


def taken(damping: Damping | None, f: Floats, v: Floats) -> Floats:
    """Force per mass (2,) that damping takes, by the velocity before the step."""
    if damping is None:
        return 0 * f
    if damping.kind == "local":
        return damping.alpha * np.abs(f) * np.sign(v)
    speed = float(np.hypot(*v))
    return damping.alpha * float(np.hypot(*f)) / speed * v if speed else 0 * f


def still(subject: Subject, model: Model) -> float:
    """Distance of F from the unit tensor, and of sigma from zero over rho0 c^2."""
    p = model.particles
    return max(off(p.F, np.eye(2), 1.0), off(p.sigma, 0.0, subject.stress))
