"""Weights of the basis on a strained body: what every basis reproduces, the domains that it averages over, and sums."""

from functools import partial

import numpy as np

from mpm_verify.cases.exact.body import (
    DX,
    STRAINED,
    Subject,
    Variant,
    carried,
    deformed,
    layout,
    modelled,
    populated,
    shaken,
)  # fmt: skip
from mpm_verify.cases.exact.dense import weights
from mpm_verify.mms.constitutive.driver import random
from mpm_verify.mms.constitutive.tested import Pairs, Part, Reason, Tested, attempt, bound, farthest, not_asked, off
from mpm_verify.solver.state import Floats
from mpm_verify.solver.step import Model, particles_to_grid


def tests(subject: Subject) -> list[Tested]:
    """Moments of the weights, domains, and sums over the nodes with each transfer that adds to them."""
    model = modelled(subject, populated(subject, layout(), STRAINED), Variant())
    found = attempt("moments", Part.WEIGHTS, partial(moments, subject, model))
    found += attempt("positive", Part.WEIGHTS, partial(positive, subject, model))
    found += attempt("domain_moment", Part.DOMAINS, partial(domain_moment, subject, model))
    found += attempt("domain_area", Part.DOMAINS, partial(areas, subject, model))
    for transfer in ("flip", "apic"):
        found += attempt(f"sum_mass {transfer}", Part.TO_GRID, partial(balances, subject, Variant(transfer)))
    return found


def moments(subject: Subject, model: Model, F: Floats = STRAINED) -> Tested:
    """Sums of N, dN, N x and dN x: 1, 0, the particle's position and the unit tensor."""
    p = model.particles
    w, away = weights(model, p.x, p.F), (carried(subject, model.grid.nodes, F) - 1.5) / DX
    L = np.einsum("pnb,na->pab", w.dN * DX, away)
    pairs: Pairs = [
        (w.N.sum(axis=1), 1.0, 1.0),
        ((w.dN * DX).sum(axis=1), 0.0, 1.0),
        (w.N @ away, (p.x - 1.5) / DX, 1.0),
        (L, np.eye(2), 1.0),
    ]
    return Tested("moments", farthest(pairs), bound(4 * subject.support), Part.WEIGHTS)


def positive(subject: Subject, model: Model) -> Tested:
    """Shape values are not negative, and so no node is outside the support."""
    if not subject.basis.positive:
        return not_asked("positive", Part.WEIGHTS, Reason.NEGATIVE)
    least = weights(model, model.particles.x, model.particles.F).N.min()
    return Tested("positive", off(min(least, 0.0), 0.0, 1.0), bound(1), Part.WEIGHTS)


def domain_moment(subject: Subject, model: Model) -> Tested:
    """Sum of N x y: the mean of x y over the corners of the domain that the layout and F make, or at the particle."""
    p, motion = model.particles, subject.basis.domain_motion
    w, nodes = weights(model, p.x, p.F), model.grid.nodes / DX
    x = subject.basis.on_grid(p) / DX
    expected = x[:, 0] * x[:, 1]
    if motion == "deformed":
        if subject.basis.cut(p.F, p.domain, DX).any():
            return not_asked("domain_moment", Part.DOMAINS, Reason.CUT)
        r = np.einsum("ab,psb->psa", STRAINED, layout().r0[p.id]) / DX
        expected = expected + r[:, 0, 0] * r[:, 0, 1] + r[:, 1, 0] * r[:, 1, 1]
    found = w.N @ (nodes[:, 0] * nodes[:, 1])
    return Tested("domain_moment", off(found, expected, 100.0), bound(4 * subject.support), Part.DOMAINS)


