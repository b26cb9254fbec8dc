"""Closed forms of frame indifference: a stress turned with its body, and four rates in simple shear.

Simple shear is F = [[1, gamma], [0, 1]] from zero stress, with the objective rate of sigma = 2 G D; all stresses here
are over G. Sources: Dienes (1979) for Jaumann and Green-Naghdi, Xiao, Bruhns & Meyers (1997) for the logarithmic rate.
"""

from collections.abc import Callable

import numpy as np

from mpm_verify.solver.state import Floats


def rotated(horizontal: Floats | float, vertical: Floats | float, angle: Floats) -> Floats:
    """Rotated stress R diag(horizontal, vertical) R^T for angles (N,), counter-clockwise, as xx, yy, xy (N,3)."""
    c, s = np.cos(angle), np.sin(angle)
    xx, yy = horizontal * c**2 + vertical * s**2, horizontal * s**2 + vertical * c**2
    stress: Floats = np.stack([xx, yy, (horizontal - vertical) * s * c], axis=-1)
    return stress


def ramped_column(t: Floats, c: float, H: float, modes: int = 200) -> Floats:
    """Mean vertical stress of an elastic column under a gravity that grows as t, over its static value at t = 1.

    Linear waves of speed c in a height H, fixed below and free above, from rest: modes sin((2k-1) pi y / 2H).
    """
    n = 2.0 * np.arange(1, modes + 1) - 1
    w = n * np.pi * c / (2 * H)
    late = t[:, None] - np.sin(w * t[:, None]) / w
    fraction = 32 / (np.pi * n) ** 3 * np.sign(np.sin(n * np.pi / 2))  # of a mode in the shortening; sum 1
    stress: Floats = -(late * fraction).sum(axis=1)
    return stress


def compressed(stretch: float, lam: float, mu: float, rate: str) -> Floats:
    """Stress xx, yy, zz of a hypoelastic body stretched along x alone: C : ln U of all rates but Truesdell's."""
    if rate == "truesdell":
        lateral = lam * (1 - 1 / stretch)
        return np.array([(lam + 2 * mu) * (stretch - 1), lateral, lateral])
    stress: Floats = np.array([lam + 2 * mu, lam, lam]) * np.log(stretch)
    return stress


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
