"""Hardening sand: what its equations leave of steps so short that the solution of each is found to round-off.

The equations are those of the model's documentation (solver/material/ubcsand.py) over a step, with moduli and axes of
slip of its middle: linear elasticity of what is not slip, the exact hyperbola of hardening, and the mean of the flow
over it. They are implicit: passes that seek their solution leave a power of the step, which of these is round-off.
"""

from dataclasses import dataclass
from functools import partial
from math import radians, sin, tan
from typing import Any

import numpy as np

from mpm_verify.mms.constitutive.driver import Point, Subject, apart, circle, random, responded, symmetric
from mpm_verify.mms.constitutive.stress import POINTS
from mpm_verify.mms.constitutive.tested import FAILED, Part, Reason, Tested, attempt, bound, not_asked, off
from mpm_verify.solver.state import Floats

PARTS = {"secant": Part.STRESS, "hardening": Part.STRESS, "flow_rule": Part.HISTORY, "neutral": Part.STRESS}
MANY = 4000  # some in a thousand are rounded to the other side of the yield surface
SHORT = 1e-4  # largest strain increments times G, over the mean stress
POINTS_OF_GAUSS = np.polynomial.legendre.leggauss(5)


def tests(subject: Subject) -> list[Tested]:
    """Elastic and plastic steps of a hardening sand."""
    if subject.material.name != "ubcsand":
        return [not_asked(name, part, Reason.NO_HARDENING) for name, part in PARTS.items()]
    found = attempt("secant", Part.STRESS, partial(steps, subject))
    return found + attempt("neutral", Part.STRESS, partial(neutral, subject))


def eta_f(sand: Any) -> float:
    """Failure ratio sin phi_f, written out: what the class under test makes of its angles is tested too."""
    return sin(radians(sand.phi_f))


def eta_cv(sand: Any) -> float:
    """Ratio of constant volume, sin phi_pt."""
    return sin(radians(sand.phi_pt))


def shift(sand: Any) -> float:
    """Shift c cot phi_f of s, a stress."""
    return float(sand.c / tan(radians(sand.phi_f)))


@dataclass(frozen=True)
class Ends:
    """Both ends of a step: centre s, compression positive, radius t of Mohr's circle, zz, and (xx - yy)/2, xy (P,2)."""

    s: Floats
    t: Floats
    zz: Floats
    away: Floats


def ends(sigma: Floats) -> Ends:
    """Ends of stresses (P,4)."""
    return Ends(*circle(sigma), sigma[:, 2], np.stack([(sigma[:, 0] - sigma[:, 1]) / 2, sigma[:, 3]], axis=1))


def steps(subject: Subject) -> list[Tested]:
    """One short step from each of many states: on the branch, at failure, and far below what was mobilised."""
    sand = subject.material
    start, D = states(sand)
    end = responded(sand, start.sigma, D, start.history)
    grown, of = end.history - start.history, sand.memory.index
    before, after = ends(start.sigma), ends(end.sigma)
    slip, opened = grown[:, of("gamma_p")], grown[:, of("eps_v_p")]
    eta = start.history[:, of("eta_m")], end.history[:, of("eta_m")]
    mean = (before.s + after.s) / 2
    slips = slip > 0
    found = {
        "secant": elastic(sand, before, after, mean, D, slip, opened),
        "hardening": hardened(sand, after, mean, *eta, slip),
        "flow_rule": flow(sand, mean, *eta, slip, opened, grown[:, of("work_p")]),
    }
    both = 0 < slips.sum() < len(slips)  # a sand that only slips, or never does, was not tested
    return [Tested(name, off(one, 0.0, 1.0) if both else FAILED, bound(64), PARTS[name]) for name, one in found.items()]


def states(sand: Any) -> tuple[Point, Floats]:
    """Stresses, memories and strain increments (P,2,2): s from 1/30 to 3 times atmospheric, axes of any direction."""
    s = sand.Pa * 10 ** (-0.5 + random(POINTS, seed=31))
    eta = eta_f(sand) * (0.65 + 0.3 * random(POINTS, seed=32))
    eta[::4] = eta_f(sand)
    t, angle = eta * (s + shift(sand)), 3 * random(POINTS, seed=33)
    half = t * np.cos(angle)
    sigma = np.stack([half - s, -half - s, -0.8 * s, t * np.sin(angle)], axis=1)
    history = sand.initial(sigma)
    history[::4, 0] = eta_f(sand)
    history[1::4, 0] = (eta_f(sand) + eta[1::4]) / 2
    size = SHORT * s / (sand.KGe * sand.Pa * (s / sand.Pa) ** sand.ne)
    return Point(sigma, history), symmetric(size[:, None] * random(POINTS, 3, seed=34))


