"""Memory of a soil: sums go on from what they were, plastic strain is what elasticity leaves, tension and voids."""

from functools import partial
from math import inf, radians, tan

import numpy as np

from mpm_verify.mms.constitutive.driver import (
    Point,
    Subject,
    apart,
    circle,
    compliance,
    drive,
    random,
    straight,
    strength,
    symmetric,
)
from mpm_verify.mms.constitutive.stress import CONFINED, POINTS, confined
from mpm_verify.mms.constitutive.tested import FAILED, Part, Reason, Tested, attempt, bound, not_asked, off
from mpm_verify.solver.state import Floats
from mpm_verify.solver.voids import remembering

STEPS = 3
BEFORE = 0.017  # what a sum holds before the path


def tests(subject: Subject) -> list[Tested]:
    """Sums of the memory, plastic strain, strength, tension cut-off, and void strain."""
    found = attempt("history_sums", Part.HISTORY, partial(sums, subject))
    found += attempt("plastic_volume", Part.HISTORY, partial(plastic, subject))
    found += attempt("strength", Part.STRESS, partial(admissible, subject))
    found += attempt("cut_off", Part.CUT_OFF, partial(cut_off, subject))
    return found + attempt("void_contact", Part.HISTORY, partial(contact, subject))


def strain(subject: Subject) -> Floats:
    """Strain increments (P,2,2) far beyond yield."""
    size = 2.0 * CONFINED * subject.stress / subject.stiffness(CONFINED * subject.stress)
    return symmetric(size * random(POINTS, 3, seed=12))


def sheared(subject: Subject, history: Floats | None = None, steps: int = STEPS) -> Point:
    """Points under compression after steps of those increments, without rotation in each."""
    material, D = subject.material, strain(subject)
    unit = np.broadcast_to(np.eye(2), D.shape)
    point = Point(confined(subject), material.initial(confined(subject)) if history is None else history)
    for _ in range(steps):
        point = drive(material, [unit, straight(D)], point.sigma, point.history)
    return point


def sums(subject: Subject) -> Tested:
    """Columns of the memory that are sums: with another number in them before, they are larger by it, and no else."""
    name, material = "history_sums", subject.material
    columns = [material.memory.index(one) for one in material.sums]
    if not columns:
        return not_asked(name, Part.HISTORY, Reason.NO_SUMS)
    plain = sheared(subject)
    raised = material.initial(confined(subject))
    raised[:, columns] += BEFORE
    moved = sheared(subject, raised)
    expected = plain.history.copy()
    expected[:, columns] += BEFORE
    grown = np.abs(plain.history[:, columns]).max()
    residual = max(
        apart(material, moved.history, expected, subject.stress),
        off(moved.sigma, plain.sigma, subject.stress),
    )
    return Tested(name, residual if grown > 0 else FAILED, bound(16 * STEPS), Part.HISTORY)


def plastic(subject: Subject) -> list[Tested]:
    """Linear elastic soils: volume and largest shear of the strain that elasticity leaves, against the memory."""
    names, material = ("plastic_volume", "plastic_shear"), subject.material
    names_of = material.memory
    if not {"gamma_p", "eps_v_p"} <= set(names_of) or not hasattr(material, "lam"):
        return [not_asked(name, Part.HISTORY, Reason.NO_SUMS) for name in names]
    if material.rate == "truesdell":
        return [not_asked(name, Part.HISTORY, Reason.STRETCHED) for name in names]
    start, D = confined(subject), strain(subject)
    volume, shear = 0.0, 0.0
    point = Point(start, material.initial(start))
    for _ in range(STEPS):
        end = drive(material, [np.broadcast_to(np.eye(2), D.shape).copy(), straight(D)], point.sigma, point.history)
        left = np.stack([D[:, 0, 0], D[:, 1, 1], 0 * D[:, 0, 0], D[:, 0, 1]], axis=1)
        left = left - compliance(material.lam, material.mu, end.sigma - point.sigma)
        grown = end.history - point.history
        opened = grown[:, names_of.index("void")] if "void" in names_of else 0.0
        volume = max(volume, off(left[:, :3].sum(axis=1), grown[:, names_of.index("eps_v_p")] + opened, 1.0))
        shear = max(shear, off(spread(left), grown[:, names_of.index("gamma_p")], 1.0))
        point = end
    told = [Tested("plastic_volume", volume, bound(16), Part.HISTORY)]
    if getattr(material, "void", 0.0):
        return [*told, not_asked("plastic_shear", Part.HISTORY, Reason.OPENED)]
    return [*told, Tested("plastic_shear", shear, bound(16), Part.HISTORY)]


