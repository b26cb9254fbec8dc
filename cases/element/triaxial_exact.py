"""Closed forms of triaxial tests of linear elastic, perfectly plastic soils: cell pressure or volume stays.

Compression positive, y axial, q = sy - sx. On its meridian a soil has |q| = M p + Q and flows by `axial` and `volume`
strains per unit, the latter negative where it dilates. With k = (1 + sin phi)/(1 - sin phi), m alike with psi:
    Mohr-Coulomb, compression  M = 3 (k - 1)/(k + 2),    Q = 6 c sqrt(k)/(k + 2),     flow 1, 1 - m
    Mohr-Coulomb, extension    M = 3 (k - 1)/(2 k + 1),  Q = 6 c sqrt(k)/(2 k + 1),   flow -1, -(1 - 1/m)
    Drucker-Prager             M = sqrt(3) a,            Q = sqrt(3) b,               flow +-1/sqrt(3) - d/3, -d
Drained, p = sx + q/3, so |q| ends at (M sx + Q)/(1 -+ M/3): in compression of Mohr-Coulomb (k - 1) sx + 2 c sqrt(k).
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, radians, sin, sqrt
from typing import Any

import numpy as np

from mpm_verify.cases.element.element import State
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.solver.material.drucker_prager import DruckerPrager
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb, apex_of
from mpm_verify.solver.state import Floats

POINTS = 60
Columns = dict[str, Floats]


@dataclass(frozen=True)
class Meridian:
    """Strength |q| = M p + Q on one side, and the flow there: axial and volume strain, compression positive."""

    M: float
    Q: float
    axial: float
    volume: float


def of_mohr_coulomb(soil: MohrCoulomb, side: int) -> Meridian:
    """Meridian of compression (side 1) or extension (-1), the latter by its cut-off where that is met first."""
    k, m = ((1 + sin(radians(angle))) / (1 - sin(radians(angle))) for angle in (soil.phi, soil.psi))
    strength = 6 * soil.c * sqrt(k)
    if side > 0:
        return Meridian(3 * (k - 1) / (k + 2), strength / (k + 2), 1.0, 1 - m)
    return Meridian(3 * (k - 1) / (2 * k + 1), strength / (2 * k + 1), -1.0, -(1 - 1 / m))


def of_drucker_prager(soil: DruckerPrager, side: int) -> Meridian:
    """Meridian of compression (side 1) or extension (-1)."""
    a, b, d = cone(soil)
    return Meridian(sqrt(3) * a, sqrt(3) * b, side / sqrt(3) - d / 3, -d)


def cone(soil: DruckerPrager) -> tuple[float, float, float]:
    """Slope a, strength b and slope d of the flow of sqrt(J2) + a p - b, written anew and with phi = 0."""
    phi, psi = radians(soil.phi), radians(soil.psi)
    if soil.cone == "compression":
        a, b = (6 * of / (sqrt(3) * (3 - sin(phi))) for of in (sin(phi), soil.c * cos(phi)))
        return a, b, 6 * sin(psi) / (sqrt(3) * (3 - sin(psi)))
    wide = sqrt(1 + sin(psi) ** 2 / 3)
    a, b = (of * wide / (1 + sin(phi) * sin(psi) / 3) for of in (sin(phi), soil.c * cos(phi)))
    return a, b, sin(psi) / wide


MERIDIANS: dict[str, Callable[[Any, int], Meridian]] = {  # by the name of the material
    "mohr_coulomb": of_mohr_coulomb,
    "drucker_prager": of_drucker_prager,
}


def triaxial(soil: Any, test: ElementTest, begin: State) -> tuple[Columns, str] | None:
    """Exact columns and what they are; None from stresses that are not axial, or where a cut-off is met."""
    sx, sy, sz = -begin.sigma[:3]
    if begin.sigma[3] or abs(sx - sz) > 1e-9 * abs(sy):
        return None
    side = -1 if test.name == "triaxial_extension" else 1
    line = MERIDIANS[soil.name](soil, side)
    if test.name == "triaxial_undrained":
        found = undrained(soil, line, test.length, float(sx), float(sy))
    else:
        found = drained(soil, line, side, test.length, float(sx), float(sy))
    lowest = min(float(found["sx"].min()), float(found["sy"].min()))
    if lowest <= -min(getattr(soil, "sigma_t", np.inf), apex_of(soil.phi, soil.c)):
        return None
    return found, "closed form"


def drained(soil: Any, line: Meridian, side: int, length: float, sx: float, sy: float) -> Columns:
    """Columns under a cell pressure that stays, in axial strain to either side."""
    strong = side * (line.M * sx + line.Q) / (1 - side * line.M / 3)  # q at failure
    ends = min(max(side * (strong - (sy - sx)) / soil.E, 0.0), length)
    gone = np.sort([*np.linspace(0, length, POINTS), ends])
    elastic, plastic = np.minimum(gone, ends), np.maximum(gone - ends, 0.0)
    volume = side * (1 - 2 * soil.nu) * elastic + plastic * line.volume / abs(line.axial)
    return as_columns(np.full(len(gone), sx), sy + side * soil.E * elastic, side * gone, volume)


def undrained(soil: Any, line: Meridian, length: float, sx: float, sy: float) -> Columns:
    """Columns of compression at constant volume: p stays until the strength is met, and then follows it."""
    G, K = soil.mu, soil.lam + 2 * soil.mu / 3
    p, q = (2 * sx + sy) / 3, sy - sx
    ends = min(max((line.M * p + line.Q - q) / (3 * G), 0.0), length)
    gone = np.sort([*np.linspace(0, length, POINTS), ends])
    shear = line.axial - line.volume / 3  # of the flow, 2/3 (axial - lateral)
    slip = 3 * G * np.maximum(gone - ends, 0.0) / (3 * G * shear - line.M * K * line.volume)
    p_now = p - K * line.volume * slip
    q_now = q + 3 * G * (gone - shear * slip)
    return as_columns(p_now - q_now / 3, p_now + 2 * q_now / 3, gone, 0 * gone)


def as_columns(sx: Floats, sy: Floats, ey: Floats, ev: Floats) -> Columns:
    """Columns of axial and lateral stress, axial strain and volume strain; the lateral strains are equal."""
    lateral = (ev - ey) / 2
    stress = {"s": (sx + sy) / 2, "t": np.abs(sy - sx) / 2, "sx": sx, "sy": sy, "sz": sx, "p": (2 * sx + sy) / 3}
    strain = {"gamma": np.abs(ey - lateral), "ev": ev, "ey": ey, "ex": lateral, "ez": lateral}
    return stress | strain | {"q": sy - sx}
