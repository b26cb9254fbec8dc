"""State of an element before its test: under an isotropic stress, none, or that of soil at rest."""

from dataclasses import replace
from functools import cache
from math import nan, radians, sin
from typing import Any, Literal

import numpy as np

from mpm_verify.cases.element.curves import element_of, start, stress_of
from mpm_verify.cases.element.element import Element, State
from mpm_verify.cases.element.following import follow
from mpm_verify.cases.element.motion import UNIT, matrices
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.solver.state import Floats

Start = Literal["isotropic", "none", "k0", "oedometric"]
LOOSE = 0.01  # of the stress, isotropic: where oedometric loading starts of a material whose stiffness follows stress
SAME = 1e-9  # of the largest stress: what the first row of a file may differ from the start by
STEPS = 400  # of that loading


def begin(material: Any, test: ElementTest, stress: float, how: str = "isotropic") -> State:
    """State at the start of a test.

    `isotropic`: all stresses are `stress`, compression positive (of a loose test a fraction of it); `none`: no stress;
    `k0`: the vertical stress is `stress` and the lateral ones 1 - sin phi of it (Jaky 1944); `oedometric`: the same
    vertical stress, and all that oedometric loading by the material itself leaves, memory included. A material with a
    stress from F has that of its energy: none, or in a motion that starts deformed what this F makes. Stresses that the
    first row of a file gives replace the isotropic ones; any others they have to agree with.

    Raises ValueError for k0 without friction, for none without cohesion where a stress is held, for an oedometric
    stress that is not reached, and for a first row that says another stress.
    """
    state = before(material, test, stress, how)
    if not test.mixed:
        return state
    row = np.append(test.targets[0][:4], [nan] * (4 - min(4, test.size)))[[0, 1, 3, 2]]
    if how == "isotropic" and material.energy is None:
        return element_of(material, test).start(np.where(np.isfinite(row), row, state.sigma))
    check_row(test, row, state.sigma, how if material.energy is None else "")
    return state


def before(material: Any, test: ElementTest, stress: float, how: str) -> State:
    """State at the start of a test, whatever stresses the first row of its file gives."""
    element = element_of(material, test)
    sigma = start(material, test, stress)
    if material.energy is not None:
        return from_energy(material, test, element.start(sigma))
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
    return element.start(sigma)


def from_energy(material: Any, test: ElementTest, undeformed: State) -> State:
    """State with the stress of the energy where a motion starts, which is none unless its first F is deformed."""
    if not test.motion or (test.points[0] == UNIT).all():
        return undeformed
    return replace(undeformed, sigma=stress_of(material, matrices(test.points[:1])[0]))


def check_row(test: ElementTest, row: Floats, sigma: Floats, how: str) -> None:
    """Raise ValueError where stresses (4,) of the first row are not those of the start, or of a stress from F."""
    far = np.abs(row - sigma) > SAME * max(np.abs(sigma).max(), np.nanmax(np.abs(row), initial=0.0))
    for at in np.flatnonzero(far):
        name, file = f"s{('xx', 'yy', 'zz', 'xy')[at]}", test.source.name if test.source else test.name
        said = f"the first row of {file} gives {name} = {row[at]:g}"
        if how:
            raise ValueError(
                f"{said}, and start = {how} makes it {sigma[at] + 0.0:g}; leave --start out, or write that"
            )
        raise ValueError(f"{said}, where a material with a stress from F has {sigma[at] + 0.0:.6g}; write that")


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
