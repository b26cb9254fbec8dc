"""Constitutive model without a grid: rows of particles that are taken from one F to the next."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from math import cos, sin
from typing import Any

import numpy as np

from mpm_verify.mms.constitutive.tested import off
from mpm_verify.solver.state import Floats, Particles

SEED = 20221


@dataclass(frozen=True)
class Subject:
    """Constitutive model that is tested, and the scale of its stresses."""

    material: Any

    @property
    def stress(self) -> float:
        """Scale of stresses: rho0 c^2."""
        return float(self.material.rho0 * self.material.wave_speed() ** 2)

    def stiffness(self, mean: float) -> float:
        """Shear modulus at a mean stress, or what a Poisson's ratio of a quarter makes of rho0 c^2."""
        m = self.material
        return float(m.moduli(mean)[0] if m.moduli else getattr(m, "mu", self.stress / 3))


@dataclass(frozen=True)
class Point:
    """State of material points after a path: sigma (P,4), history (P,H), work (P,2) in rate form."""

    sigma: Floats
    history: Floats
    work: Floats = field(default_factory=lambda: np.zeros((0, 2)))


def drive(material: Any, path: Sequence[Floats], sigma: Floats, history: Floats | None = None) -> Point:
    """Take points under sigma (P,4) at path[0] through the F (P,2,2) of a path; history as of the model at its start.

    `history` (P,H) replaces what the model begins with.
    """
    count = len(sigma)
    p = Particles(np.zeros((count, 2)), np.ones(count), np.ones(count), np.zeros((count, 0)))
    p.F[:], p.sigma[:] = path[0], sigma
    material.start(p)
    if history is not None:
        p.history[:] = history
    for F in path[1:] if p.F_old.size else path[-1:]:
        p.F[:] = F
        material.update(p, 1.0)
    return Point(p.sigma.copy(), p.history.copy(), p.work.copy())


def responded(material: Any, sigma: Floats, D: Floats, history: Floats | None = None) -> Point:
    """Take points under sigma (P,4) through strain increments D (P,2,2) by the kernel of a model in rate form alone.

    No F is in between, whose unit part would cost digits of a small strain, and no rate. `history` (P,H) as of `drive`.
    """
    history = material.initial(sigma) if history is None else history
    point = Point(sigma.copy(), history.copy())
    de = np.stack([D[:, 0, 0], D[:, 1, 1], D[:, 0, 1]], axis=1)
    material.respond(material.constants(), point.sigma.reshape(-1), de.reshape(-1), point.history.reshape(-1))
    return point


def apart(material: Any, one: Floats, other: Floats, unit: float) -> float:
    """Distance of histories (P,H): works over a stress, all else as strains, ratios and numbers."""
    units = np.array([unit if name.startswith("work") else 1.0 for name in material.memory])
    return off(one / units, other / units, 1.0)


def straight(increments: Floats) -> Floats:
    """F (P,2,2) of one step from the unit tensor whose strain increment of the middle of the step is D (P,2,2).

    (F - I) ((F + I)/2)^-1 = D, so F = (I - D/2)^-1 (I + D/2); symmetric where D is, and so without rotation.
    """
    half = increments / 2
    return np.asarray(np.linalg.solve(np.eye(2) - half, np.eye(2) + half), np.float64)


def symmetric(rows: Floats) -> Floats:
    """Tensors (P,2,2) of xx, yy, xy (P,3)."""
    found: Floats = rows[:, [0, 2, 2, 1]].reshape(-1, 2, 2)
    return found


def elastic(lam: float, mu: float, D: Floats) -> Floats:
    """Stress increments (P,4) of linear elasticity for strain increments D (P,2,2) in plane strain."""
    trace = np.trace(D, axis1=1, axis2=2)
    bulk = lam * trace
    found: Floats = np.stack(
        [bulk + 2 * mu * D[:, 0, 0], bulk + 2 * mu * D[:, 1, 1], bulk, 2 * mu * D[:, 0, 1]], axis=1
    )
    return found


def compliance(lam: float, mu: float, sigma: Floats) -> Floats:
    """Elastic strains xx, yy, zz, xy (P,4) of linear elasticity under stresses (P,4)."""
    trace = sigma[:, :3].sum(axis=1)
    volume = lam / (3 * lam + 2 * mu) * trace
    found: Floats = np.divide(sigma, 2 * mu, dtype=np.float64)
    found[:, :3] -= (volume / (2 * mu))[:, None]
    return found


def strength(material: Any) -> tuple[float, float]:
    """Sine of the friction angle and cohesion times its cosine: in the plane t <= s sin + c cos."""
    angle = np.radians(material.friction_angle)
    return float(np.sin(angle)), float((material.cohesion or 0.0) * np.cos(angle))


def circle(sigma: Floats) -> tuple[Floats, Floats]:
    """Centre s, compression positive, and radius t of Mohr's circle in the plane, of stresses (P,4)."""
    s = -(sigma[:, 0] + sigma[:, 1]) / 2
    t: Floats = np.hypot((sigma[:, 0] - sigma[:, 1]) / 2, sigma[:, 3])
    return s, t


@cache
def random(*shape: int, seed: int = SEED) -> Floats:
    """Numbers between -1 and 1, the same at each call; not to be written."""
    numbers: Floats = np.random.default_rng(seed).uniform(-1.0, 1.0, shape)
    return numbers


def turn(angle: float) -> Floats:
    """Rotation (2,2) by an angle, counter-clockwise."""
    return np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])


def tensors(sigma: Floats) -> Floats:
    """Plane stresses (...,2,2) of sigma xx, yy, zz, xy (...,4)."""
    xy = sigma[..., 3]
    full: Floats = np.stack([np.stack([sigma[..., 0], xy], -1), np.stack([xy, sigma[..., 1]], -1)], -2)
    return full


def columns(plane: Floats, zz: Floats) -> Floats:
    """Stresses xx, yy, zz, xy (...,4) of plane stresses (...,2,2) and zz (...)."""
    sigma: Floats = np.stack([plane[..., 0, 0], plane[..., 1, 1], zz, plane[..., 0, 1]], -1)
    return sigma


def rotated(sigma: Floats, Q: Floats) -> Floats:
    """Stress Q sigma Q^T of sigma (...,4) and Q (2,2), a rotation or mirror."""
    return columns(Q @ tensors(sigma) @ Q.T, sigma[..., 2])
