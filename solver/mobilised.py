"""Helpers of a material that yields by the mobilised ratio eta = t/s of the plane: solver/material/ubcsand.py."""

import numpy as np

from mpm_verify.solver._jit import kernel


@kernel(inline=True)
def slip(t, s, G, stiff, D, a, k, eta_m):
    """Plastic shear strain L > 0 with t - G L = eta(L) (s - stiff D L): the positive root, by the stable formula.

    -1 where there is none: the hyperbola passes by, and what is met is its end, the strength. None is 0 where t is that
    of eta_m to the last bit: rounded below it, it would be taken for one that passes by.
    """
    q = eta_m / (1.0 - a * eta_m)
    open_ = 1.0 + a * q
    A = k * (stiff * D - G * a)
    B = k * (a * t - s) + q * stiff * D - open_ * G
    C = open_ * t - q * s
    C = 0.0 if C < 0.0 else C
    root = B * B - 4.0 * A * C
    return -1.0 if root < 0.0 else 2.0 * C / (np.sqrt(root) - B)  # NaN goes on


@kernel(inline=True)
def onset(eta, x0, y0, s0, x1, y1, s1):
    """Fraction of the way from the old stress to the trial at which t = eta s' is met from inside; s' in s0 and s1."""
    dx, dy, ds = x1 - x0, y1 - y0, s1 - s0
    A = dx * dx + dy * dy - eta * eta * ds * ds
    B = x0 * dx + y0 * dy - eta * eta * s0 * ds
    C = x0 * x0 + y0 * y0 - eta * eta * s0 * s0
    root = np.sqrt(max(B * B - A * C, 0.0))
    fraction = -C / (B + root) if B > 0.0 else (root - B) / A
    return min(max(fraction, 0.0), 1.0)


@kernel(inline=True)
def unit(x, y, ex, ey):
    """Direction of a vector; (ex, ey) where nothing is left of it: under next to no stress t slips to the last bit."""
    square = x * x + y * y
    if square == 0.0:
        return ex, ey
    per = 1.0 / np.sqrt(square)
    return x * per, y * per
