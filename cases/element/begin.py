"""State of an element before its test: under an isotropic stress, none, or that of soil at rest."""

from functools import cache
from math import nan, radians, sin
from typing import Any, Literal

import numpy as np

from mpm_verify.cases.element.curves import element_of, start
from mpm_verify.cases.element.element import Element, State
from mpm_verify.cases.element.following import follow
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.solver.state import Floats

Start = Literal["isotropic", "none", "k0", "oedometric"]
LOOSE = 0.01  # of the stress, isotropic: where oedometric loading starts of a material whose stiffness follows stress
STEPS = 400  # of that loading


def begin(material: Any, test: ElementTest, stress: float, how: str = "isotropic") -> State:
    """State at the start of a test.

    `isotropic`: all stresses are `stress`, compression positive (of a loose test a fraction of it); `none`: no stress;
    `k0`: the vertical stress is `stress` and the lateral ones 1 - sin phi of it (Jaky 1944); `oedometric`: the same
    vertical stress, and all that oedometric loading by the material itself leaves, memory included. Stresses that the
    first row of a file gives replace those.

    Raises ValueError for k0 without friction, for none without cohesion where a stress is held, and for an oedometric
    stress that is not reached.
    """
    element = element_of(material, test)
    sigma = start(material, test, stress)
    if material.energy is not None:
        return element.start(sigma)
    if how == "none":
        check_bare(material, test)
        sigma = np.zeros(4)
    elif how == "k0":
        sigma = at_rest(material, stress)
    elif how == "oedometric":
        loaded = oedometric(material, stress)
        if loaded is None:
            raise ValueError(f"start = oedometric: no strain leads to {stress:g} Pa; choose a lower stress")
        return State(element.start(sigma).strain, loaded.sigma, loaded.history)
    if test.mixed:
        first = np.append(test.targets[0][:4], [nan] * (4 - min(4, test.size)))[[0, 1, 3, 2]]
        sigma = np.where(np.isfinite(first), first, sigma)
    return element.start(sigma)


def check_bare(material: Any, test: ElementTest) -> None:
    """Raise ValueError for a test that holds no stress of a soil without cohesion: there it has no strength."""
    holds = any(condition.of == "stress" for condition in test.conditions)
    if holds and material.friction_angle is not None and not material.cohesion:
        raise ValueError(
            f"start = none: {test.name} of a soil without cohesion has no strength; give it c, or a stress"
        )


def at_rest(material: Any, stress: float) -> Floats:
    """Stress (4,) with K0 = 1 - sin phi."""
    if material.friction_angle is None:
        raise ValueError("start = k0 must have a material with an angle of friction; choose start = oedometric")
    K0 = 1 - sin(radians(material.friction_angle))
    return -stress * np.array([K0, 1.0, K0, 0.0])


@cache
def oedometric(material: Any, stress: float) -> State | None:
    """State after oedometric loading to the vertical stress; None where it ends early."""
    follows = material.moduli is not None
    first = -LOOSE * stress * np.array([1.0, 1.0, 1.0, 0.0]) * follows
    points = np.array([[0.0, 0.0, 0.0], [0.0, nan, 0.0]])
    targets = np.array([[nan, nan, nan], [nan, -stress, nan]])
    test = ElementTest("oedometric", "", (), 1.0, points=points, targets=targets)
    found = follow(Element(material), test, STEPS, first)
    return None if found.failed else State(np.zeros(3), found.sigma[-1], found.history[-1])
