"""Contamination: what of the finest error is not of the expected order, where it adds and where its square adds.

A leak or a floor of one sign adds to the error. One that is as often positive as negative among the particles adds in
the square, since an error is a root mean square: 40 % of it raise the error by 8 % only. So e and e^2 are fitted.
"""

from collections.abc import Callable, Sequence

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
    fraction, most = _bounded(h, error, order, chance, 1)
    squares, squared = _bounded(h, error, order, chance, 2)
    shown = _shown(h, error, order, float(1 - squares[0]))
    lower, floor = float(fraction[1:-1].sum()), float(fraction[-1])
    return Contamination(lower, floor, most, float(np.sqrt(squared)), shown)


def _terms(h: Array, order: float, power: int) -> list[Array]:
    """Columns (n,) of the fit of the error to this power, each 1 on the finest level: expected, lower, floor."""
    expected, floor = (h / h[-1]) ** (power * order), np.ones_like(h)
    return [expected, (h / h[-1]) ** (power * (order - 1)), floor] if order > 1 else [expected, floor]


def _bounded(h: Array, error: Array, order: float, chance: float, power: int) -> tuple[Array, float]:
    """Fractions of the terms in the finest error to this power, and the largest total that is not of `order`."""
    terms, error = _terms(h, order, power), error**power
    part, residual = _relative(terms, error)
    fraction = part / part.sum()
    most = np.hypot(residual, power * chance)

    def refuted(total: float) -> bool:
        mixed = [(1 - total) * terms[0] + total * other for other in terms[1:]]
        return bool(_relative(mixed, error)[1] > most)

    return fraction, _bound(refuted, float(1 - fraction[0]))


def _shown(h: Array, error: Array, order: float, squares: float) -> float:
    """Fraction that adds in the square where the data refute that there are only SHOWN of it; 0 where they do not.

    What fits better as a sum is none: a leak of one sign has a square too.
    """
    plain = _relative(_terms(h, order, 1), error)[1]
    terms, error = _terms(h, order, 2), error**2
    part, residual = _relative(terms, error)
    dof = len(h) - int(np.count_nonzero(part))
    if squares <= SHOWN**2 or dof == 0 or residual / 2 >= plain:
        return 0.0
    most = np.hypot(residual, limit(residual / np.sqrt(dof), dof, SURE, 0.0))
    allowed = [terms[0], *((1 - SHOWN**2) * terms[0] + SHOWN**2 * term for term in terms[1:])]
    return float(np.sqrt(squares)) if _relative(allowed, error)[1] > most + EXACT else 0.0


def _relative(terms: Sequence[Array], error: Array) -> tuple[Array, float]:
    """Non-negative parts of the terms that fit the error best in relative terms, and the norm of what is left."""
    from scipy.optimize import nnls

    part, left = nnls(np.column_stack(terms) * (error[-1] / error)[:, None], np.ones_like(error))
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
