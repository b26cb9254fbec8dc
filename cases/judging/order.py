"""Order rule, registered before the run: whether the observed order of errors is as expected.

A least-squares slope within half an order of the formal one passes codes with a first-order leak, with a floor, and
with rates that drift, so no single slope decides here. In turn: evidence against the expectation (evidence.py), gates
(is there anything to judge), and for each window of levels equivalence of the slope with a band, contamination and
magnitude. FAIL needs evidence; lack of it is INCONCLUSIVE and names the run that would decide. An expected order of
None registers non-convergence, which growth or failed runs show. Reasons are codes with numbers, see records.py. The
statistics stand in fit.py, the norms in norms.py.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from mpm_verify.cases.judging.contamination import contamination
from mpm_verify.cases.judging.evidence import CLEAR, MOST, carried, evidence, parts, tail
from mpm_verify.cases.judging.fit import LEVELS, Fit
from mpm_verify.cases.judging.quantity import Quantity
from mpm_verify.cases.judging.records import (
    Action,
    Contamination,
    Expectation,
    Level,
    Numbers,
    Outcome,
    Reason,
    ReasonCode,
    Verdict,
)
from mpm_verify.cases.judging.refuted import Refutation
from mpm_verify.solver.failure import FailureKind

__all__ = ["Expectation", "Level", "Outcome", "Quantity", "Verdict", "judge", "judge_family"]

COUPLED = 0.10  # relative change of the finest error when dt is halved
NO_PASS, DEFECT = 0.10, 0.50  # fractions of the finest error that are not of the expected order
SURE, SHORT = 0.962, 0.98  # one-sided; on the shortest window more, as it is looked at beside longer ones
MAGNITUDE = 0.10  # relative distance from a recorded error that was carried over to other cells
GROWTH = 2.0  # a flat sequence with 15 % scatter grows by 1.5 from its best level in 9 % of draws, by 2 in 0.2 %
DROP = 0.3  # in the local order, of a stall: a fall that no scatter of a converging family shows
CONVERGES = 0.5  # a smaller order is nearly a stall: no surprise where non-convergence is expected


PASS, FAIL, INCONCLUSIVE = Outcome.PASS, Outcome.FAIL, Outcome.INCONCLUSIVE
Finding = tuple[Outcome, Reason]


def judge(
    levels: Sequence[Level],
    expectation: Expectation,
    *,
    floor: float,
    dt_halved: float | None,
    confidence: float = 0.95,
    multiple: int = 1,
) -> Verdict:
    """Judge one quantity in one norm.

    Parameters
    ----------
    levels
        Errors at each cell size, in any order.
    expectation
        What was registered before the run.
    floor
        Round-off floor of the quantity.
    dt_halved
        Error of the finest unshifted run with half the time step; None if there is no such run.
    confidence
        Of the interval of the order.
    multiple
        Number whose multiples are the numbers of cells that can be asked for.

    Returns
    -------
    Verdict
        Outcome, reason, fitted order and its interval.

    Raises
    ------
    ValueError
        If two levels have the same cell size.
    """
    return _judge(Quantity(levels, expectation, floor, dt_halved, multiple), confidence)


def judge_family(items: Sequence[Quantity], *, confidence: float = 0.95) -> tuple[Verdict, ...]:
    """Judge several quantities as a family: the chance of a wrong PASS anywhere is at most 1 - confidence.

    The surest quantity needs alpha / m, the next alpha / (m - 1), and so on while they pass. Expected non-convergence
    claims no equivalence: it is judged at `confidence` and does not count in m.

    Parameters
    ----------
    items
        Quantities, each with its levels and expectation.
    confidence
        Of the family.

    Returns
    -------
    tuple of Verdict
        In the order of `items`.

    References
    ----------
    Holm (1979), Scand. J. Statist. 6, 65
    """
    verdicts = {i: _judge(q, confidence) for i, q in enumerate(items) if q.expectation.order is None}
    doubt = {i: _doubt(q) for i, q in enumerate(items) if i not in verdicts}
    left = len(doubt)
    for i in sorted(doubt, key=doubt.__getitem__):
        verdicts[i] = _judge(items[i], 1 - (1 - confidence) / left)
        left -= verdicts[i].outcome is PASS
    return tuple(verdicts[i] for i in range(len(items)))


@dataclass(frozen=True)
class Window:
    """Levels that are looked at, finest last, with the confidence of their interval.

    Windows of four levels or more that end at the finest are all looked at, and one that passes is enough: coarser
    levels take nothing away. For having looked at several, one of m levels has alpha / 2^(m - 3), whatever the others.
    """

    q: Quantity
    fit: Fit
    confidence: float

    @cached_property
    def mixed(self) -> Contamination:
        """Contamination of its finest error."""
        sure = SHORT if len(self.fit.h) == LEVELS else SURE
        order = self.q.expectation.order
        assert order is not None
        return contamination(self.fit.h, self.fit.error, order, self.fit.chance(sure))

    @cached_property
    def refutation(self) -> Refutation:
        """Refutation of what is sound, by its errors."""
        order = self.q.expectation.order
        assert order is not None
        return Refutation(self.fit, order, self.q.band[0])

    @cached_property
    def findings(self) -> list[Finding]:
        """Slope, contamination and magnitude."""
        return [_equivalence(self), _purity(self), _magnitude(self.q)]

    @property
    def passes(self) -> bool:
        """Whether its errors fall without much scatter, and all of its findings are as expected."""
        falls = bool(np.all(np.diff(self.fit.error) < 0))
        return falls and not self.fit.scatters and all(outcome is PASS for outcome, _ in self.findings)

    def first(self, outcome: Outcome) -> Finding | None:
        """First finding with this outcome."""
        return next((finding for finding in self.findings if finding[0] is outcome), None)


def _windows(q: Quantity, confidence: float) -> list[Window]:
    """Windows that can pass, the longest first."""
    counts = range(len(q.fit.h), LEVELS - 1, -1)
    return [Window(q, q.fit.finest(m), 1 - (1 - confidence) / 2 ** (m - LEVELS + 1)) for m in counts]


def _doubt(q: Quantity) -> float:
    """Smallest alpha at which a window's interval lies in the band: the smaller, the surer."""
    windows = _windows(q, 0.0)
    doubts = [w.fit.slope.doubt(*q.band) / (1 - w.confidence) for w in windows if w.fit.slope]
    return min(doubts, default=1.0)