def neutral(subject: Subject) -> Tested:
    """Steps of no strain, and of strains that are round-off, from many states on the branch: nothing changes."""
    sand = subject.material
    s, eta, angle = (random(MANY, seed=seed) for seed in (35, 36, 37))
    s, eta = sand.Pa * 10 ** (1.5 * s - 1), eta_f(sand) * np.abs(eta)
    t = eta * (s + shift(sand))
    half = t * np.cos(3 * angle)
    sigma = np.stack([half - s, -half - s, -0.8 * s, t * np.sin(3 * angle)], axis=1)
    begun, worst = sand.initial(sigma), 0.0
    for size in (0.0, 2.0**-64):
        end = responded(sand, sigma, symmetric(size * random(MANY, 3, seed=38)), begun)
        moved = (end.sigma - sigma) / (s + shift(sand))[:, None]
        worst = max(worst, off(moved, 0.0, 1.0), apart(sand, end.history, begun, sand.Pa))
    return Tested("neutral", worst, bound(64), Part.STRESS)


def elastic(
    sand: Any, before: Ends, after: Ends, mean: Floats, D: Floats, slip: Floats, opened: Floats
) -> list[Floats]:
    """Distances from linear elasticity of the strain that is no slip, moduli those of the mean stress, over that."""
    level = np.maximum(mean / sand.Pa, sand.s_min)
    G, K = sand.KGe * sand.Pa * level**sand.ne, sand.KBe * sand.Pa * level**sand.me
    volume = np.trace(D, axis1=1, axis2=2) - opened
    axes = before.away + after.away
    axes = axes / np.linalg.norm(axes, axis=1)[:, None]
    sheared = np.stack([D[:, 0, 0] - D[:, 1, 1], 2 * D[:, 0, 1]], axis=1) - slip[:, None] * axes
    left = after.away - before.away - G[:, None] * sheared
    return [
        (after.s - before.s + (K + G / 3) * volume) / mean,
        (after.zz - before.zz - (K - 2 * G / 3) * volume) / mean,
        left[:, 0] / mean,
        left[:, 1] / mean,
    ]


def hyperbola(sand: Any, eta: Floats) -> Floats:
    """Slip q that mobilises eta from nothing, times the stiffness: q = eta / (1 - Rf eta / eta_f)."""
    q: Floats = eta / (1 - sand.Rf * eta / eta_f(sand))
    return q


def hardened(sand: Any, after: Ends, mean: Floats, first: Floats, last: Floats, slip: Floats) -> list[Floats]:
    """Distances from the hyperbola of what slips below failure, from t = eta s' there, and from t <= eta s'."""
    at = np.clip(mean / sand.Pa, sand.s_min, None)
    stiff = sand.KGp * sand.Pa * at**sand.np / (mean + shift(sand))
    q = hyperbola(sand, last) - hyperbola(sand, first) - stiff * slip
    excess = (after.t - last * (after.s + shift(sand))) / mean
    return [
        np.where(last >= eta_f(sand), np.maximum(q, 0.0), q),
        np.where(slip > 0, excess, np.maximum(excess, 0.0)),
        np.where(slip > 0, np.maximum(last - eta_f(sand), 0.0), last - first),
    ]


def flow(
    sand: Any, mean: Floats, first: Floats, last: Floats, slip: Floats, opened: Floats, work: Floats
) -> list[Floats]:
    """Distances of volume and work of the slip from (eta - eta_cv) and s' eta of its mean, over the step."""
    q0, q1 = hyperbola(sand, first), hyperbola(sand, last)
    points, weights = POINTS_OF_GAUSS
    q = (q0 + q1)[:, None] / 2 + (q1 - q0)[:, None] / 2 * points
    eta = (q / (1 + sand.Rf / eta_f(sand) * q)) @ weights / 2
    return [
        (opened - (eta - eta_cv(sand)) * slip) / SHORT,
        (work - ((mean + shift(sand)) * eta * slip - mean * (eta - eta_cv(sand)) * slip)) / mean / SHORT,
    ]
