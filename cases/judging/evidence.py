"""Evidence against an expectation: what is wrong whatever gates are shut, see order.py."""

from math import log

from mpm_verify.cases.judging.contamination import Nearest
from mpm_verify.cases.judging.fit import LEVELS, Fit
from mpm_verify.cases.judging.quantity import Quantity
from mpm_verify.cases.judging.records import Contamination, Numbers, Reason, ReasonCode, Recorded
from mpm_verify.cases.judging.refuted import Refutation
from mpm_verify.solver.failure import FailureKind

FAR = 2.0  # times the recorded error, carried over to the finest cells
WELL_BELOW = 1.5  # the band over the local orders of the two finest pairs
CLEAR = 100.0  # times the round-off floor, else an error that does not fall is that floor
MOST = 0.15  # of the finest error, refuted: a leak of 14 % passes in 5 % of quick studies with 3 % scatter
ASTRAY = (FailureKind.INVERTED, FailureKind.DOMAIN_INVERTED, FailureKind.OUTSIDE_GRID)


def evidence(q: Quantity) -> Reason | None:
    """First reason to say FAIL; None where there is none.

    Recorded errors are those of the runs with the particles at their usual positions.
    """
    if q.still:
        return Reason(ReasonCode.NOTHING_MOVES)
    return _magnitude(q) or (None if q.expectation.order is None else _ended(q))


def carried(q: Quantity) -> tuple[Recorded, float]:
    """Recorded error of the cells nearest to the finest, and the finest error over it, carried there by the order."""
    h, error = float(q.fit.h[-1]), float(q.fit.error[-1])
    near = min(q.expectation.recorded, key=lambda one: abs(log(one.h / h)))
    return near, near.ratio(error * (near.h / h) ** (q.expectation.order or 0.0))


def _magnitude(q: Quantity) -> Reason | None:
    """Error that is not the recorded one: the worst of those that count, or far off where none was run."""
    e, levels = q.expectation, q.known[-1:] if q.expectation.finest else q.known
    ratios = {level.h: known.ratio(level.errors[0]) for level, known in levels}
    wrong = {h: ratio for h, ratio in ratios.items() if abs(ratio - 1) > e.within}
    if wrong:
        h = max(wrong, key=lambda h: abs(log(wrong[h])) if wrong[h] > 0 else 0.0)
        return Reason(ReasonCode.MAGNITUDE, {"h": h, "ratio": wrong[h], "within": e.within})
    if ratios or not e.recorded or e.order is None or not len(q.fit.h):
        return None
    near, ratio = carried(q)
    numbers = {"h": float(q.fit.h[-1]), "ratio": ratio, "recorded_h": near.h}
    return Reason(ReasonCode.FAR_OFF, {**numbers}) if ratio > FAR else None


def _ended(q: Quantity) -> Reason | None:
    """Runs whose particles were inverted or left the grid."""
    ended = tuple(end for level in q.ordered if (end := level.ended) and any(map(level.failed_by, ASTRAY)))
    return Reason(ReasonCode.RUN_ENDED, failed=ended) if ended else None


def tail(q: Quantity) -> Reason | None:
    """Local orders that end below the band and do not rise to it: no gate of the time step excuses them."""
    fit = q.fit
    if (
        q.expectation.order is None
        or len(fit.orders) < LEVELS - 1
        or fit.lowest <= CLEAR * q.floor
        or (fit.settled or fit).rises_to(q.band[0])
    ):
        return None
    return _short(q, q.expectation.order) or _mixed(q, q.expectation.order)


def _short(q: Quantity, order: float) -> Reason | None:
    """Local orders of the two finest pairs well below the band; with the floor, where a leak falls faster than that."""
    fit, low = q.fit, q.band[0]
    first, last = (float(order) for order in fit.orders[-2:])
    if max(first, last) > low / WELL_BELOW:
        return None
    numbers = {"first": first, "last": last, "band_low": low}
    if max(fit.orders[:-2]) >= low and last < order - 1:
        numbers["flat"] = Refutation(fit, order, low).told.floor * float(fit.error[-1])
    return Reason(ReasonCode.FALLS_SHORT, {**numbers})


def _mixed(q: Quantity, order: float) -> Reason | None:
    """Last local order below the band, as more than MOST of the finest error is of another order."""
    fit, refutation = q.fit, Refutation(q.fit, order, q.band[0])
    if fit.orders[-1] >= q.band[0] or fit.rises_to(q.band[0]) or not refutation.contaminated(MOST):
        return None
    told, least = refutation.told, refutation.least(MOST)
    return Reason(ReasonCode.CONTAMINATED, parts(told, fit) | {"power": told.power, "least": least})


def parts(mixed: Contamination | Nearest, fit: Fit) -> Numbers:
    """Fractions of the finest error that are not of the expected order, in the best fit, and that error."""
    return {"lower": mixed.lower, "floor": mixed.floor, "error": float(fit.error[-1])}
