"""Objective rates: the stress of a hypoelastic solid at the end of a path that stretches, shears and turns; and work.

A step of each rate is symmetric in time, so its error has even powers of the step alone, and extrapolation to none
(Richardson 1911) leaves round-off. What is known of a path F(t) from the unit tensor, rows of any size:

    Truesdell     J F^-1 sigma F^-T = sigma_0 + integral of J F^-1 (C : D) F^-T
    Jaumann, Green-Naghdi     R^T sigma R = sigma_0 + integral of R^T (C : D) R, R the turn by the integral of the
                  spin, skew grad v, or by the polar angle
    logarithmic   sigma = sigma_0 + lam ln J I + 2 mu ln V for an isotropic sigma_0 (Xiao, Bruhns & Meyers 1997)

Integrals are those of the Chebyshev polynomial through as many points. A material in rate form with an energy is held
against that too, at the end of the same path.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from mpm_verify.mms.constitutive.driver import (
    Subject,
    columns,
    drive,
    random,
    straight,
    symmetric,
    tensors,
    turn,
)
from mpm_verify.mms.constitutive.stress import CONFINED, POINTS, cauchy, confined
from mpm_verify.mms.constitutive.tested import Part, Reason, Tested, attempt, bound, not_asked, off
from mpm_verify.solver.material.hypoelastic import Hypoelastic
from mpm_verify.solver.state import Floats

STEPS = (6, 8, 12, 16, 24, 32, 48)
NODES = chebyshev.chebpts1(40)  # of the path, from -1 to 1
LARGE = 0.4  # of the strains of the row that goes farthest; the first goes a fiftieth of that
E, NU = 1.0, 0.3


def tests(subject: Subject) -> list[Tested]:
    """Path of every rate whose stress is known, of the material itself, and the work of a step."""
    material = subject.material
    if material.rate is None:
        return [not_asked(name, Part.RATE, Reason.NO_RATE_FORM) for name in ("rate_path", "work")]
    found: list[Tested] = []
    for rate in KNOWN:
        found += attempt(f"rate_path {rate}", Part.RATE, partial(followed, rate))
    if material.energy is not None and not material.strays:
        found += attempt("rate_path energy", Part.RATE, partial(energetic, subject))
    return found + attempt("work", Part.RATE, partial(worked, subject))


@dataclass(frozen=True)
class Path:
    """Path at the nodes and at its end, (N,P,2,2) each: F, J (N,P), and L of a time from 0 to 1."""

    F: Floats
    J: Floats
    L: Floats

    @property
    def D(self) -> Floats:
        """Stretching."""
        found: Floats = (self.L + self.L.swapaxes(-1, -2)) / 2
        return found


def at(t: Floats) -> tuple[Floats, Floats]:
    """F and its slope (N,P,2,2) at times t (N,), from the unit tensor at t = 0."""
    size = np.geomspace(LARGE / 50, LARGE, POINTS)[:, None, None]
    first, second = size * random(POINTS, 2, 2, seed=41), size * random(POINTS, 2, 2, seed=42)
    t = t[:, None, None, None]
    return np.eye(2) + t * first + t**2 * second, first + 2 * t * second


@cache
def path() -> Path:
    """Path at the nodes, and at its end."""
    F, slope = at(np.append((NODES + 1) / 2, 1.0))
    return Path(F, np.linalg.det(F), slope @ np.linalg.inv(F))


def integral(values: Floats) -> Floats:
    """Integrals from the start to each node, and to the end, of values (N+1,...) there."""
    inner = values[:-1].reshape(len(NODES), -1)
    series = np.linalg.solve(chebyshev.chebvander(NODES, len(NODES) - 1), inner)
    found: Floats = chebyshev.chebval(np.append(NODES, 1.0), chebyshev.chebint(series, lbnd=-1, axis=0)).T / 2
    return found.reshape(values.shape)


def pushed(A: Floats, plane: Floats) -> Floats:
    """A s A^T of tensors."""
    found: Floats = A @ plane @ A.swapaxes(-1, -2)
    return found


def rate_of(solid: Hypoelastic) -> tuple[Floats, Floats]:
    """Plane part (N,P,2,2) and zz (N,P) of C : D along the path."""
    D = path().D
    bulk = solid.lam * np.trace(D, axis1=-2, axis2=-1)
    return bulk[..., None, None] * np.eye(2) + 2 * solid.mu * D, bulk


def by_turn(angle: Floats, solid: Hypoelastic, sigma: Floats) -> Floats:
    """Stress (P,4) at the end, in axes that turn by angles (N,P)."""
    plane, zz = rate_of(solid)
    R = np.stack([np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)], axis=-1).reshape(*angle.shape, 2, 2)
    back = tensors(sigma) + integral(pushed(R.swapaxes(-1, -2), plane))[-1]
    return columns(pushed(R[-1], back), sigma[:, 2] + integral(zz)[-1])


def jaumann(solid: Hypoelastic, sigma: Floats) -> Floats:
    """Stress of the Jaumann rate."""
    L = path().L
    return by_turn(integral((L[..., 1, 0] - L[..., 0, 1]) / 2), solid, sigma)


def green_naghdi(solid: Hypoelastic, sigma: Floats) -> Floats:
    """Stress of the Green-Naghdi rate."""
    F = path().F
    return by_turn(np.arctan2(F[..., 1, 0] - F[..., 0, 1], F[..., 0, 0] + F[..., 1, 1]), solid, sigma)


def truesdell(solid: Hypoelastic, sigma: Floats) -> Floats:
    """Stress of the Truesdell rate."""
    p, (plane, zz) = path(), rate_of(solid)
    J: Floats = p.J[..., None, None]
    back = np.asarray(np.linalg.inv(p.F), np.float64)
    pulled = tensors(sigma) + integral(J * pushed(back, plane))[-1]
    return columns(pushed(p.F[-1], pulled) / J[-1], (sigma[:, 2] + integral(p.J * zz)[-1]) / p.J[-1])


def logarithmic(solid: Hypoelastic, sigma: Floats) -> Floats:
    """Stress of the logarithmic rate from a stress that is isotropic in the plane."""
    F, J = path().F[-1], path().J[-1]
    squares, axes = np.linalg.eigh(F @ F.swapaxes(-1, -2))
    log_V = pushed(axes, np.log(squares)[:, None, :] / 2 * np.eye(2))
    bulk = solid.lam * np.log(J)
    return columns(tensors(sigma) + bulk[:, None, None] * np.eye(2) + 2 * solid.mu * log_V, sigma[:, 2] + bulk)


KNOWN: dict[str, Callable[[Hypoelastic, Floats], Floats]] = {
    "green_naghdi": green_naghdi,
    "jaumann": jaumann,
    "logarithmic": logarithmic,
    "truesdell": truesdell,
}


def extrapolated(material: Any, sigma: Floats) -> Floats:
    """Stress (P,4) at the end of the path from sigma, extrapolated to steps of no length (Neville's scheme)."""
    table: list[Floats] = []
    for n in STEPS:
        row = [drive(material, list(at(np.arange(n + 1.0) / n)[0]), sigma).sigma]
        for k, above in enumerate(table, start=1):
            finer = (n / STEPS[len(table) - k]) ** 2
            row.append(row[-1] + (row[-1] - above) / (finer - 1))
        table = row
    return table[-1]


def followed(rate: str) -> Tested:
    """Path of a hypoelastic solid with a rate, from a stress of any axes where the rate's answer is known for it."""
    solid = Hypoelastic(rate=rate, E=E, nu=NU)
    sigma = 0.3 * random(POINTS, 4, seed=43)
    if rate == "logarithmic":
        sigma = np.stack([sigma[:, 0], sigma[:, 0], sigma[:, 2], 0 * sigma[:, 0]], axis=1)
    expected = KNOWN[rate](solid, sigma)
    return Tested(f"rate_path {rate}", off(extrapolated(solid, sigma), expected, E), bound(sum(STEPS)), Part.RATE)


def energetic(subject: Subject) -> Tested:
    """Path of a material in rate form that has an energy: its stress is that of F at the end."""
    F = path().F[-1]
    found = extrapolated(subject.material, np.zeros((POINTS, 4)))
    expected = columns(*cauchy(subject.material, F))
    return Tested("rate_path energy", off(found, expected, subject.stress), bound(sum(STEPS)), Part.RATE)


def worked(subject: Subject) -> Tested:
    """Work of a step, of the stress at its start and at its end, per initial volume: J sigma : D, of a turned body."""
    material = subject.material
    if material.rate == "truesdell":
        return not_asked("work", Part.RATE, Reason.STRETCHED)
    sigma = confined(subject)
    size = CONFINED * subject.stress / subject.stiffness(CONFINED * subject.stress)
    D, Q = symmetric(size * random(POINTS, 3, seed=44)), turn(0.7)
    point = drive(material, [np.broadcast_to(Q, D.shape).copy(), straight(D) @ Q], sigma)
    J = np.linalg.det(straight(D))
    before, after = (1.0, J) if material.kirchhoff else ((1 + J) / 2,) * 2
    pairs = (before, sigma), (after, point.sigma)
    expected = [volume * np.einsum("pab,pab->p", tensors(stress), D) for volume, stress in pairs]
    return Tested("work", off(point.work, np.stack(expected, axis=1), size * subject.stress), bound(16), Part.RATE)