def _judge(q: Quantity, confidence: float) -> Verdict:
    order, fit = q.expectation.order, q.fit
    kind, ended = q.expectation.failed, tuple(end for level in q.ordered if (end := level.ended))
    told = Window(q, fit.settled or fit, confidence)
    if kind and q.ordered and all(level.failed_by(kind) for level in q.ordered):
        outcome, reason = PASS, Reason(ReasonCode.ALL_FAILED, failed=ended)
    elif against := evidence(q):
        outcome, reason = FAIL, against
    elif not len(fit.h):
        outcome, reason = Outcome.ERROR, Reason(ReasonCode.NOTHING_FINISHED, failed=ended)
    elif order is None:
        outcome, reason = _non_convergence(q, confidence)
    else:
        if gate := _gate(q):
            outcome, reason = INCONCLUSIVE, gate
        else:
            outcome, reason, told = _convergence(q, told, confidence)
        if outcome is INCONCLUSIVE and (low := tail(q)):
            change = {"change": reason.numbers["change"]} if reason.code is ReasonCode.TIME_STEP_COUPLED else {}
            outcome, reason = FAIL, replace(low, numbers=low.numbers | change)
    return _verdict(q, told, outcome, reason)


def _verdict(q: Quantity, told: Window, outcome: Outcome, reason: Reason) -> Verdict:
    """Verdict with the order, interval and contamination of the window that is told."""
    slope, last = told.fit.slope, len(q.fit.h) - 1
    settled = outcome is PASS or q.fit.settled is not None
    return Verdict(
        outcome,
        q.expectation.order,
        slope.value if slope else None,
        slope.interval(told.confidence) if slope else None,
        reason,
        tuple(q.fit.orders.tolist()),
        (last + 1 - len(told.fit.h), last) if slope and settled else None,
        told.mixed if slope and q.expectation.order is not None else None,
    )


