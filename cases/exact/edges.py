"""Edges that are pulled or driven: sums of their forces, and bodies of uniform stress that move on as they are."""

from functools import partial

import numpy as np

from mpm_verify.cases.exact.body import (
    CELLS,
    DX,
    STRAINED,
    Subject,
    Variant,
    by_id,
    carried,
    deformed,
    layout,
    modelled,
    populated,
    rest,
    variants,
)  # fmt: skip
from mpm_verify.mms.constitutive.driver import random
from mpm_verify.mms.constitutive.tested import Pairs, Part, Reason, Tested, attempt, bound, farthest, not_asked
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.sides import SIDES
from mpm_verify.solver.state import Floats, Particles
from mpm_verify.solver.step import advance
from mpm_verify.solver.surface import Given, Kind, Surface, faces

STEPS = 4
LATER = 3  # steps that have been done when sums are taken
THIN = 100.0  # masses of whole nodes over that of the lightest, whose velocity has that many times the rounding
NORMALS = {"right": (1.0, 0.0), "bottom": (0.0, -1.0)}  # of the sides whose sums are taken
DRIVEN = ("left", "top")  # sides that are prescribed where the others are pulled
RATE = np.array([[0.2, -0.5], [0.4, -0.3]])  # rate of F over c / dx / 10
DRIFT = np.array([0.13, -0.08])  # velocity over c
MIDDLE = 0.5 * DX * CELLS


def tests(subject: Subject) -> list[Tested]:
    """Sums; a stressed body that moves as one, with every step; one that is strained at a constant rate."""
    reason = exempt(subject)
    if reason is Reason.CUT:
        found = [not_asked("edge_sums", Part.EDGES, reason)]
    else:
        found = attempt("edge_sums", Part.EDGES, partial(sums, subject))
    for name, driven in (("edge_pulled", ()), ("edge_driven", DRIVEN)):
        if reason:
            found += [not_asked(test, Part.EDGES, reason) for test in (name, f"edge_affine {name}")]
            continue
        for variant in variants():
            found += attempt(f"{name} {variant}", Part.EDGES, partial(moved, subject, name, driven, variant))
        found += attempt(f"edge_affine {name}", Part.EDGES, partial(strained, subject, name, driven))
    return found


def exempt(subject: Subject) -> Reason | None:
    """Reason for which forces on the edge need not balance a uniform stress."""
    if not subject.basis.faces_carry:
        return Reason.POINTS
    p = populated(subject, layout(), STRAINED)
    return Reason.CUT if subject.basis.cut(p.F, p.domain, DX).any() else None


def edge(pieces: Layout, given: Given, driven: tuple[str, ...] = (), sides: tuple[str, ...] = SIDES) -> Surface:
    """Surface of sides of the body, those that are not `driven` pulled."""
    kinds: dict[str, Kind] = {side: "prescribed" if side in driven else "pulled" for side in sides}
    lower, upper = pieces.corners.min(axis=(0, 1)), pieces.corners.max(axis=(0, 1))
    return Surface(faces(pieces, lower, upper, kinds), given)


def sums(subject: Subject) -> Tested:
    """Sum of nodal forces and their first moment, of two sides: integrals of a P that is linear in X and grows."""
    pieces, growth = layout(), 0.7 / subject.dt
    P0, G = (subject.stress * random(*shape, seed=6) for shape in ((2, 2), (2, 2, 2)))
    position = deformed(STRAINED)

    def stress(X: Floats, t: float) -> Floats:
        return np.asarray((1.0 + growth * t) * (P0 + np.einsum("abc,sc->sab", G, (X - MIDDLE) / DX)))

    model = modelled(subject, mixed(populated(subject, pieces, STRAINED)), Variant())
    model.surface = edge(pieces, Given(stress, lambda X, t: position(X)), sides=tuple(NORMALS))
    model.steps = LATER
    model.grid.momentum_force[:] = 0.0
    model.surface.act(model)
    force, moment = np.zeros(2), np.zeros((2, 2))
    for side, N in NORMALS.items():
        X, length = along(pieces, side)
        traction = stress(X, LATER * subject.dt) @ np.array(N)
        force += length @ traction
        moment += np.einsum("s,sa,sb->ab", length, traction, position(X) - MIDDLE)
    nodes = carried(subject, model.grid.nodes, STRAINED)
    found = np.einsum("na,nb->ab", model.grid.force, nodes - MIDDLE)
    whole = subject.stress * 4 * DX
    pairs: Pairs = [(model.grid.force.sum(axis=0), force, whole), (found, moment, whole * DX)]
    return Tested("edge_sums", farthest(pairs), bound(8 * subject.support), Part.EDGES)


