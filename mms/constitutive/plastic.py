"""Return mapping of perfectly plastic soils: what the conditions of optimality leave, of many trial stresses.

What is known of a step is that the stress is admissible, and that what the strain has beyond the elastic one is a
non-negative combination of the flows of the surfaces that the stress has reached: none where it has reached none. The
surfaces are those of surfaces.py, the combination is sought by non-negative least squares (Lawson & Hanson 1974), and
nothing is known of regions, edges or an order of the principal stresses. A material is tested as it is given, and with
other parameters: without and with cohesion, cut-off, dilation and friction.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import product
from math import inf
from typing import Any

import numpy as np

from mpm_verify.mms.constitutive.driver import Subject, elastic, random, responded, symmetric
from mpm_verify.mms.constitutive.stress import CONFINED
from mpm_verify.mms.constitutive.surfaces import Surfaces, known_surfaces, surfaces
from mpm_verify.mms.constitutive.tested import Part, Reason, Tested, attempt, bound, not_asked, off
from mpm_verify.solver.state import Floats
from mpm_verify.solver.voids import parts_free

COUNT = 96  # states of random axes, a third of them on a surface
SIZES = (0.0, 0.3, 3.0, 30.0)  # of the elastic stress increments, over the confining stress
OPERATIONS = 64
CONES = ("plane_strain", "compression")
# Parameters beside those given, stresses over the confining one; what a class does not have is left out.
OTHER: tuple[dict[str, float], ...] = (
    {},
    {"c": 0.4, "sigma_t": 0.2, "psi": 12.0},
    {"c": 0.4, "sigma_t": 1e3, "psi": 20.0, "nu": 0.45},
    {"c": 0.4, "sigma_t": 1e3, "psi": 0.0},
    {"psi": 25.0, "nu": 0.0},
    {"psi": 20.0, "gamma_cv": 0.05},
    {"phi": 0.0, "psi": 0.0, "c": 1.0, "sigma_t": 0.3},
    {"phi": 0.0, "psi": 0.0, "c": 1.0, "sigma_t": 1e3},
)


def tests(subject: Subject) -> list[Tested]:
    """Stress and memory of steps from many states."""
    parts = {"return_mapping": Part.STRESS, "return_memory": Part.HISTORY}
    if reason := unknown(subject.material):
        return [not_asked(name, part, reason) for name, part in parts.items()]
    found: list[Tested] = []
    for told, material in variants(subject):
        found += attempt(f"return_mapping {told}", Part.STRESS, partial(mapping, Subject(material), told))
    return found


def unknown(material: Any) -> Reason | None:
    """Reason for which a material is not asked, if there is one."""
    if material.rate is None:
        return Reason.NO_RATE_FORM
    if material.friction_angle is None:
        return Reason.NO_FRICTION
    return Reason.NO_SURFACES if not known_surfaces(material) else None


def variants(subject: Subject) -> Iterator[tuple[str, Any]]:
    """Materials with other parameters, and what is other."""
    material, unit = subject.material, CONFINED * subject.stress
    for given, cone in product(OTHER, CONES if hasattr(material, "cone") else ("",)):
        other = {name: value for name, value in given.items() if hasattr(material, name)}
        if "psi" in other:
            other["psi"] = min(other["psi"], other.get("phi", material.phi))
        told = [*(f"{name}={value:g}" for name, value in other.items()), *([cone] if cone else [])]
        scaled = {name: value * unit if name in ("c", "sigma_t") else value for name, value in other.items()}
        more: dict[str, Any] = {"cone": cone} if cone else {}
        if hasattr(material, "void") and not parts_free(other.get("c", 0.0), other.get("sigma_t")):
            more["void"] = 0.0
        yield ",".join(told) or "as given", replace(material, **scaled, **more)


def mapping(subject: Subject, told: str) -> list[Tested]:
    """Steps of one material: what its stress and what its memory miss, the worst of all states."""
    material = subject.material
    known = surfaces(material)
    sigma, D = states(subject, known)
    history, ended = material.initial(sigma), getattr(material, "gamma_cv", inf) < inf
    if ended:
        history[::2, material.memory.index("gamma_p")] = 2 * material.gamma_cv
    end = responded(material, sigma, D, history)
    trial = sigma + elastic(material.lam, material.mu, D)
    values, axes = np.linalg.eigh(whole(trial))
    found = axes.transpose(0, 2, 1) @ whole(end.sigma) @ axes  # isotropic: its axes are those of the trial stress
    reached = np.einsum("pii->pi", found).copy()
    scale = (np.abs(values).max(axis=1) + np.abs(sigma).max(axis=1))[:, None]
    left = values - reached
    left -= material.lam / (3 * material.lam + 2 * material.mu) * left.sum(axis=1)[:, None]  # 2 mu times the strain
    flows = known.flow(values).copy()
    if ended:  # every second soil does not dilate any more
        flows[::2] = surfaces(replace(material, psi=0.0)).flow(values)[::2]
    admitted = np.max(known.excess(values), axis=1) <= 0
    told_stress = [
        (found - reached[:, :, None] * np.eye(3)).reshape(len(D), 9) / scale,
        np.maximum(known.excess(reached), 0.0) / scale,
        np.where(admitted[:, None], reached - values, 0.0) / scale,
        combined(known.excess(reached), flows, left, scale),
    ]
    most, memory = bound(OPERATIONS), end.history - history
    opened = memory[:, material.memory.index("eps_v_p")] + memory[:, material.memory.index("void")]
    sheared = memory[:, material.memory.index("gamma_p")]
    told_memory = [
        (left.sum(axis=1) - 2 * material.mu * opened) / scale[:, 0],
        (left[:, 2] - left[:, 0] - 2 * material.mu * sheared) / scale[:, 0],
    ]
    return [
        Tested(f"{name} {told}", max(off(one, 0.0, 1.0) for one in all_), most, part)
        for name, part, all_ in (
            ("return_mapping", Part.STRESS, told_stress),
            ("return_memory", Part.HISTORY, told_memory),
        )
    ]


def combined(excess: Floats, flows: Floats, left: Floats, scale: Floats) -> Floats:
    """Distances (P,) of plastic strains `left` (P,3) from all non-negative combinations of flows (P,n,3) that act."""
    from scipy.optimize import nnls

    active = excess >= -bound(OPERATIONS) * scale
    rows = np.flatnonzero(np.isfinite(left).all(axis=1) & active.any(axis=1))
    found: Floats = np.linalg.norm(left, axis=1)
    found[rows] = [nnls(flows[p, active[p]].T, left[p])[1] for p in rows]
    return found / scale[:, 0]


def states(subject: Subject, known: Surfaces) -> tuple[Floats, Floats]:
    """Admissible stresses (P,4) and strain increments (P,2,2) from them.

    Those of random axes have zz anywhere among the principal stresses; of the trial stresses that increments along the
    axes, and with shear, lead to from isotropic stresses half have two or three that are the same.
    """
    unit = CONFINED * subject.stress
    size = unit / (2 * subject.material.mu) * np.resize(SIZES, COUNT)
    first, second, zz = admissible(known, unit).T
    middle, radius, angle = (first + second) / 2, (first - second) / 2, 3 * random(COUNT, seed=22)
    mixed = np.stack(
        [middle + radius * np.cos(angle), middle - radius * np.cos(angle), zz, radius * np.sin(angle)], axis=1
    )
    even = np.array(list(product((-1.0, 0.0, 1.0), (-1.0, 0.0, 1.0), (0.0, 1.0))))
    evenly = np.concatenate([unit / (2 * subject.material.mu) * one * even for one in SIZES[1:]])
    sigma = np.concatenate([mixed, np.tile([-unit, -unit, -unit, 0.0], (len(evenly), 1))])
    return sigma, symmetric(np.concatenate([size[:, None] * random(COUNT, 3, seed=23), evenly]))


def admissible(known: Surfaces, unit: float) -> Floats:
    """Principal stresses (COUNT,3) in compression and tension, inside and on the surfaces, by bisection."""
    away = 3 * unit * random(COUNT, 3, seed=21)
    low, high = np.zeros(COUNT), np.ones(COUNT)
    for _ in range(60):
        middle = (low + high) / 2
        inside = (known.excess(middle[:, None] * away - unit) <= 0).all(axis=1)
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    low *= np.resize((0.5, 0.9, 1.0), COUNT)
    found: Floats = low[:, None] * away - unit
    return found


def whole(sigma: Floats) -> Floats:
    """Tensors (P,3,3) of stresses xx, yy, zz, xy (P,4)."""
    found: Floats = np.zeros((len(sigma), 3, 3))
    found[:, 0, 0], found[:, 1, 1], found[:, 2, 2] = sigma[:, :3].T
    found[:, 0, 1] = found[:, 1, 0] = sigma[:, 3]
    return found