def spread(strain: Floats) -> Floats:
    """Largest less smallest principal strain (P,) of strains xx, yy, zz, xy (P,4)."""
    middle, radius = (strain[:, 0] + strain[:, 1]) / 2, np.hypot((strain[:, 0] - strain[:, 1]) / 2, strain[:, 3])
    principal = np.stack([middle + radius, middle - radius, strain[:, 2]])
    found: Floats = principal.max(axis=0) - principal.min(axis=0)
    return found


def admissible(subject: Subject) -> Tested:
    """Frictional soils: t <= s sin phi + c cos phi in the plane after strains far beyond yield."""
    name, material = "strength", subject.material
    if material.friction_angle is None or not material.yields_in_plane:
        reason = Reason.NO_FRICTION if material.friction_angle is None else Reason.IN_SPACE
        return not_asked(name, Part.STRESS, reason)
    sine, cohesive = strength(material)
    s, t = circle(sheared(subject, steps=8).sigma)
    excess = np.maximum(t - s * sine - cohesive, 0.0)
    return Tested(name, off(excess, 0.0, CONFINED * subject.stress), bound(64), Part.STRESS)


def cut_off(subject: Subject) -> Tested:
    """Frictional soils pulled apart in all directions: no stress beyond cut-off or apex c cot phi."""
    name, material = "cut_off", subject.material
    if material.friction_angle is None:
        return not_asked(name, Part.CUT_OFF, Reason.NO_FRICTION)
    apex = (material.cohesion or 0.0) / tan(radians(material.friction_angle)) if material.friction_angle else inf
    tension = min(apex, getattr(material, "sigma_t", inf))
    if material.moduli is not None:
        tension = 0.0  # what has come apart has no stress
    if tension == inf:
        return not_asked(name, Part.CUT_OFF, Reason.NO_CUT_OFF)
    start = confined(subject)
    size = (
        20
        * (CONFINED * subject.stress + (apex if apex < inf else tension))
        / subject.stiffness(CONFINED * subject.stress)
    )
    D = symmetric(size * np.array([1.0, 1.1, 0.1]) * np.ones((POINTS, 1)))
    point = drive(material, [np.broadcast_to(np.eye(2), D.shape).copy(), straight(D)], start)
    unit = CONFINED * subject.stress + tension
    plane = off(point.sigma[:, [0, 1, 3]], np.array([tension, tension, 0.0]), unit)
    zz = point.sigma[:, 2] - tension
    beyond = np.abs(zz) if tension == apex or material.moduli is not None else np.maximum(zz, 0.0)
    return Tested(name, max(plane, off(beyond, 0.0, unit)), bound(64), Part.CUT_OFF)


def contact(subject: Subject) -> Tested:
    """Void strain: a step that closes it is the part of the step behind contact; one that does not leaves no stress."""
    name, material = "void_contact", subject.material
    material = remembering(material)
    if not getattr(material, "void", 0.0):
        return not_asked(name, Part.HISTORY, Reason.NO_VOID)
    if material.rate == "truesdell":
        return not_asked(name, Part.HISTORY, Reason.STRETCHED)
    sigma, D = np.zeros((POINTS, 4)), 10 * strain(subject)
    volume, column = np.trace(D, axis1=1, axis2=2), material.memory.index("void")
    void = np.abs(volume) * (1 + 0.7 * random(POINTS, seed=13))  # half of those that are compressed touch
    touches = volume < -void
    history = material.initial(sigma)
    history[:, column] = void
    unit = np.broadcast_to(np.eye(2), D.shape).copy()
    found = drive(material, [unit, straight(D)], sigma, history)
    behind = np.where(touches, 1 + void / np.where(touches, volume, 1.0), 0.0)
    known = drive(material, [unit, straight(behind[:, None, None] * D)], sigma, material.initial(sigma))
    expected = known.history.copy()
    expected[:, column] += np.where(touches, 0.0, void + volume)
    residual = max(
        off(found.sigma, known.sigma, 10 * CONFINED * subject.stress),
        apart(material, found.history, expected, subject.stress),
    )
    return Tested(name, residual if touches.any() else FAILED, bound(64), Part.HISTORY)
