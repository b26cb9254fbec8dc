"""Stress that one strain step makes, against the stress at the start of a test: what its steps can resolve.

The strength of a soil with friction is in proportion to its stress. Where a step makes more than that, elastically, it
goes through the whole test at once: no strain may then be found that leads to what is asked, and there is no order yet.
And below 1e-9 of the stiffness round-off of the steps decides on which side of a tension cut-off the soil is.
"""

from math import ceil, isfinite
from typing import Any

import numpy as np

from mpm_verify.cases.element.axes import MOST_STEPS
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.cases.element.study import DOUBLED, ElementStudy

DIGITS = 1e-9  # of the stiffness: a stress below it has too few digits left
WHOLE, ORDERLY = 1.0, 0.9  # stress of a step over that at the start, with which tests end, and have their order
STEP, TRIES = 1.5, 100  # stresses that are tried for one that is resolved: up to 4e17 times the one that is not


def made(material: Any, test: ElementTest, stress: float, steps: int) -> float:
    """Elastic stress that one of the steps makes, over `stress` (above zero) and cohesion; 0 where it does not matter.

    That is without friction, on a path from a file, of a model that does not say its moduli, and where these are
    constant and no stress is held.
    """
    held = material.moduli is not None or any(condition.of == "stress" for condition in test.conditions)
    if material.friction_angle is None or len(test.points) or not held or stress <= 0:
        return 0.0
    far = max(abs(condition.fraction) for condition in test.conditions)
    strain = far * test.length * (test.legs if test.cyclic else 1) / steps
    return stiffness(material, stress) * strain / (stress + (material.cohesion or 0.0))


def at_start(studied: ElementStudy) -> float:
    """Largest stress at the start of a test, compression positive; 0 where its curve cannot be read."""
    return max((float(studied.curve[name][0]) for name in ("sx", "sy", "sz") if name in studied.curve), default=0.0)


def stiffness(material: Any, stress: float) -> float:
    """Stress per strain of one direction under a stress, compression positive; 0 of a model that does not say it."""
    if material.moduli is not None:
        G, K = material.moduli(stress)
        return float(K + 4 * G / 3)
    return float(getattr(material, "lam", 0.0) + 2 * getattr(material, "mu", 0.0))


def check_stress(material: Any, test: ElementTest, stress: float, steps: int) -> None:
    """Raise ValueError, with what is resolved, for a stress at the start that even the finest steps are not."""
    if not resolved(material, test, stress, steps):
        raise ValueError(
            f"stress = {stress:g}: one strain step of {test.name} makes more than this in {material.name}, or "
            f"round-off does; choose {_instead(material, test, stress, steps)}--start none"
        )


def _instead(material: Any, test: ElementTest, stress: float, steps: int) -> str:
    """Phrase on a stress that is resolved, or else on steps that resolve this one, before `or`; empty without both.

    No stress is resolved where a stiffness is in proportion to stress, or not a number.
    """
    found = next((s for k in range(TRIES) if resolved(material, test, s := stress * STEP**k, steps)), None)
    if found is not None:
        return f"{float(f'{1.05 * found:.1e}'):g} or more, or "
    factor = made(material, test, stress * test.loose, test.steps(steps) * DOUBLED[-1]) / WHOLE
    more = ceil(1.05 * steps * factor) if isfinite(factor) else 0
    enough = 0 < more <= MOST_STEPS and resolved(material, test, stress, more)
    return f"--steps {more} or more, or " if enough else ""


def check_digits(material: Any, test: ElementTest) -> None:
    """Raise ValueError for stresses of a file of which round-off leaves no digits beside the stiffness of a soil."""
    largest = float(np.nanmax(np.abs(test.targets), initial=0.0))
    least = DIGITS * stiffness(material, largest)
    if material.friction_angle is not None and 0 < largest < least and test.source:
        raise ValueError(
            f"{test.source.name}: stresses up to {largest:g} are below round-off in {material.name}; write {least:.1g} "
            "or more, or their unit, as in sxx [kPa]"
        )


def resolved(material: Any, test: ElementTest, stress: float, steps: int) -> bool:
    """Whether the finest steps resolve it."""
    confined = stress * test.loose
    finest = test.steps(steps) * DOUBLED[-1]
    digits = material.friction_angle is None or confined >= DIGITS * stiffness(material, confined)
    return digits and made(material, test, confined, finest) <= WHOLE