def _gate(q: Quantity) -> Reason | None:
    """Reason why nothing can be judged yet, with the run that would decide; None if every gate is open."""
    fit, ended = q.fit.finest(LEVELS), q.missing
    if len(q.levels) < LEVELS:
        return Reason(ReasonCode.TOO_FEW_LEVELS, {"levels": LEVELS}, wanted=q.enough)
    if ended:
        return Reason(ReasonCode.LEVEL_MISSING, failed=(ended,), wanted=q.wanted(Action.FINISH, ended.h))
    if (largest := float(q.fit.error.max())) <= q.floor or not fit.error.any():
        return Reason(ReasonCode.NEAR_ROUND_OFF, {"error": largest, "floor": q.floor, "zeros": float(len(fit.h))})
    if fit.lowest <= CLEAR * q.floor:
        coarser = q.wanted(Action.REPLACE_FINEST, 2 * float(q.fit.h[0]))
        return Reason(ReasonCode.NEAR_ROUND_OFF, {"error": fit.lowest, "floor": q.floor}, wanted=coarser)
    finest = float(fit.h[-1])
    if q.dt_halved is None or not np.isfinite(q.dt_halved):
        return Reason(ReasonCode.TIME_STEP_UNKNOWN, wanted=q.wanted(Action.HALVE_FINEST, finest))
    change = q.dt_halved / float(fit.replicates[-1][0]) - 1
    if abs(change) >= COUPLED:
        return Reason(ReasonCode.TIME_STEP_COUPLED, {"change": change}, wanted=q.wanted(Action.HALVE_ALL, finest))
    return None


def _rises(q: Quantity) -> Reason | None:
    """Reason that the error rises somewhere; None where it falls."""
    rises = q.fit.h[1:][np.diff(q.fit.error) >= 0]
    return Reason(ReasonCode.ERROR_RISES, {"h": float(rises[0])}, wanted=q.finer) if len(rises) else None


def _convergence(q: Quantity, settled: Window, confidence: float) -> tuple[Outcome, Reason, Window]:
    """PASS where a window has it; else the FAIL of the settled levels; else what the longest window leaves open."""
    windows = _windows(q, confidence)
    if passed := next((window for window in windows if window.passes), None):
        numbers: Numbers = {}
        for _, reason in passed.findings:
            numbers |= reason.numbers
        return PASS, Reason(ReasonCode.AS_EXPECTED, numbers), passed
    if rises := _rises(q):
        return INCONCLUSIVE, rises, settled
    if q.fit.settled and (failed := settled.first(FAIL)):
        return *failed, settled
    count = len(settled.fit.h)
    told = next((window for window in windows if q.fit.settled and len(window.fit.h) == count), None)
    left = told.first(INCONCLUSIVE) if told else None
    if not (told and left):
        numbers = {"orders": tuple(q.fit.orders.tolist())}
        mixed = windows[0].mixed
        if mixed.total > NO_PASS and not windows[0].fit.rises_to(q.band[0]):
            numbers |= parts(mixed, q.fit)
        return INCONCLUSIVE, Reason(ReasonCode.NOT_SETTLED, numbers, wanted=q.finer), settled
    return *left, told


def _equivalence(w: Window) -> Finding:
    """Equivalence test: the whole interval of the slope, and the last local order, against the band."""
    slope, last, (low, high) = w.fit.slope, float(w.fit.orders[-1]), w.q.band
    assert slope is not None  # a window has three levels
    start, end = slope.interval(w.confidence)
    numbers: Numbers = {"order": slope.value, "start": start, "end": end, "confidence": w.confidence, "last": last}
    numbers |= {"band_low": low, "band_high": high}
    if len(w.fit.h) < len(w.q.fit.h):
        numbers["from"] = float(w.fit.h[0])
    slack = w.fit.pair
    if low <= start and end <= high and low - slack <= last <= high + slack:
        return PASS, Reason(ReasonCode.AS_EXPECTED, numbers)
    if slope.value > high or last > high + slack or low <= start < high < end:
        return INCONCLUSIVE, Reason(ReasonCode.ORDER_ABOVE, numbers, wanted=w.q.beyond)
    if end < low and last < low and not w.fit.rises_to(low) and w.refutation.below(MOST):
        return FAIL, Reason(ReasonCode.ORDER_BELOW, numbers)
    return INCONCLUSIVE, Reason(ReasonCode.ORDER_UNDECIDED, numbers, wanted=w.q.finer)


