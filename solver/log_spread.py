"""Square of d = ln(l1/l2), the difference of the principal logarithms in the plane, analytic at the undeformed state.

d = arcosh(tr C / 2J) has the slope of a square root there, d^2 has none; but arcosh^2 as it stands loses its digits
near 1 and is 0/0 in its slope. So it is taken of y = cosh d - 1, a sum of squares over 2J, and d is halved until the
series of its square ends at round-off:

    cosh(d/2) - 1 = y / (2 + 2 sqrt(1 + y/2)),   d^2 = sum over n >= 1 of (-1)^(n+1) 2 (2y)^n / (n^2 C(2n, n))

Without a branch, so that it is differentiated, printed and compiled as any other expression.
"""

from math import comb
from typing import Any

HALVINGS, TERMS = 4, 12  # for d^2 and two derivatives to 1e-16 up to d = 5.5, principal stretches of 240 to 1


def written(y: Any, derivative: int, root: Any = lambda z: z**0.5, ratio: Any = lambda p, q: p / q) -> Any:
    """Derivative of d^2 by y, 0, 1 or 2, of numbers or symbols with their square root and fractions."""
    turns, slope, bend = 1, 1, 0  # products of cosh(d/2^j), d y_k / d y, and the sum that differentiates the products
    for _ in range(HALVINGS):
        y = y / (2 + 2 * root(1 + y / 2))
        slope = slope / (4 * (1 + y))
        turns = turns * (1 + y)
        bend = bend + slope / (1 + y)
    if derivative == 0:
        return 4**HALVINGS * y * series(y, 0, ratio)
    if derivative == 1:
        return series(y, 1, ratio) / turns
    return (series(y, 2, ratio) * slope - series(y, 1, ratio) * bend) / turns


def series(y: Any, derivative: int, ratio: Any) -> Any:
    """Series of d^2 / y, of the derivative of d^2 or of its second one, by Horner's rule."""
    total = 0
    for n in range(TERMS, max(derivative, 1) - 1, -1):
        factor = (1, n, n * (n - 1))[derivative]
        total = total * y + ratio((-1) ** (n + 1) * 2 ** (n + 1) * factor, n**2 * comb(2 * n, n))
    return total
