"""Exact curves of element tests, where a law has them: what its numbers are drawn over and judged by."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import brentq

from mpm_verify.cases.element import ubcsand_exact as ubc
from mpm_verify.cases.element.curves import EnergyElement, columns, start
from mpm_verify.cases.element.paths import ElementTest, Followed, follow
from mpm_verify.solver.elastic import Elastic
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb, slope
from mpm_verify.solver.material.ubcsand import Ubcsand
from mpm_verify.solver.state import Floats

Columns = dict[str, Floats]
POINTS = 60


def exact(law: Any, test: ElementTest, stress: float) -> tuple[Columns, str] | None:
    """Columns of the exact curve, and what it is; None where nothing is known."""
    if law.energy is not None:
        found = follow(EnergyElement(law), test, test.steps(POINTS), start(law, test, stress))
        return columns(test, found), "derivative of the energy"
    return EXACT[law.name](law, test, stress) if law.name in EXACT else None


def hypoelastic(law: Elastic, test: ElementTest, stress: float) -> tuple[Columns, str]:
    """The elastic curve of any test."""
    return elastic(law, test, stress), "linear elasticity"


def elastic(law: Elastic, test: ElementTest, stress: float) -> Columns:
    """The three conditions are linear in the strain."""
    D = law.lam * np.array([[1, 1, 0], [1, 1, 0], [0, 0, 0]]) + 2 * law.mu * np.eye(3)
    if len(test.points):
        strain = test.points - test.points[0]
    else:
        rows, right = [], []
        for condition in test.conditions:
            weights = np.array(condition.weights)
            rows.append(weights if condition.of == "strain" else weights @ D)
            right.append(condition.share if condition.of == "strain" else 0.0)
        strain = test.gone(test.steps(POINTS))[:, None] * np.linalg.solve(np.array(rows), np.array(right))
    plane = strain @ D
    bulk = law.lam * (strain[:, 0] + strain[:, 1])
    sigma = start(law, test, stress) + np.column_stack([plane[:, 0], plane[:, 1], bulk, plane[:, 2]])
    return columns(test, Followed(strain, sigma, np.zeros((len(strain), 0))))


def sand(law: Ubcsand, test: ElementTest, stress: float) -> tuple[Columns, str] | None:
    """UBCSAND without cohesion: isotropic compression, shear at constant s, drained biaxial compression to failure."""
    if law.c:
        return None
    if test.name == "isotropic" and law.ne == law.me:
        ev = np.linspace(0, test.length, POINTS)
        s = np.array([ubc.isotropic(law, stress, float(e)) for e in ev])
        return {"s": s, "t": 0 * s, "sx": s, "sy": s, "gamma": 0 * s, "ev": ev, "ey": ev / 2}, "closed form"
    if test.name == "constant_s" and law.Rf > 0:
        gamma, s = np.linspace(0, test.length, POINTS), np.full(POINTS, stress)
        eta = np.array([ubc.ratio_at(law, stress, float(g)) for g in gamma])
        ev = np.array([ubc.volume_at(law, stress, float(g)) for g in gamma])
        return ratios(s, eta) | {"gamma": gamma, "ev": ev, "ey": (ev + gamma) / 2}, "closed form"
    if test.name == "biaxial":
        eta = np.linspace(0, reached(law, stress, test.length), POINTS)
        gamma, ev = np.array([ubc.biaxial(law, stress, float(e)) for e in eta]).T
        strains = {"gamma": gamma, "ev": ev, "ey": (ev + gamma) / 2}
        return ratios(stress / (1 - eta), eta) | strains, "quadrature"
    return None


def ratios(s: Floats, eta: Floats) -> Columns:
    """Stresses of a mobilised ratio, compressed along y."""
    return {"s": s, "t": eta * s, "sx": s * (1 - eta), "sy": s * (1 + eta)}


def reached(law: Ubcsand, stress: float, length: float) -> float:
    """Mobilised ratio at the vertical strain `length` of drained biaxial compression, short of failure."""
    last = law.eta_f * (1 - 1e-9)
    if vertical(law, stress, last) <= length:
        return last
    return float(brentq(lambda eta: vertical(law, stress, eta) - length, 1e-9, last, xtol=1e-13))


def vertical(law: Ubcsand, stress: float, eta: float) -> float:
    """Vertical strain of drained biaxial compression at a mobilised ratio."""
    return sum(ubc.biaxial(law, stress, eta)) / 2


def perfect(law: MohrCoulomb, test: ElementTest, stress: float) -> tuple[Columns, str] | None:
    """Mohr-Coulomb: elastic where the test does not yield, and drained biaxial compression on both sides of yield."""
    k, m = slope(law.phi), slope(law.psi)
    K0 = law.nu / (1 - law.nu)
    if test.name == "isotropic" or (test.name == "oedometric" and K0 * k >= 1):
        return elastic(law, test, stress), "linear elasticity"
    if test.name != "biaxial":
        return None
    strong = k * stress + 2 * law.c * np.sqrt(k)
    ends = (strong - stress) * (1 - law.nu**2) / law.E
    ey = np.sort([*np.linspace(0, test.length, POINTS), min(ends, test.length)])
    sy = np.minimum(stress + ey * law.E / (1 - law.nu**2), strong)
    ev = np.minimum(ey, ends) * (1 - K0) + np.maximum(ey - ends, 0) * (1 - m)
    sx = np.full(len(ey), stress)
    stresses = {"s": (sx + sy) / 2, "t": (sy - sx) / 2, "sx": sx, "sy": sy}
    return stresses | {"gamma": 2 * ey - ev, "ev": ev, "ey": ey}, "closed form"


# By the name of the material.
EXACT: dict[str, Callable[[Any, ElementTest, float], tuple[Columns, str] | None]] = {
    "hypoelastic": hypoelastic,
    "mohr_coulomb": perfect,
    "ubcsand": sand,
}