def areas(subject: Subject, model: Model) -> list[Tested]:
    """Areas of the domains against the volumes that they stand for, and corners at those of the pieces, deformed."""
    p, basis = model.particles, subject.basis
    corners = basis.corners(p.x, p.F, p.domain, DX)
    if corners is None or not basis.domain_motion:
        return [not_asked(name, Part.DOMAINS, Reason.NO_DOMAINS) for name in ("domain_area", "shared_corners")]
    if basis.cut(p.F, p.domain, DX).any():
        return [not_asked(name, Part.DOMAINS, Reason.CUT) for name in ("domain_area", "shared_corners")]
    ratio = {"fixed": 1.0, "stretched": abs(STRAINED[0, 0] * STRAINED[1, 1]), "deformed": np.linalg.det(STRAINED)}
    found = off(area(corners), p.V0 * ratio[basis.domain_motion], DX**2)
    tested = [Tested("domain_area", found, bound(16), Part.DOMAINS)]
    if basis.domain_motion != "deformed":
        return [*tested, not_asked("shared_corners", Part.DOMAINS, Reason.NOT_FOLLOWED)]
    expected = deformed(STRAINED)(layout().corners[p.id].reshape(-1, 2)).reshape(-1, 4, 2)
    apart = np.linalg.norm(corners[:, :, None] - expected[:, None], axis=-1)  # in any order
    gap = max(apart.min(axis=1).max(), apart.min(axis=2).max())
    return [*tested, Tested("shared_corners", off(gap, 0.0, DX), bound(16), Part.DOMAINS)]


def area(corners: Floats) -> Floats:
    """Areas (P,) of quadrilaterals (P,4,2), counter-clockwise."""
    one, two = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    found: Floats = 0.5 * (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    return found


def balances(subject: Subject, variant: Variant, F: Floats = STRAINED) -> list[Tested]:
    """Sums over the nodes and their first moments against those of the particles; the work of forces on L x + c.

    Of reference nodes moments are those of X, and the work is that of the first Piola-Kirchhoff stress on L X + c.
    """
    p = shaken(subject, populated(subject, layout(), F))
    model = modelled(subject, p, variant)
    p, g, c, rho = model.particles, model.grid, subject.speed, subject.material.rho0
    affine = 0.02 * c * DX * random(len(p), 4, seed=5) if p.affine_velocity.size else np.zeros((len(p), 4))
    if p.affine_velocity.size:
        p.affine_velocity[:] = affine
    particles_to_grid(model)
    V = p.V0 * p.J
    plane = p.sigma[:, [0, 3, 3, 1]].reshape(-1, 2, 2)
    if subject.basis.reference:
        plane = plane @ np.linalg.inv(p.F).transpose(0, 2, 1)
    unit = rho * DX**2  # mass of a cell
    centre = (subject.basis.on_grid(p) - 1.5) / DX
    nodes = (g.nodes - 1.5) / DX
    virtual = np.einsum("na,nb->ab", g.force, nodes) * DX
    work = -np.einsum("p,pab->ab", V, plane) + np.einsum("pa,pb->ab", p.m[:, None] * p.b, centre) * DX
    moment = np.einsum("pa,pb->ab", p.m[:, None] * p.v, centre)
    turned = affine.reshape(-1, 2, 2) * (p.m / DX)[:, None, None]
    pairs = {
        "sum_mass": [(g.mass.sum(), p.m.sum(), unit), (nodes.T @ g.mass, centre.T @ p.m, unit)],
        "sum_momentum": [
            (g.momentum.sum(axis=0), (p.m[:, None] * p.v).sum(axis=0), unit * c),
            (np.einsum("na,nb->ab", g.momentum, nodes), moment + turned.sum(axis=0), unit * c),
        ],
        "sum_force": [(g.force.sum(axis=0), (p.m[:, None] * p.b).sum(axis=0), unit * c * c / DX)],
        "virtual_work": [(virtual, work, unit * c * c)],
    }
    return [
        Tested(f"{name} {variant.transfer}", farthest(found), bound(subject.support + 10),
               Part.TO_GRID)
        for name, found in pairs.items()
    ]  # fmt: skip
