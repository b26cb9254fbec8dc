"""Sequences of errors whose right verdict is known: what the order rule is measured with, see power.py.

Second order is expected and C = 1. A sequence is sound if it tends to second order, has it nearly on the finest pair of
cells (in `BAND`), and at most `LIMIT` of its finest error is a leak or a floor; and bad otherwise. So a floor of 1e-5
is sound down to h = 1/32 and bad at h = 1/128; h^2 / (1 + 16 h), of order 1.62 at h = 1/32, is the other way round.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.judging.fit import local_orders

Array = NDArray[np.float64]

BAND = (1.8, 2.3)  # of the local order, see records.py
LIMIT = 0.10  # of the finest error: what order.py lets pass, and says so
PER_CELL = 4  # errors of random sign in each cell
SCATTERS = (0.0, 0.01, 0.03, 0.15)  # standard deviation of the logarithm of an error
CELLS = {"default": (8, 16, 32, 64, 128), "quick": (8, 12, 16, 24, 32), "six levels": (8, 16, 32, 64, 128, 256)}


def _nothing(h: Array) -> float:
    return 0.0


def _everything(h: Array) -> float:
    return 1.0


@dataclass(frozen=True)
class Known:
    """Sequence of errors whose right verdict is known.

    Parameters
    ----------
    name
        Formula of the error.
    error
        Errors (n,) at cell sizes (n,), coarse to fine.
    other
        Fraction of the finest error that is not of second order.
    cross
        Twice the product (n,) of the two parts of the error over its square, where their signs are random.
    """

    name: str
    error: Callable[[Array], Array]
    other: Callable[[Array], float] = _nothing
    cross: Callable[[Array], Array] | None = None

    def sound(self, h: Array) -> bool:
        """Whether PASS is the right verdict, not FAIL, on these levels."""
        (last,) = local_orders(h[-2:], self.error(h[-2:]))
        return self.other(h) <= LIMIT and BAND[0] <= last <= BAND[1]

    def drawn(self, h: Array, scatter: float, rng: np.random.Generator) -> Array:
        """Errors (n,) of one draw; the scatter multiplies each by exp(scatter N(0, 1))."""
        error = self.error(h)
        if self.cross:
            count = np.rint(PER_CELL / h**2).astype(np.int64)
            mean = 2 * rng.binomial(count, 0.5) / count - 1  # of as many random signs
            error = error * np.sqrt(1 + mean * self.cross(h))
        found: Array = error * np.exp(scatter * rng.standard_normal(len(h)))
        return found


def order(p: float) -> Known:
    """Errors of order p."""
    return Known(f"h^{p:g}", lambda h: h**p, _nothing if p == 2 else _everything)


def leak(d: float) -> Known:
    """Second order with a first-order part of the same sign."""
    return Known(f"h^2 + {d:g} h", lambda h: h**2 + d * h, lambda h: float(d / (h[-1] + d)))


def floor(e: float) -> Known:
    """Second order with a floor."""
    name = f"h^2 + {e:.0e}".replace("e-0", "e-")
    return Known(name, lambda h: h**2 + e, lambda h: float(e / (h[-1] ** 2 + e)))


def square(fraction: float) -> Known:
    """Second order with a first-order part that has this fraction of the finest error, and a random sign.

    Sums of squares of such errors add, but for the mean of the signs of the particles, which is drawn. So 40 % raise
    the finest error by 8 %: that, not the fraction, is what is of another order in it.
    """
    second = sqrt(1 - fraction**2)

    def parts(h: Array) -> tuple[Array, Array]:
        return second * h**2, fraction * h * h[-1]

    def error(h: Array) -> Array:
        found: Array = np.hypot(*parts(h))
        return found

    def cross(h: Array) -> Array:
        a, b = parts(h)
        found: Array = 2 * a * b / (a**2 + b**2)
        return found

    return Known(f"{fraction:.0%} of h in the square", error, lambda h: 1 - second, cross)


def drift(start: float, end: float) -> Known:
    """Local orders that fall evenly from the first pair to the last."""

    def error(h: Array) -> Array:
        orders = np.linspace(start, end, len(h) - 1)
        found: Array = h[0] ** 2 * np.exp(np.concatenate([[0.0], np.cumsum(orders * np.diff(np.log(h)))]))
        return found

    return Known(f"order {start:.1f} to {end:.1f}", error, _everything)


KNOWN = (
    order(2),
    Known("h^2 (1 + 2 h)", lambda h: h**2 * (1 + 2 * h)),
    Known("h^2 (1 - 2 h)", lambda h: h**2 * (1 - 2 * h)),
    Known("h^2 (1 + 6 h)", lambda h: h**2 * (1 + 6 * h)),
    Known("h^2 + 40 h^4", lambda h: h**2 + 40 * h**4),
    Known("h^2 / (1 + 16 h)", lambda h: h**2 / (1 + 16 * h)),
    floor(1e-6),
    floor(1e-5),
    leak(0.005),
    leak(0.02),
    *(square(fraction) for fraction in (0.2, 0.3, 0.4, 0.5)),
    drift(2.0, 1.5),
    order(1.7),
    order(1.5),
    order(1),
)
