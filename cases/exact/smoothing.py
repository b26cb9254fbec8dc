"""Smoothing: cell means and nodal values against sums written out, constants, projection twice, and adjointness."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.exact.body import (
    DX,
    STRAINED,
    Subject,
    Variant,
    carried,
    layout,
    modelled,
    populated,
    rest,
    ruled,
    shaken,
)
from mpm_verify.cases.exact.groups import GROUPS
from mpm_verify.mms.constitutive.driver import drive, random
from mpm_verify.mms.constitutive.tested import FAILED, Part, Reason, Tested, attempt, bound, not_asked, off
from mpm_verify.solver.plugins import SMOOTHINGS, available, create
from mpm_verify.solver.smoothing._base import RATES
from mpm_verify.solver.state import Floats
from mpm_verify.solver.step import Model, advance

PROJECTIONS = ("cell", "node")
SUMMED = 32  # roundings of a sum over the particles of a cell, or of those around a node
PARTS = {"volumetric": (0,), "deviatoric": (1, 2), "full": (0, 1, 2)}  # of (xx + yy)/2, (xx - yy)/2, xy


def tests(subject: Subject) -> list[Tested]:
    """Every smoothing with each projection, for a material that smoothing takes."""
    names, rate = [name for name in available(SMOOTHINGS) if name in (*PARTS, "fbar")], subject.material.rate
    if rate is None:
        of_functions = attempt("smoothing_ratio fbar", Part.SMOOTHING, partial(ratio_of_F, subject))
        rest = [test for test in GROUPS["smoothing"] if test != "smoothing_ratio"]
        return of_functions + [not_asked(test, Part.SMOOTHING, Reason.NO_RATE_FORM) for test in rest]
    if rate not in RATES:
        return [not_asked(test, Part.SMOOTHING, Reason.OTHER_RATE) for test in GROUPS["smoothing"]]
    found: list[Tested] = []
    for where in PROJECTIONS:
        found += attempt(f"smoothing_means {where}", Part.SMOOTHING, partial(projected, subject, where))
        for name in names:
            told = f"{name} {where}"
            found += attempt(f"smoothing_uniform {told}", Part.SMOOTHING, partial(uniform, subject, name, where))
            if name in PARTS:
                found += attempt(f"smoothing_parts {told}", Part.SMOOTHING, partial(parts, subject, name, where))
    return found + attempt("smoothing_ratio fbar", Part.SMOOTHING, partial(ratio, subject))


def smoothed(subject: Subject, specification: str) -> Model:
    """Model with a smoothing, of particles with F, sigma and volumes of their own."""
    p = shaken(subject, populated(subject, layout(), STRAINED))
    return modelled(subject, p, Variant(), smoothing=create(SMOOTHINGS, specification))


def fractions(model: Model, where: str) -> Floats:
    """Weights (P,n) of the particles' centres: 1 at the lower left node of their cell, or hats of the four nodes."""
    g, p = model.grid, model.particles
    away = (model.basis.on_grid(p)[:, None] - g.nodes[None]) / g.dx
    if where == "cell":
        inside: Floats = ((away >= 0) & (away < 1)).all(axis=2).astype(float)
        return inside
    hats: Floats = np.maximum(1 - np.abs(away), 0).prod(axis=2)
    return hats


def means(model: Model, where: str, values: Floats) -> Floats:
    """Means by volume (P,C) of values (P,C): of each cell, or of the nodes and back."""
    H, V = fractions(model, where), (model.particles.V0 * model.particles.J)[:, None]
    volume = H.T @ V
    nodes = np.divide(H.T @ (V * values), volume, out=np.zeros((H.shape[1], values.shape[1])), where=volume > 0)
    found: Floats = H @ nodes
    return found


def projected(subject: Subject, where: str) -> list[Tested]:
    """Projection alone: means, constants, adjoint to itself by volume, and twice as once."""
    model = smoothed(subject, f"volumetric:where={where}")
    p, smoothing = model.particles, model.smoothing
    assert smoothing is not None
    V, x = (p.V0 * p.J)[:, None] / DX**2, subject.basis.on_grid(p)
    a, b = random(len(p), 3, seed=13), random(len(p), 3, seed=14)
    first, other = smoothing.project(model, x, a.copy()), smoothing.project(model, x, b.copy())
    kept = smoothing.project(model, x, np.full((len(p), 1), 0.7))
    pairs = {
        "means": (first, means(model, where, a)),
        "constants": (kept, 0.7),
        "adjoint": ((V * a * other).sum(axis=0), (V * b * first).sum(axis=0)),
        "twice": (smoothing.project(model, x, first.copy()), first),
    }
    return [
        not_asked(f"smoothing_{name} {where}", Part.SMOOTHING, Reason.FILTER)
        if (name, where) == ("twice", "node")
        else Tested(f"smoothing_{name} {where}", off(*pair, 1.0), bound(SUMMED), Part.SMOOTHING)
        for name, pair in pairs.items()
    ]


