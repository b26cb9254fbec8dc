"""Exact curves of element tests, where a material has them: what its numbers are drawn over and judged by."""

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


def exact(material: Any, test: ElementTest, stress: float) -> tuple[Columns, str] | None:
    """Columns of the exact curve, and what it is; None where nothing is known."""
    if material.energy is not None:
        found = follow(EnergyElement(material), test, test.steps(POINTS), start(material, test, stress))
        return columns(test, found), "derivative of the energy"
    return EXACT[material.name](material, test, stress) if material.name in EXACT else None


def hypoelastic(material: Elastic, test: ElementTest, stress: float) -> tuple[Columns, str]:
    """Elastic curve of any test, and its source."""
    return elastic(material, test, stress), "linear elasticity"


def elastic(material: Elastic, test: ElementTest, stress: float) -> Columns:
    """Elastic curve of any test: the three conditions are linear in the strain."""
    D = material.lam * np.array([[1, 1, 0], [1, 1, 0], [0, 0, 0]]) + 2 * material.mu * np.eye(3)
    if len(test.points):
        strain = test.points - test.points[0]
    else:
        rows, right = [], []
        for condition in test.conditions:
            weights = np.array(condition.weights)
            rows.append(weights if condition.of == "strain" else weights @ D)
            right.append(condition.fraction if condition.of == "strain" else 0.0)
        strain = test.gone(test.steps(POINTS))[:, None] * np.linalg.solve(np.array(rows), np.array(right))
    plane = strain @ D
    bulk = material.lam * (strain[:, 0] + strain[:, 1])
    sigma = start(material, test, stress) + np.column_stack([plane[:, 0], plane[:, 1], bulk, plane[:, 2]])
    return columns(test, Followed(strain, sigma, np.zeros((len(strain), 0))))


def sand(material: Ubcsand, test: ElementTest, stress: float) -> tuple[Columns, str] | None:
    """Curve of UBCSAND without cohesion: isotropic compression, shear at constant s, drained biaxial compression."""
    if material.c:
        return None
    if test.name == "isotropic" and material.ne == material.me:
        ev = np.linspace(0, test.length, POINTS)
        s = np.array([ubc.isotropic(material, stress, float(e)) for e in ev])
        return {"s": s, "t": 0 * s, "sx": s, "sy": s, "gamma": 0 * s, "ev": ev, "ey": ev / 2}, "closed form"
    if test.name == "constant_s" and material.Rf > 0:
        gamma, s = np.linspace(0, test.length, POINTS), np.full(POINTS, stress)
        eta = np.array([ubc.ratio_at(material, stress, float(g)) for g in gamma])
        ev = np.array([ubc.volume_at(material, stress, float(g)) for g in gamma])
        return ratios(s, eta) | {"gamma": gamma, "ev": ev, "ey": (ev + gamma) / 2}, "closed form"
    if test.name == "biaxial":
        eta = np.linspace(0, reached(material, stress, test.length), POINTS)
        gamma, ev = np.array([ubc.biaxial(material, stress, float(e)) for e in eta]).T
        strains = {"gamma": gamma, "ev": ev, "ey": (ev + gamma) / 2}
        return ratios(stress / (1 - eta), eta) | strains, "quadrature"
    return None


def ratios(s: Floats, eta: Floats) -> Columns:
    """Stresses of a mobilised ratio, compressed along y."""
    return {"s": s, "t": eta * s, "sx": s * (1 - eta), "sy": s * (1 + eta)}


def reached(material: Ubcsand, stress: float, length: float) -> float:
    """Mobilised ratio at the vertical strain `length` of drained biaxial compression, short of failure."""
    last = material.eta_f * (1 - 1e-9)
    if vertical(material, stress, last) <= length:
        return last
    return float(brentq(lambda eta: vertical(material, stress, eta) - length, 1e-9, last, xtol=1e-13))


def vertical(material: Ubcsand, stress: float, eta: float) -> float:
    """Vertical strain of drained biaxial compression at a mobilised ratio."""
    return sum(ubc.biaxial(material, stress, eta)) / 2


def perfect(material: MohrCoulomb, test: ElementTest, stress: float) -> tuple[Columns, str] | None:
    """Curve of Mohr-Coulomb: elastic where the test does not yield, and biaxial compression on both sides of yield."""
    k, m = slope(material.phi), slope(material.psi)
    K0 = material.nu / (1 - material.nu)
    if test.name == "isotropic" or (test.name == "oedometric" and K0 * k >= 1):
        return elastic(material, test, stress), "linear elasticity"
    if test.name != "biaxial":
        return None
    strong = k * stress + 2 * material.c * np.sqrt(k)
    ends = (strong - stress) * (1 - material.nu**2) / material.E
    ey = np.sort([*np.linspace(0, test.length, POINTS), min(ends, test.length)])
    sy = np.minimum(stress + ey * material.E / (1 - material.nu**2), strong)
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
