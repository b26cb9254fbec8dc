"""Statistics of one refinement study: local orders, windows, slope with interval; see scatter.py, contamination.py.

Levels run coarse to fine. `h` (n,) is the cell size, `error` (n,) the error norm, both positive; orders and fractions
have no unit and do not depend on the units of either. What the numbers mean for a verdict stands in order.py.
SciPy is imported where it is called: the records of order.py are read by commands that fit nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import log

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.judging.scatter import EXACT, USUAL, about, limit, pooled

Array = NDArray[np.float64]

STEADY = 0.15  # largest change of the local order from one level to the next in an asymptotic window
SHRINK = 0.6  # or each change at most this times the one before it
AHEAD = 2  # times the levels of the window; at 1, h^2 / (1 + 128 h) with 3 % scatter fails in 22 %, not in 3 %
RESAMPLES, SEED = 2000, 20240229  # the seed is fixed: the same errors give the same verdict
LEVELS = 4  # fewer cannot show that the order has settled
ONE_SIGMA = 0.84  # confidence of one standard error, one-sided
ROUGH = 2 * USUAL  # of a study that scatters as usual, residuals of three degrees of freedom reach this in 0.7 %
BENT = 0.02  # scatter about a parabola that leaves a window to be judged, whatever it is about a line


def local_orders(h: Array, error: Array) -> Array:
    """Local orders between consecutive levels.

    Parameters
    ----------
    h, error
        Cell sizes and errors (n,), positive, coarse to fine.

    Returns
    -------
    ndarray
        log(e1/e2) / log(h1/h2) of each pair, (n-1,).
    """
    orders: Array = np.diff(np.log(error)) / np.diff(np.log(h))
    return orders


def local(pairs: Sequence[tuple[float, float]]) -> list[float | None]:
    """Local orders (n-1,) of (size, error) pairs, coarse to fine; None where an error is zero."""
    return list(slopes([h for h, _ in pairs], [e for _, e in pairs]))


def slopes(sizes: Sequence[float], errors: Sequence[float]) -> tuple[float | None, ...]:
    """Slopes log(e1/e2) / log(h1/h2) of consecutive levels (n-1,); None where an error is zero."""
    steps = zip(sizes[:-1], sizes[1:], errors[:-1], errors[1:], strict=True)
    return tuple(log(a / b) / log(s / t) if a > 0 and b > 0 else None for s, t, a, b in steps)


def asymptotic_window(orders: Array) -> tuple[int, int] | None:
    """Find the asymptotic window, the longest run of levels that ends at the finest and is steady or settling.

    Parameters
    ----------
    orders
        Local orders (n-1,), coarse to fine.

    Returns
    -------
    (int, int) or None
        First and last level, at least two apart: local orders change by STEADY at most, or each change is at most
        SHRINK times the one before it. None where there is no such run.
    """
    for first in range(len(orders) - 1):
        change = np.abs(np.diff(orders[first:]))
        settles = len(change) > 1 and bool(np.all(change[1:] <= SHRINK * change[:-1]))
        if change.max() <= STEADY or settles:
            return first, len(orders)
    return None


@dataclass(frozen=True, slots=True)
class Slope:
    """Fitted order.

    Parameters
    ----------
    value
        The order.
    error
        Its standard error.
    dof
        Degrees of freedom behind that error.
    """

    value: float
    error: float
    dof: float

    def interval(self, confidence: float) -> tuple[float, float]:
        """Two-sided Student interval at this confidence, such as 0.95."""
        from scipy.special import stdtrit  # the quantile of Student's t

        half = float(stdtrit(self.dof, (1 + confidence) / 2)) * self.error
        return self.value - half, self.value + half

    def doubt(self, low: float, high: float) -> float:
        """Smallest alpha whose 1 - alpha interval lies in [low, high]: twice the p value of the equivalence test.

        References
        ----------
        Schuirmann (1987), J. Pharmacokinet. Biopharm. 15, 657, doi:10.1007/BF01068419
        """
        from scipy.special import stdtr

        margin = min(self.value - low, high - self.value)
        return min(1.0, 2 * float(stdtr(self.dof, -margin / max(self.error, EXACT))))


def fit_slope(h: Array, errors: Sequence[Array]) -> Slope:
    """Fit the order: least squares of the mean log error on log h.

    Parameters
    ----------
    h
        Cell sizes (n,), positive, coarse to fine, three levels or more.
    errors
        One array of replicates a level, positive.

    Returns
    -------
    Slope
        Its standard error comes from a bootstrap over replicates (Efron) with Satterthwaite's degrees of freedom if
        every level has some, else from the residuals and the usual scatter (scatter.py).

    References
    ----------
    Efron (1979), Ann. Statist. 7, 1, doi:10.1214/aos/1176344552
    Satterthwaite (1946), Biometrics Bulletin 2, 110, doi:10.2307/3002019
    """
    x = np.log(h) - np.log(h).mean()
    weight = x / (x @ x)
    y = np.array([np.log(e).mean() for e in errors])
    value = float(weight @ y)
    if min(len(e) for e in errors) > 1:
        spread = np.array([len(e) - 1 for e in errors])  # outer levels weigh most: fewer degrees than sum(spread)
        dof = float((weight @ weight) ** 2 / (weight**4 / spread).sum())  # Satterthwaite (1946)
        return Slope(value, _bootstrap(weight, [np.log(e) for e in errors]), dof)
    scatter, dof = pooled(about(x, y, 1), len(h) - 2)
    return Slope(value, scatter / float(np.sqrt(x @ x)), dof)


def _bootstrap(weight: Array, logs: Sequence[Array]) -> float:
    """Standard deviation of the slope when each level draws its replicates again, with replacement."""
    rng = np.random.default_rng(SEED)
    slopes = np.zeros(RESAMPLES)
    for w, y in zip(weight, logs, strict=True):
        r = len(y)
        means = rng.choice(y, (RESAMPLES, r)).mean(axis=1)
        slopes += w * np.sqrt(r / (r - 1)) * means  # a bootstrap mean spreads by (r-1)/r too little: half at r = 2
    return float(slopes.std())


@dataclass(frozen=True)
class Fit:
    """Fit of one refinement. A single exact zero has no logarithm: then there are no orders, no window and no slope.

    Parameters
    ----------
    h
        Cell sizes (n,), positive, coarse to fine.
    replicates
        Errors of each level, one or more.
    """

    h: Array
    replicates: Sequence[Array]

    @cached_property
    def lowest(self) -> float:
        """Smallest error of all."""
        return min((float(e.min()) for e in self.replicates), default=0.0)

    @cached_property
    def error(self) -> Array:
        """Geometric mean over replicates (n,): the slope is fitted to logarithms."""
        return np.array([np.exp(np.log(e).mean()) if self.lowest > 0 else e.mean() for e in self.replicates])

    @cached_property
    def orders(self) -> Array:
        """Local orders (n-1,)."""
        return local_orders(self.h, self.error) if self.lowest > 0 else np.empty(0)

    @cached_property
    def settled(self) -> "Fit | None":
        """Levels of the asymptotic window, None where there is none."""
        window = asymptotic_window(self.orders)
        return self.finest(window[1] - window[0] + 1) if window else None

    def finest(self, count: int) -> "Fit":
        """Fit of the finest `count` levels."""
        return Fit(self.h[-count:], self.replicates[-count:])

    @cached_property
    def slope(self) -> Slope | None:
        """Order fitted to all levels, if they are three or more."""
        return fit_slope(self.h, self.replicates) if len(self.orders) > 1 else None

    @cached_property
    def noise(self) -> float | None:
        """Relative standard error of a mean over replicates, pooled over the levels; None where there are none."""
        if len(self.orders) == 0 or min(len(e) for e in self.replicates) == 1:
            return None
        return float(np.sqrt(np.mean([np.log(e).var(ddof=1) / len(e) for e in self.replicates])))

    @cached_property
    def scatters(self) -> bool:
        """Whether the errors lie neither about a power of h nor about a smooth curve: one can only ask for more."""
        x, y = np.log(self.h), np.log(self.error)
        bent = about(x, y, 2) if len(x) > LEVELS else np.inf
        return self.noise is None and self.rough > ROUGH and bent > BENT

    @cached_property
    def pair(self) -> float:
        """One standard deviation of the last local order, as far as scatter goes."""
        return self.chance(ONE_SIGMA) * float(np.sqrt(2) / np.log(self.h[-2] / self.h[-1]))

    def chance(self, confidence: float) -> float:
        """Largest relative deviation of an error by chance, one-sided."""
        return limit(self.rough, len(self.h) - 2, confidence, self.noise)

    @cached_property
    def rough(self) -> float:
        """Standard deviation of the logarithms of the errors about their line."""
        return about(np.log(self.h), np.log(self.error), 1)

    def rises_to(self, low: float) -> bool:
        """Whether the local orders rise, and reach `low` before too many levels at that trend: not a defect yet."""
        orders = self.orders
        trend = np.polyfit(np.arange(len(orders)), orders, 1)[0]
        return bool(trend > 0 and orders[-1] + AHEAD * (len(orders) + 1) * trend >= low)
