"""One step from a generic strained state: against formulas with full matrices, and in a grid that moves affinely."""

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.exact.body import (
    BLEND,
    DX,
    FILLED,
    STRAINED,
    STRESS_UPDATES,
    Subject,
    Variant,
    by_id,
    carried,
    layout,
    modelled,
    populated,
    rest,
    ruled,
    shaken,
    variants,
)  # fmt: skip
from mpm_verify.cases.exact.dense import Dense, Sigma
from mpm_verify.mms.constitutive.driver import random
from mpm_verify.mms.constitutive.tested import Pairs, Part, Reason, Tested, attempt, bound, farthest, not_asked, off
from mpm_verify.solver.state import Floats
from mpm_verify.solver.step import Model, advance
from mpm_verify.solver.weights import Basis

RATE = np.array([[0.3, -0.9], [0.7, -0.4]])  # L of the affine velocity, over c / dx / 10
CORNERS = 8  # numbers of a domain that has corners of its own, and need not be a parallelogram
DRIFT = np.array([0.11, -0.07])  # its velocity at the middle, over c


def tests(subject: Subject) -> list[Tested]:
    """Every transfer and stress update in each test."""
    found: list[Tested] = []
    for variant in (*variants(), *(Variant(BLEND, stress) for stress in STRESS_UPDATES)):
        if variant.transfer.partition(":")[0] in KNOWN:
            found += attempt(f"step {variant}", Part.STEP, partial(formulas, subject, variant))
        found += attempt(f"affine {variant}", Part.TO_PARTICLES, partial(affine, subject, variant))
    return found


Field = Callable[[Floats], Floats]
KNOWN = ("flip", "pic", "apic", "fmpm")  # transfers whose formulas stand in dense.py


def formulas(subject: Subject, variant: Variant) -> Tested:
    """Step of random v, F, sigma and b with a wall that moves, which hands its reaction on, or does not."""
    pairs = [pair for stops in (False, True) for pair in held_against(subject, variant, stops)]
    return Tested(f"step {variant}", farthest(pairs), bound(4 * subject.support), Part.STEP)


def held_against(subject: Subject, variant: Variant, stops: bool) -> "Pairs":
    """x, v, F, sigma and B after such a step beside those of full matrices, each with its scale."""
    p = shaken(subject, populated(subject, layout(filled=True), np.eye(2)))
    if p.domain.shape[1] == CORNERS:
        p.domain += 0.04 * DX * random(len(p), CORNERS, seed=17)
    model = modelled(subject, p, variant, ("roller", "free", "fixed", "free"), FILLED)
    model.walls.value[:], model.walls.rate[:] = 0.02 * subject.speed, 0.1 * subject.speed**2 / DX
    model.walls.stops = stops
    model.particles.affine_velocity *= 0
    if model.particles.affine_velocity.size:
        model.particles.affine_velocity += 0.01 * subject.speed * DX * random(len(p), 4, seed=4)
    b, dense = by_id(model.particles, "b"), Dense(model, variant.flip)
    order = model.particles.id.copy()
    expected = dense.step(model.particles.b.copy(), Sigma(model))
    advance(model, lambda particles, t: np.copyto(particles.b, b[particles.id]))
    rows = np.argsort(order)
    q, c = model.particles, subject.speed
    pairs: Pairs = [
        (by_id(q, "x"), expected.x[rows], DX),
        (by_id(q, "v"), expected.v[rows], c),
        (by_id(q, "F"), expected.F[rows], 1.0),
        (by_id(q, "sigma"), expected.sigma[rows], subject.stress),
    ]
    if dense.affine:
        pairs.append((by_id(q, "affine_velocity").reshape(-1, 2, 2), expected.B[rows], c * DX))
    return pairs


def affine(subject: Subject, variant: Variant) -> list[Tested]:
    """Step of a strained body in a grid whose nodes all move with L x + c, and accelerate so: all is affine."""
    c, dt, middle = subject.speed, subject.dt, np.array([1.5, 1.35])
    L, speed = 0.1 * c / DX * RATE, c * DRIFT
    pull, drag = 0.05 * c / dt / DX * RATE.T, 0.03 * c / dt * DRIFT[::-1]

    def velocity(x: Floats) -> Floats:
        return np.asarray(speed + (x - middle) @ L.T)

    def acceleration(x: Floats) -> Floats:
        return np.asarray(drag + (x - middle) @ pull.T)

    def rule(x: Floats, t: float, step: float) -> tuple[NDArray[np.bool_], Floats, Floats]:
        """Grid of the first step alone: one that is not moved, or at another time, has another velocity."""
        x = carried(subject, x, STRAINED)
        return np.ones(x.shape, bool), (1 + t / dt) * (step / dt) * velocity(x), acceleration(x)

    walls = ruled(rule)
    p = shaken(subject, populated(subject, layout(), STRAINED), strain=0.0)
    model = modelled(subject, p, variant, walls)
    x, v, F = (by_id(model.particles, name) for name in ("x", "v", "F"))
    corners = subject.basis.corners(x, F, by_id(model.particles, "domain"), DX)
    advance(model, rest)
    q, flip = model.particles, variant.flip
    strain = L - dt * pull if variant.stress == "usf" else L
    pairs: Pairs = [
        (by_id(q, "x"), x + dt * velocity(x), DX),
        (by_id(q, "v"), flip * (v + dt * acceleration(x)) + (1 - flip) * velocity(x), c),
        (by_id(q, "F"), (np.eye(2) + dt * strain) @ F, 1.0),
    ]
    found = [Tested(f"affine {variant}", farthest(pairs), bound(4 * subject.support),
                    Part.TO_PARTICLES)]  # fmt: skip
    return [*found, domains(subject, variant, model, corners, velocity, np.eye(2) + dt * strain)]


def domains(
    subject: Subject, variant: Variant, model: Model, corners: Floats | None, velocity: Field, step: Floats
) -> Tested:
    """Corners of domains after the affine step: moved with the body, by F or as points of the grid."""
    name, p = f"domain_motion {variant}", model.particles
    if corners is None:
        return not_asked(name, Part.DOMAINS, Reason.NO_DOMAINS)
    x, F, kept = (by_id(p, one) for one in ("x", "F", "domain"))
    if subject.basis.domain_motion != "deformed" or subject.basis.cut(F, kept, DX).any():
        cut = subject.basis.domain_motion == "deformed"
        return not_asked(name, Part.DOMAINS, Reason.CUT if cut else Reason.NOT_FOLLOWED)
    if type(subject.basis).convect is Basis.convect:
        moved = x[:, None] + (corners - corners.mean(axis=1)[:, None]) @ step.T
    else:
        moved = corners + model.dt * velocity(corners)
    return Tested(name, off(subject.basis.corners(x, F, kept, DX), moved, DX), bound(4 * subject.support), Part.DOMAINS)
