"""Helpers of the GIMP bases: a hat function averaged over an interval, by its antiderivative."""

import numpy as np

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.state import Floats


@kernel(inline=True)
def clip(s):
    """s between -1 and 1; by absolute values, because min and max are branches, and the vectoriser passes them by."""
    return 0.5 * (abs(s + 1.0) - abs(s - 1.0))


@kernel(inline=True)
def hat(s):
    """max(0, 1 - |s|), zero to the bit where it is."""
    inside = 1.0 - abs(s)
    return 0.5 * (inside + abs(inside))


@kernel(inline=True)
def value(s, half, per_length):
    """Mean of the hat over (s - half, s + half), lengths in cells; per_length = 1 / (2 half).

    Source: Bardenhagen & Kober 2004, S_ip.
    """
    above = clip(s + half)
    below = clip(s - half)
    return (above - below - 0.5 * (above * abs(above) - below * abs(below))) * per_length


@kernel(inline=True)
def slope(s, half, per_length):
    """Derivative of the mean by s."""
    return (hat(s + half) - hat(s - half)) * per_length


def half_lengths(layout: Layout) -> Floats:
    """Half lengths (P,2) of domains in x and y: of a turned domain, its extents scaled to its area."""
    extent: Floats = np.abs(layout.r0).sum(axis=1)
    half: Floats = extent * np.sqrt(layout.V0 / (4.0 * extent.prod(axis=1)))[:, None]
    return half
