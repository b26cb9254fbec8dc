"""Contamination: what of the finest error is not of the expected order, where it adds and where its square adds.

A leak or a floor of one sign adds to the error. One that is as often positive as negative among the particles adds in
the square, since an error is a root mean square: 40 % of it raise the error by 8 % only. So e and e^2 are fitted.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mpm_verify.cases.judging.fit import Array
from mpm_verify.cases.judging.records import Contamination
from mpm_verify.cases.judging.scatter import EXACT, limit

RESOLUTION = 1e-3  # of a fraction
SURE = 0.98  # of a fraction that is shown; an exact fit is sure of anything
SHOWN = 0.10  # least fraction that adds in the square and is told


def contamination(h: Array, error: Array, order: float, chance: float) -> Contamination:
    """Fit e = C h^p + D h^(p-1) + E0 and e^2 = C^2 h^2p + D^2 h^(2p-2) + E0^2, no term negative, weights 1/e.

    Parameters
    ----------
    h, error
        Cell sizes and errors (n,), positive, coarse to fine.
    order
        The expected order p. For p <= 1 the lower-order term would not fall with h: it is the floor and has no column
        of its own.
    chance
        Largest relative deviation of an error by chance, at the confidence that the bounds are to have.

    Returns
    -------
    Contamination
        Fractions of the finest error: lower-order term, floor, and the largest totals that are not refuted.

    References
    ----------
    Lawson & Hanson (1995), Solving Least Squares Problems, doi:10.1137/1.9781611971217 (non-negative least squares)
    """
    error = error / error[-1]  # squares of small and of large errors are numbers too
    plain, square = (_Mixed(terms(h, order, power), error**power) for power in (1, 2))
    lower, floor = float(plain.fraction[1:-1].sum()), float(plain.fraction[-1])
    squared = float(np.sqrt(square.bound(2 * chance)))
    return Contamination(lower, floor, plain.bound(chance), squared, _shown(plain, square))


@dataclass(frozen=True)
class Nearest:
    """Nearest sum of order, lower order and floor, or sum of their squares.

    Parameters
    ----------
    power
        1 where they add, 2 where their squares add.
    lower, floor
        Lower order and floor over the finest error.
    left
        Norm of the relative deviations from it.
    dof
        Degrees of freedom that are left.
    """

    power: int
    lower: float
    floor: float
    left: float
    dof: int


def nearest(h: Array, error: Array, order: float, power: int) -> Nearest:
    """Fit errors (n,) to this power by the sum of the terms to this power, no term negative."""
    made = _Mixed(terms(h, order, power), (error / error[-1]) ** power)
    lower, floor = (float(part) ** (1 / power) for part in (made.fraction[1:-1].sum(), made.fraction[-1]))
    return Nearest(power, lower, floor, made.residual / power, made.dof)


def terms(h: Array, order: float, power: int) -> list[Array]:
    """Columns (n,) of the fit of the error to this power, each 1 on the finest level: expected, lower, floor."""
    expected, floor = (h / h[-1]) ** (power * order), np.ones_like(h)
    return [expected, (h / h[-1]) ** (power * (order - 1)), floor] if order > 1 else [expected, floor]


class _Mixed:
    """Fit of an error (n,), or of its square, by the terms: fractions of the finest, and the norm of what is left."""

    def __init__(self, columns: Sequence[Array], error: Array) -> None:
        self.terms, self.error = columns, error
        part, self.residual = relative(columns, error)
        self.fraction = part / part.sum()
        self.dof = len(error) - int(np.count_nonzero(part))

    @property
    def other(self) -> float:
        """Fraction that is not of the expected order."""
        return float(1 - self.fraction[0])

    def left(self, total: float) -> float:
        """Norm of what is left where `total` of the finest is of the other terms."""
        mixed = [(1 - total) * self.terms[0] + total * other for other in self.terms[1:]]
        return relative(mixed, self.error)[1]

    def bound(self, chance: float) -> float:
        """Largest fraction that is not refuted, with deviations of `chance`."""
        most = np.hypot(self.residual, chance)
        return _bound(lambda total: bool(self.left(total) > most), self.other)


def _shown(plain: _Mixed, square: _Mixed) -> float:
    """Fraction that adds in the square where the data refute that there are only SHOWN of it; 0 where they do not.

    What fits better as a sum is none: a leak of one sign has a square too.
    """
    if plain.residual <= EXACT or square.residual / 2 >= plain.residual:
        return 0.0
    if square.other <= SHOWN**2 or square.dof == 0:
        return 0.0
    most = np.hypot(square.residual, limit(square.residual / np.sqrt(square.dof), square.dof, SURE, 0.0))
    return float(np.sqrt(square.other)) if square.left(SHOWN**2) > most + EXACT else 0.0


def relative(columns: Sequence[Array], error: Array) -> tuple[Array, float]:
    """Non-negative parts of the columns that fit the error best in relative terms, and the norm of what is left."""
    from scipy.optimize import nnls

    part, left = nnls(np.column_stack(columns) * (error[-1] / error)[:, None], np.ones_like(error))
    return part, float(left)


def _bound(refuted: Callable[[float], bool], low: float) -> float:
    """Smallest refuted fraction above `low`, by halving; 1 if even a pure contaminant is not refuted."""
    high = 1.0
    if not refuted(high):
        return high
    while high - low > RESOLUTION:
        middle = (low + high) / 2
        low, high = (low, middle) if refuted(middle) else (middle, high)
    return high
