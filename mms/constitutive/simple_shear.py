"""Closed forms of four objective rates in simple shear, F = [[1, gamma], [0, 1]] from zero stress.

The objective rate of sigma is 2 G D; all stresses here are over G. Sources: Dienes (1979) for Jaumann and Green-Naghdi,
Xiao, Bruhns & Meyers (1997) for the logarithmic rate.
"""

from collections.abc import Callable

import numpy as np

from mpm_verify.solver.state import Floats


def green_naghdi(gamma: Floats) -> Floats:
    """Green-Naghdi: s11, s22, s12 (N,3) of shears gamma (N,); s22 = -s11, b = atan(gamma/2)."""
    b = np.arctan(gamma / 2)
    double, log = 2 * b, np.log(np.cos(b))
    s12 = 2 * np.cos(double) * (double - 2 * np.tan(double) * log - np.tan(b))
    s11 = 4 * (np.cos(double) * log + b * np.sin(double) - np.sin(b) ** 2)
    return deviatoric(s11, s12)


def jaumann(gamma: Floats) -> Floats:
    """Jaumann, which oscillates: s12 = sin gamma."""
    return deviatoric(1 - np.cos(gamma), np.sin(gamma))


def logarithmic(gamma: Floats) -> Floats:
    """Logarithmic: the deviator of 2 ln V, h = asinh(gamma/2)."""
    h, root = np.arcsinh(gamma / 2), np.sqrt(4 + gamma**2)
    return deviatoric(2 * h * gamma / root, 4 * h / root)


def truesdell(gamma: Floats) -> Floats:
    """Truesdell: s12 = gamma, s11 = gamma^2, s22 = 0."""
    return np.stack([gamma**2, 0 * gamma, gamma], axis=-1)


def deviatoric(s11: Floats, s12: Floats) -> Floats:
    """Deviatoric stress: s22 = -s11."""
    return np.stack([s11, -s11, s12], axis=-1)


SIMPLE_SHEAR: dict[str, Callable[[Floats], Floats]] = {
    "green_naghdi": green_naghdi,
    "jaumann": jaumann,
    "logarithmic": logarithmic,
    "truesdell": truesdell,
}
