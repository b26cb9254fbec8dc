"""Drained triaxial tests of UBCSAND by quadrature: the plane of the axis yields, the other lateral strain is elastic.

Compression positive, y axial, the cell pressure sx = sz stays: s = sx/(1 - eta) in compression, sx/(1 + eta) in
extension, so that d sy is known of d eta; elastic strains d sy/E and -nu d sy/E, plastic ones in the plane alone as in
ubcsand_exact.py. Beyond eta_f stresses stay and the flow goes on as it is there.
"""

from typing import Any

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from mpm_verify.cases.element import ubcsand_exact as ubc
from mpm_verify.cases.element.element import State
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.cases.element.triaxial_exact import Columns
from mpm_verify.solver.material.ubcsand import Ubcsand
from mpm_verify.solver.state import Floats

POINTS = 60
SHORT = 1 - 1e-12  # of eta_f, where the hyperbola ends: the rest is perfect plasticity


def triaxial(sand: Ubcsand, test: ElementTest, begin: State) -> tuple[Columns, str] | None:
    """Exact columns and what they are; None of other starts than an isotropic stress, and of undrained tests."""
    cell = -float(begin.sigma[0])
    if sand.c or not sand.Rf or not cell > 0 or np.ptp(begin.sigma[:3]) or test.name == "triaxial_undrained":
        return None
    side = -1 if test.name == "triaxial_extension" else 1
    last, length = sand.eta_f * SHORT, test.length
    if axial(sand, cell, side, last) > length:
        last = float(brentq(lambda eta: axial(sand, cell, side, eta) - length, 0.0, last, xtol=1e-14))
    eta = np.linspace(0, last, POINTS)
    strains = np.array([[strain(sand, cell, side, float(e), of) for of in range(3)] for e in eta])
    left = max(length - abs(strains[-1, 0]), 0.0)
    if left:
        flow = plastic(side, sand.eta_cv - sand.eta_f)
        eta = np.append(eta, last)
        strains = np.vstack([strains, strains[-1] + left / abs(flow[0]) * flow])
    return columns(cell, side, eta, strains), "quadrature"


def axial(sand: Ubcsand, cell: float, side: int, eta: float) -> float:
    """Size of the axial strain at a mobilised ratio."""
    return abs(strain(sand, cell, side, eta, 0))


def strain(sand: Ubcsand, cell: float, side: int, eta: float, of: int) -> float:
    """Axial, lateral in the plane, or lateral strain normal to it (of 0, 1, 2) at a mobilised ratio."""

    def rate(e: float) -> float:
        s = cell / (1 - side * e)
        G, K = sand.moduli(s)
        E, nu = 9 * K * G / (3 * K + G), (3 * K - 2 * G) / (2 * (3 * K + G))
        loaded = side * 2 * cell / (1 - side * e) ** 2  # d sy / d eta
        slip = 1 / (ubc.hardening(sand, s) * (1 - sand.Rf / sand.eta_f * e) ** 2)
        elastic = loaded / E * np.array([1.0, -nu, -nu])
        total: Any = elastic + slip * plastic(side, sand.eta_cv - e)
        return float(total[of])

    return float(quad(rate, 0.0, eta, epsabs=1e-14, epsrel=1e-12)[0])


def plastic(side: int, D: float) -> Floats:
    """Plastic strains of a unit of plastic shear: axial, lateral in the plane, and none normal to it."""
    return np.array([(D + side) / 2, (D - side) / 2, 0.0])


def columns(cell: float, side: int, eta: Floats, strains: Floats) -> Columns:
    """Columns of mobilised ratios and strains: axial, lateral, lateral."""
    s = cell / (1 - side * eta)
    sx, sy = np.full(len(eta), cell), s * (1 + side * eta)
    ey, ex, ez = strains.T
    stress = {"s": s, "t": eta * s, "sx": sx, "sy": sy, "sz": sx, "p": (2 * sx + sy) / 3, "q": sy - sx}
    return stress | {"gamma": np.abs(ey - ex), "ev": strains.sum(axis=1), "ey": ey, "ex": ex, "ez": ez}
