"""What the GIMP bases share: a hat function averaged over an interval, by its antiderivative."""

import numpy as np

from solver._jit import kernel
from solver.layout import Layout
from solver.state import Floats


@kernel(inline=True)
def value(s, half):
    """Mean over (s - half, s + half) of the hat max(0, 1 - |s|); lengths in cells. Bardenhagen & Kober 2004, S_ip."""
    above = min(max(s + half, -1.0), 1.0)
    below = min(max(s - half, -1.0), 1.0)
    return (above - below - 0.5 * (above * abs(above) - below * abs(below))) / (2.0 * half)


@kernel(inline=True)
def slope(s, half):
    """Derivative of the mean by s."""
    return (max(0.0, 1.0 - abs(s + half)) - max(0.0, 1.0 - abs(s - half))) / (2.0 * half)


def half_lengths(layout: Layout) -> Floats:
    """Half lengths (P,2) of domains along the axes: of a turned domain, its extents scaled to its area."""
    extent: Floats = np.abs(layout.r0).sum(axis=1)
    return extent * np.sqrt(layout.V0 / (4.0 * extent.prod(axis=1)))[:, None]
