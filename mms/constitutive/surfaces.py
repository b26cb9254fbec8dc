"""Yield surfaces and plastic potentials of perfectly plastic soils in principal stresses, written out in NumPy.

Tension positive, principal stresses (P,3) in any order. Formulas are those of the models' sources, not of their
returns: six planes k s_i - s_j <= 2 c sqrt(k) of Mohr-Coulomb, k = (1 + sin phi)/(1 - sin phi), with flow along
m s_i - s_j, and three of the cut-off, s_i <= sigma_t, with flow along s_i; the cone sqrt(J2) + a p <= b of
Drucker-Prager, with flow along sqrt(J2) + d p. Beyond an apex p = c cot phi nothing holds, and flow may open without
end: there the planes of the cut-off, or p <= c cot phi, are surfaces too.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations
from math import inf, radians, sin, sqrt, tan
from typing import Any

import numpy as np

from mpm_verify.solver.state import Floats


@dataclass(frozen=True)
class Surfaces:
    """Yield surfaces of a soil.

    Attributes
    ----------
    excess
        Excess (P,n) over each surface of principal stresses (P,3), in the unit of stress.
    flow
        Plastic strain (P,n,3) along the potential of each surface, where the trial stress is (P,3); of any length.
    """

    excess: Callable[[Floats], Floats]
    flow: Callable[[Floats], Floats]


def known_surfaces(material: Any) -> bool:
    """Whether the surfaces of a material stand here."""
    return material.name in KNOWN


def surfaces(material: Any) -> Surfaces:
    """Yield surfaces of a material that stands here."""
    return KNOWN[material.name](material)


def planes(soil: Any) -> Surfaces:
    """Mohr-Coulomb with a tension cut-off, Tresca for phi = 0."""
    k, m = ratio(soil.phi), ratio(soil.psi)
    tension = min(soil.sigma_t, apex(soil))
    normals, flows = np.zeros((9, 3)), np.zeros((9, 3))
    for row, (i, j) in enumerate(permutations(range(3), 2)):
        normals[row, [i, j]], flows[row, [i, j]] = (1.0, -1 / k), (m, -1.0)
    normals[6:], flows[6:] = np.eye(3), np.eye(3)
    most = np.append(np.full(6, 2 * soil.c / sqrt(k)), np.full(3, tension))
    return Surfaces(lambda s: s @ normals.T - most, lambda s: np.broadcast_to(flows, (len(s), 9, 3)))


def cone(soil: Any) -> Surfaces:
    """Drucker-Prager, von Mises for phi = 0; beside the cone its apex."""
    top = apex(soil)
    a, d, strength = {"plane_strain": by_plane_strain, "compression": by_compression}[soil.cone](soil)

    def excess(s: Floats) -> Floats:
        p, root = invariants(s)
        return np.stack([root + a * p - strength, p - top], axis=1) if soil.phi else (root - strength)[:, None]

    def flow(s: Floats) -> Floats:
        p, root = invariants(s)
        along = (s - p[:, None]) / np.maximum(2 * root, np.finfo(float).tiny)[:, None] + d / 3
        return np.stack([along, np.ones_like(s) / 3], axis=1) if soil.phi else along[:, None]

    return Surfaces(excess, flow)


KNOWN: dict[str, Callable[[Any], Surfaces]] = {"mohr_coulomb": planes, "drucker_prager": cone}


def ratio(angle: float) -> float:
    """Ratio (1 + sin)/(1 - sin) of an angle in degrees: of the principal stresses, or strains, of a plane."""
    return (1 + sin(radians(angle))) / (1 - sin(radians(angle)))


def apex(soil: Any) -> float:
    """Mean stress c cot phi of the apex, none for phi = 0."""
    return soil.c / tan(radians(soil.phi)) if soil.phi else inf


def invariants(s: Floats) -> tuple[Floats, Floats]:
    """Mean stress p (P,) and sqrt(J2) (P,) of principal stresses (P,3)."""
    p = s.mean(axis=1)
    root: Floats = np.sqrt(((s - p[:, None]) ** 2).sum(axis=1) / 2)
    return p, root


def by_compression(soil: Any) -> tuple[float, float, float]:
    """Slopes a, d and strength b of the cone through the states s1 = s2 of Mohr-Coulomb."""

    def through(angle: float, c: float) -> tuple[float, float]:
        k, root_p = ratio(angle), []
        for s1 in (-1.0, -2.0):  # two states of that edge lie on the cone
            (p,), (root,) = invariants(np.array([[s1, s1, k * s1 - 2 * c * sqrt(k)]]))
            root_p.append((root, p))
        (r1, p1), (r2, p2) = root_p
        a = (r2 - r1) / (p1 - p2)
        return a, r1 + a * p1

    a, b = through(soil.phi, soil.c)
    return a, through(soil.psi, 0.0)[0], b


def by_plane_strain(soil: Any) -> tuple[float, float, float]:
    """Slopes a, d and strength b of the cone that is at failure where Mohr-Coulomb is, plastic strain without zz.

    With flow s/(2 sqrt(J2)) + d/3 that asks s_zz = -2/3 d sqrt(J2). So in the plane radius and centre of Mohr's
    circle are t = sqrt(1 - d^2/3) sqrt(J2), p + d/3 sqrt(J2), and volume to shear of the flow d over that root.
    """
    sine = sin(radians(soil.psi))
    d = sine / sqrt(1 + sine**2 / 3)
    t, friction = sqrt(1 - d**2 / 3), sin(radians(soil.phi))
    # Where sqrt(J2) = 1 fails: t = -(p + d/3) sin phi + c cos phi.
    per = t + d / 3 * friction
    return friction / per, d, soil.c * sqrt(1 - friction**2) / per
