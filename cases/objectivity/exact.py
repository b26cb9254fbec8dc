"""Closed forms of frame indifference: a stress turned with its body, and one compressed along an axis; the turn."""

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


def turn(angle: float) -> Floats:
    """Rotation by an angle, counter-clockwise (2,2)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])
