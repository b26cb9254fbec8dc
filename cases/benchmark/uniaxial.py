"""Uniaxial strain of a material with an energy: stress, stiffness and stretch, whatever the energy is."""

from functools import lru_cache
from typing import Any

import numpy as np
from scipy.optimize import brentq

from mpm_verify.solver.state import Floats

STEP = 1e-30  # of a complex step: no digit is lost
SMALL = 1e-5  # step of a difference of stresses, which loses half of them
LEAST = 1e-6  # stretch


def nominal(material: Any, stretch: float) -> float:
    """Nominal stress dW/dF_yy at a stretch along y alone; it is the Cauchy stress too, as the area does not change."""
    F = np.eye(3, dtype=complex)
    F[1, 1] = stretch + 1j * STEP
    return float(np.imag(material.energy(F, np.log)) / STEP)


def stiffness(material: Any, stretch: float) -> float:
    """Derivative of the nominal stress."""
    return (nominal(material, stretch + SMALL) - nominal(material, stretch - SMALL)) / (2 * SMALL)


@lru_cache(maxsize=100_000)
def stretch(material: Any, stress: float) -> float:
    """Stretch at which the nominal stress is `stress`, at most zero. Raises ValueError where there is none."""
    if stress > 0 or nominal(material, LEAST) > stress:
        raise ValueError(f"the material bears no stress of {stress:g} in uniaxial strain; choose a lower column")
    if stress == 0:
        return 1.0
    return float(brentq(lambda each: nominal(material, each) - stress, LEAST, 1.0, xtol=1e-15, rtol=1e-14))


def stretches(material: Any, stress: Floats) -> Floats:
    """Stretches (n,) under nominal stresses (n,)."""
    return np.array([stretch(material, float(one)) for one in stress])