def _purity(w: Window) -> Finding:
    """Lower order and floor in the finest error. Orders that rise to the band tell of coarse grids, not of a defect."""
    mixed = w.mixed
    other = parts(mixed, w.fit) | {"most": mixed.most, "squared": mixed.squared}
    if mixed.total > DEFECT and not w.fit.rises_to(w.q.band[0]) and w.refutation.contaminated(MOST):
        return FAIL, Reason(ReasonCode.CONTAMINATED, other)
    if mixed.shown:
        return INCONCLUSIVE, Reason(ReasonCode.ADDS_IN_SQUARE, {"shown": mixed.shown}, wanted=w.q.finer)
    if mixed.total > NO_PASS or mixed.most > MOST:
        return INCONCLUSIVE, Reason(ReasonCode.CONTAMINATION_OPEN, {"limit": NO_PASS, **other}, wanted=w.q.finer)
    return PASS, Reason(ReasonCode.AS_EXPECTED, {"most": mixed.most, "squared": mixed.squared})


def _magnitude(q: Quantity) -> Finding:
    """Recorded error: met where it was run, else carried to the finest cells, which proves nothing."""
    e, fit = q.expectation, q.fit
    if not e.recorded:
        return PASS, Reason(ReasonCode.AS_EXPECTED)
    if q.known:
        level, known = q.known[-1]
        return PASS, Reason(ReasonCode.AS_EXPECTED, {"h": level.h, "ratio": known.ratio(level.errors[0])})
    near, ratio = carried(q)
    numbers: Numbers = {"h": float(fit.h[-1]), "ratio": ratio}
    if abs(ratio - 1) <= MAGNITUDE:
        return PASS, Reason(ReasonCode.AS_EXPECTED, numbers)
    return INCONCLUSIVE, Reason(ReasonCode.MAGNITUDE_CARRIED, numbers, wanted=q.wanted(Action.ADD_LEVEL, near.h))


def _non_convergence(q: Quantity, confidence: float) -> Finding:
    """Expected non-convergence: met if the error grows clearly from its smallest value, or if finer runs were inverted.

    Where a stall is expected, an order that has fallen below it meets it, and failed runs do not.
    """
    e, h, error, orders = q.expectation, q.fit.h, q.fit.error, q.fit.orders
    slope = (q.fit.settled or q.fit).slope
    best = int(np.argmin(error))
    numbers: Numbers = {}
    if error[-1] >= GROWTH * error[best] > 0 and np.polyfit(np.log(h[best:]), np.log(error[best:]), 1)[0] < 0:
        numbers |= _path(q.fit, best)
    inverted = [level for level in q.ordered if level.h < h[0] and level.failed_by(FailureKind.INVERTED)]
    finer = tuple(end for level in inverted if (end := level.ended)) if e.stall is None else ()
    if e.stall is not None and len(h) >= LEVELS and orders[-1] < e.stall and orders.max() - orders[-1] > DROP:
        numbers |= {"order_best": float(orders.max()), "order_last": float(orders[-1]), "h_last": float(h[-1])}
    if numbers or finer:
        return PASS, Reason(ReasonCode.DIVERGES if e.stall is None else ReasonCode.STALLS, numbers, finer)
    least = CONVERGES if e.stall is None else e.stall
    fine = e.stall_h is None or h[-1] <= e.stall_h * (1 + 1e-9)
    if fine and len(h) >= LEVELS and slope and min(slope.interval(confidence)[0], *orders) > least:
        return FAIL, Reason(ReasonCode.CONVERGES, {**_path(q.fit), "order": slope.value})
    wanted = q.finer if fine else q.wanted(Action.ADD_LEVEL, e.stall_h or 0.0)
    stall: Numbers = {} if e.stall is None else {"stall": e.stall}
    return INCONCLUSIVE, Reason(ReasonCode.NEITHER, stall | _path(q.fit), wanted=wanted)


def _path(fit: Fit, start: int = 0) -> Numbers:
    """Errors of a level and of the finest, with their cell sizes."""
    ends = {"h_0": fit.h[start], "error_0": fit.error[start], "h_1": fit.h[-1], "error_1": fit.error[-1]}
    return {name: float(value) for name, value in ends.items()}