def parts(subject: Subject, name: str, where: str) -> Tested:
    """Stress of the forces: the parts that a smoothing names are projected by the fraction beta, and no other."""
    model = smoothed(subject, f"{name}:where={where}")
    p, smoothing = model.particles, model.smoothing
    assert smoothing is not None
    unit = 1e-3 * subject.stress
    smoothing.stress(model)
    split = np.stack([p.sigma[:, 0] + p.sigma[:, 1], p.sigma[:, 0] - p.sigma[:, 1], 2 * p.sigma[:, 3]], axis=1) / 2
    chosen = list(PARTS[name])
    split[:, chosen] += smoothing.beta * (means(model, where, split)[:, chosen] - split[:, chosen])
    plane = [split[:, 0] + split[:, 1], split[:, 0] - split[:, 1], p.sigma[:, 2], split[:, 2]]
    return Tested(f"smoothing_parts {name} {where}", off(p.sigma_smoothed, np.stack(plane, axis=1), unit),
                  bound(SUMMED), Part.SMOOTHING)  # fmt: skip


def ratio(subject: Subject) -> Tested:
    """F-bar: volume ratios of the step are the projected ones, and F is scaled alike in both directions."""
    model = smoothed(subject, "fbar")
    p, smoothing = model.particles, model.smoothing
    assert smoothing is not None
    p.F[:] = (np.eye(2) + 0.01 * random(len(p), 2, 2, seed=15)) @ p.F
    before = p.F_old.reshape(-1, 2, 2)
    step = np.linalg.det(p.F) / np.linalg.det(before)
    now = p.F.copy()
    p.F[:] = before  # volumes are those of the start of the step
    mean = means(model, smoothing.where, step[:, None])[:, 0]
    p.F[:] = now
    found = smoothing.strain(model, subject.basis.on_grid(p))
    expected = np.sqrt(1 + smoothing.beta * (mean / step - 1))[:, None, None] * now
    return Tested("smoothing_ratio fbar", FAILED if found is None else off(found, expected, 1.0), bound(SUMMED),
                  Part.SMOOTHING)  # fmt: skip


def ratio_of_F(subject: Subject) -> list[Tested]:
    """F-bar of a function of F: the stress after a step is that of F with the projected det F, by initial volumes."""
    found = []
    for where in PROJECTIONS:
        model = smoothed(subject, f"fbar:where={where}")
        advance(model, rest)
        p = model.particles
        H, V0 = fractions(model, where), p.V0[:, None]
        volume = H.T @ V0
        nodes = np.divide(H.T @ (V0 * p.J[:, None]), volume, out=np.zeros_like(volume), where=volume > 0)
        bar = np.sqrt((H @ nodes)[:, 0] / p.J)[:, None, None] * p.F
        known = drive(subject.material, [bar], np.zeros_like(p.sigma)).sigma
        name = f"smoothing_ratio fbar {where}"
        found.append(Tested(name, off(p.sigma, known, subject.stress), bound(SUMMED), Part.SMOOTHING))
    return found


def uniform(subject: Subject, name: str, where: str) -> Tested:
    """Uniform strain and stress: a step with smoothing gives the sigma of a step without."""
    L, middle = 0.02 * subject.speed / DX * np.array([[0.3, -0.9], [0.7, -0.4]]), np.array([1.5, 1.35])
    found = []

    def rule(x: Floats, t: float, dt: float) -> tuple[NDArray[np.bool_], Floats, Floats]:
        return np.ones(x.shape, bool), (carried(subject, x, STRAINED) - middle) @ L.T, np.zeros(x.shape)

    for smoothing in (None, create(SMOOTHINGS, f"{name}:where={where}")):
        walls = ruled(rule)
        p = populated(subject, layout(), STRAINED)
        p.sigma[:] = 1e-3 * subject.stress * np.array([-1.0, -0.9, -0.8, 0.05])
        advance(modelled(subject, p, Variant(), walls, smoothing=smoothing), rest)
        found.append(p.sigma.copy())
    return Tested(
        f"smoothing_uniform {name} {where}", off(found[0], found[1], subject.stress), bound(SUMMED), Part.SMOOTHING
    )
