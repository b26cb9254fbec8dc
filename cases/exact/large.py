"""Bodies that are deformed far: domains of several cells, behind walls too, and forces of pressed and dilated ones."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.exact.body import DX, FILLED, Subject, Variant, layout, modelled, populated
from mpm_verify.cases.exact.dense import weights
from mpm_verify.cases.exact.weights import balances, moments
from mpm_verify.mms.constitutive.driver import random, turn
from mpm_verify.mms.constitutive.tested import FAILED, Part, Reason, Tested, attempt, bound, farthest, not_asked
from mpm_verify.solver._jit import BLOCK
from mpm_verify.solver.state import Floats
from mpm_verify.solver.step import Model

BEHIND = 2.0  # cells behind its walls that a grid has
STRETCHED = 8.0  # most that sides of domains grow by
THIN = 0.5  # det F below which gradients lose digits
FAR = {"pressed": np.array([[0.45, 0.06], [-0.09, 0.4]]), "dilated": np.array([[1.9, 0.3], [-0.2, 1.8]])}  # F


def tests(subject: Subject) -> list[Tested]:
    """Weights at walls and of wide domains, which of those are refused, and work of small and large volumes."""
    found = attempt("wall_moments", Part.WEIGHTS, partial(at_walls, subject))
    found += attempt("wide_moments", Part.DOMAINS, partial(wide, subject))
    for name, F in FAR.items():
        found += attempt(f"far_work {name}", Part.TO_GRID, partial(work, subject, name, F))
    return found


def at_walls(subject: Subject) -> Tested:
    """Sums of N, dN, N x and dN x of a body up to the walls."""
    model = modelled(subject, populated(subject, layout(filled=True), np.eye(2)), Variant(), cells=FILLED)
    found = moments(subject, model, np.eye(2))
    return Tested("wall_moments", found.residual, found.bound, Part.WEIGHTS)


def wide(subject: Subject) -> list[Tested]:
    """Domains that grow, turn and shear, each in its own way: those with a corner beyond the grid are refused.

    The others have weights as any, whose first moments are 1, 0 and the unit tensor, of N the position of the domain.
    """
    names, basis = ("wide_moments", "domain_reach"), subject.basis
    p = populated(subject, layout(filled=True), np.eye(2))
    if basis.domain_motion != "deformed":
        return [not_asked(name, Part.DOMAINS, Reason.NOT_FOLLOWED) for name in names]
    count = len(p)
    p.F[:] = np.eye(2) + (STRETCHED - 1) * random(count, 2, 2, seed=51)
    p.F[np.linalg.det(p.F) < 0] *= np.array([-1.0, 1.0])
    p.F[np.linalg.det(p.F) < THIN] = STRETCHED * turn(1.0)
    if p.domain.shape[1] == 8:
        r = np.einsum("pab,psb->psa", p.F, layout(filled=True).r0)
        signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        p.domain[:] = (p.x[:, None] + np.einsum("cs,psa->pca", signs, r)).reshape(count, 8)
    if basis.cut(p.F, p.domain, DX).any():
        return [not_asked(name, Part.DOMAINS, Reason.CUT) for name in names]
    model = modelled(subject, p, Variant(), cells=FILLED)
    p, corners = model.particles, basis.corners(p.x, p.F, p.domain, DX)
    inside = ((corners >= -BEHIND * DX) & (corners < DX * (FILLED + BEHIND))).all(axis=(1, 2))
    wrong = int((inside != taken(model)).sum())
    told = Tested("domain_reach", float(wrong), 0.0, Part.DOMAINS)
    if wrong or not 0 < inside.sum() < count:
        return [Tested("wide_moments", FAILED, 0.0, Part.DOMAINS), told]
    for name in ("x", "F", "domain"):
        setattr(p, name, np.ascontiguousarray(getattr(p, name)[inside]))
    w, away = weights(model, p.x, p.F), model.grid.nodes / DX
    centre, (x, y) = corners[inside].mean(axis=1) / DX, np.moveaxis(corners[inside] / DX, -1, 0)
    worst = farthest([
        (w.N.sum(axis=1), 1.0, 1.0),
        ((w.dN * DX).sum(axis=1), 0.0, 1.0),
        (w.N @ away, centre, 1.0),
        (np.einsum("pnb,na->pab", w.dN * DX, away), np.eye(2), 1.0),
        (w.N @ (away[:, 0] * away[:, 1]), (x * y).mean(axis=1), 100.0),
    ])  # fmt: skip
    return [Tested("wide_moments", worst, bound(4 * subject.support), Part.DOMAINS), told]


def taken(model: Model) -> NDArray[np.bool_]:
    """Whether the fill takes each particle (P,)."""
    g, p, K = model.grid, model.particles, model.basis.support
    table, node = np.empty(3 * K * BLOCK), np.empty(K * BLOCK, np.int64)
    box = (0.0, g.nx - 1.0, 0.0, g.ny - 1.0)
    return np.array(
        [
            model.basis.fill(*(a.ravel() for a in arrays), *g.origin, 1 / g.dx, g.nx, g.ny, *box, table, node)
            for arrays in zip(p.x, p.F, p.domain, strict=True)
        ]
    )


def work(subject: Subject, name: str, F: Floats) -> Tested:
    """Sums over the nodes and work of the forces of a body that is pressed or dilated far: volumes as they are."""
    found = balances(subject, Variant(), F)
    worst = max(found, key=lambda one: one.over)
    return Tested(f"far_work {name}", worst.residual, worst.bound, Part.TO_GRID)
