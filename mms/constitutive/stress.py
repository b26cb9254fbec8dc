"""Constitutive model: against the complex step of its energy, and in rate form against turned paths and moduli."""

from functools import partial
from typing import Any

import numpy as np

from mpm_verify.mms.constitutive.driver import (
    Subject,
    apart,
    columns,
    drive,
    elastic,
    random,
    rotated,
    straight,
    strength,
    symmetric,
    turn,
)
from mpm_verify.mms.constitutive.tested import Part, Reason, Tested, attempt, bound, not_asked, off
from mpm_verify.solver.state import Floats

POINTS = 40  # more than a block
TINY = 1e-60  # complex step: no difference is taken, so no digits go
ANGLES = (0.4, 1.9, -2.7)
CONFINED = 1e-3  # mean stress of soils, over rho0 c^2


def tests(subject: Subject) -> list[Tested]:
    """Tests of a function of F, or those of a model in rate form."""
    found = []
    for name, F in deformations().items():
        found += attempt(name, Part.STRESS, partial(energetic, subject, name, F))
    found += attempt("rigid_turn", Part.RATE, partial(turned, subject))
    found += attempt("increment", Part.STRESS, partial(increments, subject))
    found += attempt("constants", Part.STRESS, partial(constants, subject))
    return found + attempt("wave_speed", Part.TIME_STEP, partial(wave, subject))


