"""Exact curves of element tests, where a material has them: what its numbers are drawn over and judged by."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from mpm_verify.cases.element import ubcsand_exact as ubc
from mpm_verify.cases.element import ubcsand_triaxial
from mpm_verify.cases.element.axes import TRIAXIAL_TESTS
from mpm_verify.cases.element.begin import begin
from mpm_verify.cases.element.curves import EnergyElement, EnergyMotion, columns
from mpm_verify.cases.element.element import State
from mpm_verify.cases.element.following import Followed, follow
from mpm_verify.cases.element.legs import STRESS
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.cases.element.rates_exact import along
from mpm_verify.cases.element.triaxial_exact import triaxial
from mpm_verify.solver.elastic import Elastic
from mpm_verify.solver.material.drucker_prager import DruckerPrager
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb, slope
from mpm_verify.solver.material.ubcsand import Ubcsand
from mpm_verify.solver.state import Floats

Columns = dict[str, Floats]
POINTS = 60
ELASTIC = "linear elasticity"


def exact(material: Any, test: ElementTest, stress: float, begun: State | None = None) -> tuple[Columns, str] | None:
    """Columns of the exact curve, and what it is; None where nothing is known.

    `begun` is the state at the start, the isotropic `stress` if it is left out.
    """
    begun = begin(material, test, stress) if begun is None else begun
    if material.energy is not None and not (material.strays if test.motion else getattr(material, "convected", False)):
        kind = EnergyMotion if test.motion else EnergyElement
        found = follow(kind(material), test, test.steps(POINTS), replace(begun, history=np.zeros(0)))
        return columns(test, found), "derivative of the energy"
    known = EXACT.get(material.name)
    if known is None or (not isotropic(begun) and test.name not in TRIAXIAL_TESTS and material.name != "hypoelastic"):
        return None
    return known(material, test, begun)


def isotropic(begun: State) -> bool:
    """Whether the stress at the start is isotropic, and some."""
    return bool(np.ptp(begun.sigma[:3]) == begun.sigma[3] == 0 and begun.sigma[0])


def hypoelastic(material: Elastic, test: ElementTest, begun: State) -> tuple[Columns, str] | None:
    """Elastic curve of any test, and its source; along a motion that of its rate."""
    if test.motion:
        return along(material, test, begun)
    return (legs(material, test, begun) if test.mixed else elastic(material, test, begun)), ELASTIC


def stiffness(material: Elastic, size: int) -> Floats:
    """Stiffness (n,n) of the components xx, yy, xy and zz."""
    even = np.array([1.0, 1.0, 0.0, 1.0])[:size]
    D: Floats = material.lam * np.outer(even, even) + 2 * material.mu * np.eye(size)
    return D


def elastic(material: Elastic, test: ElementTest, begun: State) -> Columns:
    """Elastic curve of any test: its conditions are linear in the strain."""
    D = stiffness(material, test.size)
    if len(test.points):
        strain = test.points - test.points[0]
    else:
        rows, right = [], []
        for condition in test.conditions:
            weights = np.array(condition.weights)
            rows.append(weights if condition.of == "strain" else weights @ D)
            right.append(condition.fraction if condition.of == "strain" else 0.0)
        strain = test.gone(test.steps(POINTS))[:, None] * np.linalg.solve(np.array(rows), np.array(right))
    return elastic_columns(material, test, begun, strain)


def legs(material: Elastic, test: ElementTest, begun: State) -> Columns:
    """Elastic corners of a path from a file: of each component the strain is given, or the stress."""
    D, sigma = stiffness(material, test.size), begun.sigma[STRESS[: test.size]]
    strain = [np.zeros(test.size)]
    for wanted, target in zip(test.points[1:], test.targets[1:], strict=True):
        given = np.isfinite(wanted)
        rows = np.where(given[:, None], np.eye(test.size), D)
        strain.append(np.linalg.solve(rows, np.where(given, wanted, target - sigma)))
    return elastic_columns(material, test, begun, np.array(strain))


def elastic_columns(material: Elastic, test: ElementTest, begun: State, strain: Floats) -> Columns:
    """Columns of the strains (N,n) of an elastic solid."""
    D = stiffness(material, 4)[:, : test.size]
    sigma = begun.sigma + (strain @ D.T)[:, STRESS]  # xx, yy, zz, xy: the order of both is undone by the same swap
    return columns(test, Followed(strain, sigma, np.zeros((len(strain), 0))))


def sand(material: Ubcsand, test: ElementTest, begun: State) -> tuple[Columns, str] | None:
    """Curve of UBCSAND without cohesion: isotropic compression, shear at constant s, biaxial, triaxial tests."""
    if material.c:
        return None
    if test.name in TRIAXIAL_TESTS:
        return ubcsand_triaxial.triaxial(material, test, begun)
    stress = -float(begun.sigma[0])
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
        if left := max(test.length - float(ev[-1] + gamma[-1]) / 2, 0.0):  # beyond failure: a constant flow
            flow = material.eta_cv - material.eta_f
            slip = 2 * left / (1 + flow)
            eta, gamma, ev = (
                np.append(eta, eta[-1]),
                np.append(gamma, gamma[-1] + slip),
                np.append(ev, ev[-1] + flow * slip),
            )
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


def perfect(material: MohrCoulomb, test: ElementTest, begun: State) -> tuple[Columns, str] | None:
    """Curve of Mohr-Coulomb: elastic where it does not yield, biaxial and triaxial tests on both sides of yield.

    None of a test in which dilation may end: the step that it ends in has the old flow.
    """
    k, m = slope(material.phi), slope(material.psi)
    bends = (1 + m) * test.length > material.gamma_cv  # the largest plastic shear of a unit along an axis is 1 + m
    if test.name in TRIAXIAL_TESTS:
        return None if bends else triaxial(material, test, begun)
    stress = -float(begun.sigma[0])
    K0 = material.nu / (1 - material.nu)
    least = {"isotropic": 2 * material.nu, "oedometric": K0}  # of the elastic principal stresses, over the largest
    if least.get(test.name, 0.0) * k >= 1:
        return elastic(material, test, begun), ELASTIC
    if test.name != "biaxial" or bends:
        return None
    strong = k * stress + 2 * material.c * np.sqrt(k)
    ends = (strong - stress) * (1 - material.nu**2) / material.E
    ey = np.sort([*np.linspace(0, test.length, POINTS), min(ends, test.length)])
    sy = np.minimum(stress + ey * material.E / (1 - material.nu**2), strong)
    ev = np.minimum(ey, ends) * (1 - K0) + np.maximum(ey - ends, 0) * (1 - m)
    sx = np.full(len(ey), stress)
    stresses = {"s": (sx + sy) / 2, "t": (sy - sx) / 2, "sx": sx, "sy": sy}
    return stresses | {"gamma": 2 * ey - ev, "ev": ev, "ey": ey}, "closed form"


def smooth(material: DruckerPrager, test: ElementTest, begun: State) -> tuple[Columns, str] | None:
    """Curve of Drucker-Prager: triaxial tests."""
    return triaxial(material, test, begun) if test.name in TRIAXIAL_TESTS else None


# By the name of the material.
EXACT: dict[str, Callable[[Any, ElementTest, State], tuple[Columns, str] | None]] = {
    "drucker_prager": smooth,
    "hypoelastic": hypoelastic,
    "mohr_coulomb": perfect,
    "ubcsand": sand,
}