def along(pieces: Layout, side: str) -> tuple[Floats, Floats]:
    """Four points (4,2) of Gauss on a whole side, and the length that each stands for."""
    lower, upper = pieces.corners.min(axis=(0, 1)), pieces.corners.max(axis=(0, 1))
    axis, end = SIDES.index(side) // 2, (lower, upper)[SIDES.index(side) % 2]
    at, weight = np.polynomial.legendre.leggauss(4)
    X = 0.5 * (lower + upper) + 0.5 * at[:, None] * (upper - lower)
    X[:, axis] = end[axis]
    return X, 0.5 * weight * (upper - lower)[1 - axis]


def mixed(p: Particles) -> Particles:
    """Particles in another order than that of their layout, as a run may put them."""
    p.reorder(np.arange(len(p))[::-1])
    return p


def stressed(subject: Subject, p: Particles) -> Floats:
    """Give particles the stress of their F, of a material in rate form a small one, and return their P (2,2)."""
    p.sigma[:] = 1e-3 * subject.stress * np.array([-1.0, -1.2, -1.1, 0.15])
    subject.material.start(p)
    subject.material.update(p, subject.dt)
    return piola(p.sigma[0], p.F[0])


def piola(sigma: Floats, F: Floats) -> Floats:
    """First Piola stress (2,2) of a Cauchy stress (4,) and F (2,2)."""
    P: Floats = np.linalg.det(F) * sigma[[0, 3, 3, 1]].reshape(2, 2) @ np.linalg.inv(F).T
    return P


def moved(subject: Subject, name: str, driven: tuple[str, ...], variant: Variant) -> Tested:
    """Body of uniform stress and velocity, its edges pulled by that stress or driven by that velocity: nothing else."""
    v, pieces, p = subject.speed * DRIFT, layout(), populated(subject, layout(), STRAINED)
    P = stressed(subject, p)
    given = Given(lambda X, t: np.broadcast_to(P, (len(X), 2, 2)), lambda X, t: deformed(STRAINED)(X) + t * v)
    p.v[:] = v
    x, sigma = by_id(p, "x"), by_id(p, "sigma")
    model = modelled(subject, mixed(p), variant, surface=edge(pieces, given, driven))
    for _ in range(STEPS):
        advance(model, rest)
    pairs: Pairs = [
        (by_id(model.particles, "x"), x + model.time * v, DX),
        (by_id(model.particles, "v"), v, subject.speed),
        (by_id(model.particles, "F"), STRAINED, 1.0),
        (by_id(model.particles, "sigma"), sigma, subject.stress),
    ]
    return Tested(f"{name} {variant}", farthest(pairs), THIN * bound(STEPS * subject.support), Part.EDGES)


def strained(subject: Subject, name: str, driven: tuple[str, ...]) -> Tested:
    """Step of a body whose F grows steadily, in affine velocities that APIC gives the nodes: without acceleration.

    One step: in the next, APIC has the gradient of the velocity of this one.
    """
    test = f"edge_affine {name}"
    if subject.material.rate is not None:
        return not_asked(test, Part.EDGES, Reason.NO_ENERGY)
    pieces, rate = layout(), 0.1 * subject.speed / DX * RATE
    sample = populated(subject, pieces, STRAINED)

    def F_at(t: float) -> Floats:
        return np.asarray(STRAINED + t * rate)

    def stress(X: Floats, t: float) -> Floats:
        sample.F[:] = F_at(t)
        subject.material.update(sample, subject.dt)
        return np.broadcast_to(piola(sample.sigma[0], F_at(t)), (len(X), 2, 2))

    given = Given(stress, lambda X, t: deformed(F_at(t))(X))
    p = populated(subject, pieces, STRAINED)
    stressed(subject, p)
    p.v[:] = (p.X - MIDDLE) @ rate.T
    model = modelled(subject, mixed(p), Variant("apic"), surface=edge(pieces, given, driven))
    L = rate @ np.linalg.inv(STRAINED)
    model.scheme.transfer.start(model, lambda X: np.broadcast_to(L, (len(X), 2, 2)))
    advance(model, rest)
    F = F_at(model.time)
    pairs: Pairs = [
        (by_id(model.particles, "x"), deformed(F)(by_id(model.particles, "X")), DX),
        (by_id(model.particles, "v"), (by_id(model.particles, "X") - MIDDLE) @ rate.T, subject.speed),
        (by_id(model.particles, "F"), F, 1.0),
    ]
    return Tested(test, farthest(pairs), THIN * bound(4 * subject.support), Part.EDGES)