def deformations() -> dict[str, Floats]:
    """F (P,2,2) with shear, turned so far that none is nearly symmetric, and with stretches that are (nearly) equal."""
    sheared = np.eye(2) + 0.35 * random(POINTS, 2, 2, seed=6)
    turns = np.stack([turn(a) for a in np.linspace(-3, 3, POINTS)])
    even = np.linspace(0.7, 1.5, POINTS)[:, None, None] * np.eye(2)
    even[::4] = np.eye(2)
    even[1::4] += np.geomspace(1e-12, 1e-2, POINTS // 4)[:, None, None] * random(POINTS // 4, 2, 2, seed=16)
    return {"stress": sheared, "stress_turned": turns @ sheared, "stress_even": turns @ even}


def energetic(subject: Subject, name: str, F: Floats) -> Tested:
    """Cauchy stress, zz too, against (dW/dF) F^T / J by the complex step."""
    material = subject.material
    if material.energy is None:
        return not_asked(name, Part.STRESS, Reason.NO_ENERGY)
    if material.rate is not None:
        return not_asked(name, Part.STRESS, Reason.IN_STEPS)
    plane, zz = cauchy(material, F)
    expected = columns(plane, zz)
    found = drive(material, [F], np.zeros((POINTS, 4))).sigma
    skew = off(plane[:, 0, 1], plane[:, 1, 0], subject.stress)
    return Tested(name, max(off(found, expected, subject.stress), skew), bound(16), Part.STRESS)


def cauchy(material: Any, F: Floats) -> tuple[Floats, Floats]:
    """Cauchy stress (P,2,2) in the plane, and its zz (P,), of F (P,2,2), by the complex step of the energy."""
    P, zz = slopes(material, F)
    J = np.linalg.det(F)
    return (P, zz) if material.small_strain else (P @ F.transpose(0, 2, 1) / J[:, None, None], zz / J)


def slopes(material: Any, F: Floats) -> tuple[Floats, Floats]:
    """First Piola stress dW/dF in the plane (P,2,2), and its zz (P,)."""
    full = np.zeros((3, 3, len(F)), complex)
    full[:2, :2], full[2, 2] = F.transpose(1, 2, 0), 1.0

    def slope(i: int, j: int) -> Floats:
        moved = full.copy()
        moved[i, j] += 1j * TINY
        found: Floats = np.imag(material.energy(moved, np.log)) / TINY
        return found

    P = np.array([[slope(i, j) for j in range(2)] for i in range(2)]).transpose(2, 0, 1)
    return P, slope(2, 2)


def confined(subject: Subject, ratio: float = 0.5) -> Floats:
    """Stresses (P,4) in compression, t/s below strength by `ratio`, in axes of any direction."""
    mean, material = CONFINED * subject.stress, subject.material
    most = strength(material)[0] if material.friction_angle else 0.5
    if material.friction_angle == 0:
        most = min(most, strength(material)[1] / mean)
    angle = 3 * random(POINTS, seed=7)
    t = ratio * most * mean
    normal = t * np.cos(angle)
    found: Floats = np.stack([normal - mean, -normal - mean, np.full(POINTS, -mean), t * np.sin(angle)], axis=1)
    return found


def turned(subject: Subject) -> list[Tested]:
    """Rate form: a turn of any angle turns the stress and strains nothing; a path that is turned turns its stress."""
    names, material = ("rigid_turn", "turned_path"), subject.material
    if material.rate is None:
        return [not_asked(name, Part.RATE, Reason.NO_RATE_FORM) for name in names]
    sigma = confined(subject)
    F = np.eye(2) + 0.1 * random(POINTS, 2, 2, seed=8)
    worst = dict.fromkeys(names, 0.0)
    for angle in ANGLES:
        Q = turn(angle)
        end = drive(material, [F, Q @ F], sigma)
        worst["rigid_turn"] = max(
            worst["rigid_turn"],
            off(end.sigma, rotated(sigma, Q), subject.stress),
            apart(material, end.history, material.initial(sigma), subject.stress),
        )
        if getattr(material, "reversal", 0.0):
            continue
        path = [F, F + 2e-3 * random(POINTS, 2, 2, seed=9), F + 3e-3 * random(POINTS, 2, 2, seed=10)]
        plain, moved = drive(material, path, sigma), drive(material, [Q @ one for one in path], rotated(sigma, Q))
        worst["turned_path"] = max(worst["turned_path"], off(moved.sigma, rotated(plain.sigma, Q), subject.stress),
                                   apart(material, moved.history, plain.history, subject.stress))  # fmt: skip
    return [Tested(name, found, bound(64), Part.RATE) for name, found in worst.items()]


def increments(subject: Subject) -> Tested:
    """Rate form: elastic stress increments of a stretch without rotation, zz too, by the moduli that are stated."""
    name, material = "increment", subject.material
    if material.rate is None:
        return not_asked(name, Part.STRESS, Reason.NO_RATE_FORM)
    if material.rate == "truesdell":
        return not_asked(name, Part.STRESS, Reason.STRETCHED)
    moduli = elastic_moduli(material, CONFINED * subject.stress)
    if moduli is None:
        return not_asked(name, Part.STRESS, Reason.NO_MODULI)
    lam, mu = moduli
    D = symmetric((1e-8 if material.moduli else 1e-5) * random(POINTS, 3, seed=11))  # moduli follow the mean stress
    sigma = confined(subject, 0.3)
    history = material.initial(confined(subject, 0.9))
    start = np.broadcast_to(np.eye(2), D.shape)
    found = drive(material, [start, straight(D)], sigma, history if history.size else None).sigma
    expected = sigma + elastic(lam, mu, D)
    if material.kirchhoff:
        expected /= np.linalg.det(straight(D))[:, None]
    return Tested(name, off(found, expected, subject.stress), bound(16), Part.STRESS)


def constants(subject: Subject) -> Tested:
    """Shear and bulk modulus E / 2(1 + nu) and E / 3(1 - 2 nu) of Young's modulus and Poisson's ratio."""
    material = subject.material
    if not all(hasattr(material, name) for name in ("E", "nu", "lam", "mu")):
        return not_asked("constants", Part.STRESS, Reason.NO_MODULI)
    E, nu = material.E, material.nu
    bulk = material.lam + 2 * material.mu / 3
    residual = max(off(2 * (1 + nu) * material.mu, E, E), off(3 * (1 - 2 * nu) * bulk, E, E))
    return Tested("constants", residual, bound(4), Part.STRESS)


def wave(subject: Subject) -> Tested:
    """Speed of the compression wave, rho0 c^2 = lam + 2 mu, at a mean stress where the moduli follow it."""
    mean, material = CONFINED * subject.stress, subject.material
    moduli = elastic_moduli(material, mean)
    if moduli is None:
        return not_asked("wave_speed", Part.TIME_STEP, Reason.NO_MODULI)
    stiff = moduli[0] + 2 * moduli[1]
    residual = off(material.rho0 * material.wave_speed(mean) ** 2, stiff, stiff)
    return Tested("wave_speed", residual, bound(8), Part.TIME_STEP)


def elastic_moduli(material: Any, mean: float) -> tuple[float, float] | None:
    """Lame's constants at a mean stress, None where a material does not state them."""
    if material.moduli is not None:
        G, K = material.moduli(mean)
        return K - 2 * G / 3, G
    if hasattr(material, "lam") and hasattr(material, "mu"):
        return material.lam, material.mu
    return None
