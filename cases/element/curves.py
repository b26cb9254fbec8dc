"""Curves of an element test, drawn and compared: strains and stresses of soil mechanics, compression positive."""

from typing import Any, ClassVar

import numpy as np

from mpm_verify.cases.element.element import Element, State, stretch
from mpm_verify.cases.element.following import Followed
from mpm_verify.cases.element.motion import Motion, matrices, stretches
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.solver.state import Floats, Particles

COMPLEX = 1e-30


def columns(test: ElementTest, found: Followed) -> dict[str, Floats]:
    """Columns s, t, tau, sx, sy, sz of the stress; gamma (e1 - e3, or the shear of a shear test), ev, ey of strain.

    With zz also p, q = sy - sx, ex and ez; strains of a motion are logarithmic, its shear is Fxy/Fyy.
    """
    xx, yy, zz, xy = found.sigma.T
    radius = np.hypot((xx - yy) / 2, xy)
    stress = {"s": -(xx + yy) / 2, "t": radius, "tau": xy, "sx": -xx, "sy": -yy, "sz": -zz}
    if test.motion:
        return stress | moved(test, found.strain)
    exx, eyy, exy, *out = found.strain.T
    ezz = out[0] if out else np.zeros(len(exx))
    gamma = 2 * exy if test.shear else np.hypot(exx - eyy, 2 * exy)
    strains = {"gamma": gamma, "ev": -(exx + eyy + ezz), "ey": -eyy}
    if not out:
        return stress | strains
    return stress | strains | {"p": -(xx + yy + zz) / 3, "q": xx - yy, "ex": -exx, "ez": -ezz}


def moved(test: ElementTest, F: Floats) -> dict[str, Floats]:
    """Columns gamma, ev and ey of a motion F (N,5)."""
    xx, yy, xy, zz, yx = F.T
    large, small = stretches(F).T
    return {
        "gamma": xy / yy if test.shear else large - small,
        "ev": -np.log((xx * yy - xy * yx) * zz),
        "ey": -np.log(np.hypot(xy, yy)),
    }


class EnergyElement(Element):
    """Element with the stress that the energy of its material gives, by the complex step: independent of its kernel."""

    def step(self, state: State, increments: Floats) -> list[State]:
        """States after each of the strain increments (n,3)."""
        strains = state.strain + increments
        return [State(strain, energy_stress(self.material, strain), np.zeros(0)) for strain in strains]


class EnergyMotion(Motion):
    """The same along a motion."""

    frame: ClassVar[None] = None  # whatever the rate of the material

    def of_F(self, ends: Floats) -> Floats:
        """Stress (n,4) of F (n,5)."""
        return np.array([stress_of(self.material, F) for F in matrices(ends)])


def energy_stress(material: Any, strain: Floats) -> Floats:
    """Stress xx, yy, zz, xy (4,) for F = exp(strain), see `stress_of`."""
    F = np.eye(3)
    F[:2, :2] = stretch(strain)
    return stress_of(material, F)


def stress_of(material: Any, F: Floats) -> Floats:
    """Stress xx, yy, zz, xy (4,) of F (3,3): P F^T / J, or P itself of a material of small strains."""
    P = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            moved = F.astype(complex)
            moved[i, j] += 1j * COMPLEX
            P[i, j] = material.energy(moved.tolist(), np.log).imag / COMPLEX
    sigma = P if small(material) else P @ F.T / np.linalg.det(F)
    stress: Floats = sigma[[0, 1, 2, 0], [0, 1, 2, 1]]
    return stress


def small(material: Any) -> bool:
    """Whether the material's stress is linear in F - I: then it stands for the first Piola stress."""
    if material.rate is not None:
        return False
    p = Particles(np.zeros((3, 2)), np.ones(3), np.ones(3), np.zeros((3, 0)))
    p.F = np.array([np.eye(2) + factor * np.array([[0.1, 0.02], [0.02, -0.05]]) for factor in (1.0, 2.0, 3.0)])
    material.update(p, 1.0)
    return bool(np.allclose(p.sigma[2] - p.sigma[1], p.sigma[1] - p.sigma[0], rtol=1e-9))


def element_of(material: Any, test: ElementTest) -> Element:
    """Element that drives a test: along a motion, or in the frame of the material."""
    return Motion(material) if test.motion else Element(material)


def start(material: Any, test: ElementTest, stress: float) -> Floats:
    """Isotropic stress at the start (4,), `stress` compression positive; zero of a material with a stress from F."""
    confined = stress * test.loose if material.energy is None else 0.0
    return np.array([-confined, -confined, -confined, 0.0])
