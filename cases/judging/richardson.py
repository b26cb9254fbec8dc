"""Solution verification without an exact solution: Richardson extrapolation and the grid convergence index.

Three levels of spacing h1 < h2 < h3 with the values f1, f2, f3. The observed order p solves

    (f3 - f2)/(f2 - f1) = r21^p (r32^p - 1)/(r21^p - 1),    r21 = h2/h1, r32 = h3/h2

and the index is 1.25 |f1 - f2| / (r21^p - 1), an estimate of the uncertainty of f1. That holds where values approach a
limit from one side. Where they go to and fro, or apart, there is no order, and what is given as the uncertainty is half
the range of the three values, and so said.

References
----------
Roache (1994), J. Fluids Eng. 116, 405, doi:10.1115/1.2910291
Celik, Ghia, Roache, Freitas, Coleman & Raad (2008), J. Fluids Eng. 130, 078001, doi:10.1115/1.2960953
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite, log
from typing import Literal

from scipy.optimize import brentq

Kind = Literal["converges", "oscillates", "unsettled", "equal"]
SAFETY = 1.25  # of three levels whose order is observed
LARGEST = 10.0  # order that is looked for
FORMAL = 2.0  # order that is used: more is an accident, and would make the uncertainty too small
ITERATIONS = 1000  # for the order of Celik et al.
FLAT, STEEP = 1e-12, 600.0  # p ln r: below it r^p is 1, and above it no number
LEAST = 0.5  # with a lower order the limit lies beyond 2.4 times the last difference: nothing has settled


@dataclass(frozen=True)
class Extrapolation:
    """Richardson extrapolation of three levels.

    Parameters
    ----------
    kind
        `converges`, `oscillates`, `unsettled` (an order that is too low), or `equal` (the finest two are).
    finest
        Value on the finest level.
    order, limit
        Observed order and extrapolated limit; not a number unless the values converge (`equal`: the limit is finest).
    uncertainty
        That of `finest`: the grid convergence index, or half the range of the three values.
    """

    kind: Kind
    finest: float
    order: float
    limit: float
    uncertainty: float


def extrapolate(h: Sequence[float], f: Sequence[float], formal: float = FORMAL) -> Extrapolation:
    """Extrapolate the values of three levels.

    Parameters
    ----------
    h
        Three spacings, finest first.
    f
        Values there, finite.
    formal
        Order that is used where a larger one is observed.

    Returns
    -------
    Extrapolation
        Order, limit and uncertainty.

    Raises
    ------
    ValueError
        Unless there are three rising spacings and three finite values.
    """
    _check(h, f)
    fine, coarse = f[1] - f[0], f[2] - f[1]
    half_range = (max(f) - min(f)) / 2
    if fine == 0:
        return Extrapolation("equal", f[0], float("nan"), f[0], half_range)
    if fine * coarse <= 0:
        return Extrapolation("oscillates", f[0], float("nan"), float("nan"), half_range)
    p = order(h[1] / h[0], h[2] / h[1], coarse / fine)
    if not p >= LEAST:
        return Extrapolation("unsettled", f[0], float("nan"), float("nan"), half_range)
    grows = (h[1] / h[0]) ** min(p, formal) - 1
    return Extrapolation("converges", f[0], p, f[0] - fine / grows, SAFETY * abs(fine) / grows)


@dataclass(frozen=True)
class Index:
    """Grid convergence index as Celik et al. (2008) define it, of the finest of three levels.

    Parameters
    ----------
    order
        Apparent order p; not a number where the iteration for it does not converge.
    limit
        Extrapolated value.
    relative
        Approximate relative error |(f1 - f2)/f1|.
    extrapolated
        Extrapolated relative error |(limit - f1)/limit|.
    index
        1.25 times `relative` over r21^p - 1, as a fraction of f1.
    """

    order: float
    limit: float
    relative: float
    extrapolated: float
    index: float


def celik(h: Sequence[float], f: Sequence[float]) -> Index:
    """Grid convergence index of three levels, word for word as in the procedure that the journal asks for.

    It gives an order and an index for values that go to and fro, and for those that go apart, where `extrapolate` has
    none: the sign of the ratio is in q(p), and the order is an absolute value.

    Parameters
    ----------
    h
        Three spacings, finest first.
    f
        Values there, finite.

    Returns
    -------
    Index
        Order, limit and index; not a number where the finest values are equal or zero.

    Raises
    ------
    ValueError
        Unless there are three rising spacings and three finite values.

    References
    ----------
    Celik, Ghia, Roache, Freitas, Coleman & Raad (2008), J. Fluids Eng. 130, 078001, doi:10.1115/1.2960953
    """
    _check(h, f)
    fine, coarse = f[1] - f[0], f[2] - f[1]
    nan = float("nan")
    if fine == 0 or coarse == 0 or f[0] == 0:
        return Index(nan, nan, nan, nan, nan)
    r21, r32 = h[1] / h[0], h[2] / h[1]
    p = _apparent(r21, r32, coarse / fine)
    grows = r21**p - 1
    limit = f[0] - fine / grows if grows else nan
    relative = abs(fine / f[0])
    away = abs((limit - f[0]) / limit) if limit else nan
    return Index(p, limit, relative, away, SAFETY * relative / grows if grows else nan)


def _apparent(r21: float, r32: float, ratio: float) -> float:
    """Order p = |ln |ratio| + q(p)| / ln r21, q = ln((r21^p - s)/(r32^p - s)), s the sign of the ratio, iterated."""
    s, p = (1 if ratio > 0 else -1), abs(log(abs(ratio))) / log(r21)
    for _ in range(ITERATIONS):
        if not FLAT < p * log(max(r21, r32)) < STEEP:
            break
        last, p = p, abs(log(abs(ratio)) + log((r21**p - s) / (r32**p - s))) / log(r21)
        if abs(p - last) <= 1e-12 * last:
            return p
    return float("nan")


def _check(h: Sequence[float], f: Sequence[float]) -> None:
    if len(h) != 3 or len(f) != 3 or not 0 < h[0] < h[1] < h[2] < inf or not all(map(isfinite, f)):
        raise ValueError(f"three levels of rising spacing with finite values are needed, not {h} and {f}")


def order(r21: float, r32: float, ratio: float) -> float:
    """Order p of f(h) = f0 + C h^p from (f3 - f2)/(f2 - f1) > 0; NaN where none is above zero."""

    def miss(p: float) -> float:
        return log(ratio) - p * log(r21) - log((r32**p - 1) / (r21**p - 1))

    low, high = 1e-6, LARGEST
    if miss(low) <= 0:
        return float("nan")
    return LARGEST if miss(high) > 0 else float(brentq(miss, low, high))
