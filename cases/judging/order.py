"""Is the observed order as expected? The rule, registered before the run, that turns errors into a verdict.

A least-squares slope within half an order of the formal one passes codes with a first-order leak, with a floor, and
with rates that drift, so no single slope decides here. In turn: gates (is there anything to judge), asymptotic window,
equivalence of the slope with a band, contamination, magnitude. FAIL needs evidence against the expectation; lack of
evidence is INCONCLUSIVE and names the run that would decide. An expected order of None registers non-convergence,
which growth or failed runs show. The statistics stand in fit.py, the norms in norms.py.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mpm_verify.cases.judging.fit import Fit, contamination
from mpm_verify.cases.judging.records import Contamination, Expectation, Level, Outcome, Verdict

__all__ = ["Expectation", "Level", "Outcome", "Quantity", "Verdict", "judge", "judge_family"]

LEVELS = 4  # fewer cannot show that the order has settled
CLEAR = 100.0  # times the round-off floor
COUPLED = 0.10  # relative change of the finest error when dt is halved
NO_PASS, DEFECT = 0.10, 0.50  # shares of the finest error that are not of the expected order
ONE_SIGMA = 0.84  # NO_PASS must hold with a standard error to spare: the best fit alone passes 8 % of 14 % floors
MAGNITUDE = 0.10  # relative distance from the recorded error
GROWTH = 2.0  # a flat sequence with 15 % scatter grows by 1.5 from its best level in 9 % of draws, by 2 in 0.2 %
DROP = 0.3  # in the local order, of a stall: a fall that no scatter of a converging family shows
CONVERGES = 0.5  # a smaller order is nearly a stall: no surprise where non-convergence is expected


PASS, FAIL, INCONCLUSIVE = Outcome.PASS, Outcome.FAIL, Outcome.INCONCLUSIVE
Finding = tuple[Outcome, str]


@dataclass(frozen=True)
class Quantity:
    """What is judged: the arguments of `judge`. Raises ValueError if two levels share a cell size."""

    levels: Sequence[Level]
    expectation: Expectation
    floor: float
    dt_halved: float | None

    def __post_init__(self) -> None:
        if len({level.h for level in self.levels}) < len(self.levels):
            raise ValueError("two levels share a cell size: replicates belong in one level")

    @cached_property
    def ordered(self) -> list[Level]:
        """All levels, coarse to fine."""
        return sorted(self.levels, key=lambda level: -level.h)

    @cached_property
    def fit(self) -> Fit:
        """What the levels that finished say."""
        done = [level for level in self.ordered if not level.ended]
        return Fit(np.array([level.h for level in done]), [np.array(level.errors) for level in done])

    @property
    def finer(self) -> str:
        """The run to ask for when one more level would decide."""
        h = [level.h for level in self.ordered]
        return f"run h={_inverse(h[-1] ** 2 / h[-2] if len(h) > 1 else h[-1] / 2)}"

    @property
    def band(self) -> tuple[float, float]:
        """Where the order must lie; anywhere if none is expected."""
        e = self.expectation
        return (-np.inf, np.inf) if e.order is None else (e.order - e.below, e.order + e.above)


def judge(
    levels: Sequence[Level],
    expectation: Expectation,
    *,
    floor: float,
    dt_halved: float | None,
    confidence: float = 0.95,
) -> Verdict:
    """Verdict on one quantity in one norm; `levels` may come in any order.

    `floor` is the round-off floor of the quantity. `dt_halved` is the error of the finest unshifted run with half the
    time step, None if nobody ran that. Raises ValueError if two levels share a cell size.
    """
    return _judge(Quantity(levels, expectation, floor, dt_halved), confidence)


def judge_family(items: Sequence[Quantity], *, confidence: float = 0.95) -> tuple[Verdict, ...]:
    """Verdicts in the order of `items`, with the intervals of Holm (1979): a wrong PASS anywhere in 1 - confidence.

    The surest quantity needs alpha / m, the next alpha / (m - 1), and so on while they pass. Expected non-convergence
    claims no equivalence: it is judged at `confidence` and does not count in m.
    """
    verdicts = {i: _judge(q, confidence) for i, q in enumerate(items) if q.expectation.order is None}
    tested = {i: q.fit.slope for i, q in enumerate(items) if i not in verdicts}
    doubt = {i: slope.doubt(*items[i].band) if slope else 1.0 for i, slope in tested.items()}
    left = len(tested)
    for i in sorted(tested, key=doubt.__getitem__):
        verdicts[i] = _judge(items[i], 1 - (1 - confidence) / left)
        left -= verdicts[i].outcome is PASS
    return tuple(verdicts[i] for i in range(len(items)))


def _judge(q: Quantity, confidence: float) -> Verdict:
    order, fit, slope, shares = q.expectation.order, q.fit, q.fit.slope, None
    if order is not None and slope:
        shares = contamination(fit.h[fit.judged], fit.error[fit.judged], order, ONE_SIGMA, fit.noise)
    if q.expectation.lost and q.ordered and all(q.expectation.lost in level.failed for level in q.ordered):
        last = f"the last at h={_inverse(q.ordered[-1].h)} with {q.ordered[-1].failed}"
        outcome, reason = PASS, f"does not converge, as expected: all {len(q.ordered)} runs ended, {last}"
    elif not len(fit.h):
        ends = "; ".join(f"h={_inverse(level.h)}: {level.ended}" for level in q.ordered)
        outcome, reason = Outcome.ERROR, f"no level finished ({ends or 'there is none'})"
    elif order is None:
        outcome, reason = _non_convergence(q, confidence)
    else:
        gate = _gate(q)
        outcome, reason = (INCONCLUSIVE, gate) if gate else _convergence(q, shares, confidence)
    observed, interval = (slope.value, slope.interval(confidence)) if slope else (None, None)
    return Verdict(outcome, order, observed, interval, reason, tuple(fit.orders.tolist()), fit.window, shares)


def _gate(q: Quantity) -> str:
    """Why there is nothing to judge yet, with the run that would decide; empty if every gate is open."""
    fit, failed = q.fit, [level for level in q.ordered if level.ended]
    if len(q.levels) < LEVELS:
        return f"with fewer than {LEVELS} levels nothing shows that the order has settled: {q.finer}"
    if failed:
        return f"there is no error at h={_inverse(failed[0].h)} ({failed[0].ended}): that run has to finish"
    if fit.lowest <= CLEAR * q.floor:
        close = f"an error of {_short(fit.lowest)} is not clear of the round-off floor {_short(q.floor)}"
        return f"{close}: run h={_inverse(2 * fit.h[0])} in place of the finest"
    finest = f"run h={_inverse(fit.h[-1])} with half the time step"
    if q.dt_halved is None or not np.isfinite(q.dt_halved):
        return f"nothing shows that the time step is small enough: {finest}"
    change = abs(q.dt_halved / fit.replicates[-1][0] - 1)
    if change >= COUPLED:
        return f"coupled: half the time step changes the finest error by {change:.0%}: run all levels with it"
    rises = fit.h[1:][np.diff(fit.error) >= 0]
    return f"the error does not fall on the way to h={_inverse(rises[0])}: {q.finer}" if len(rises) else ""


def _convergence(q: Quantity, shares: Contamination | None, confidence: float) -> Finding:
    """The first FAIL of slope, contamination and magnitude, else the first INCONCLUSIVE, else PASS."""
    if q.fit.window is None or shares is None:
        orders = " ".join(f"{p:.2f}" for p in q.fit.orders)
        return INCONCLUSIVE, f"the local orders {orders} have not settled: {q.finer}"
    findings = [_equivalence(q, confidence), _purity(q, shares), _magnitude(q)]
    decided = [f for outcome in (FAIL, INCONCLUSIVE) for f in findings if f[0] is outcome]
    return decided[0] if decided else (PASS, "; ".join(text for _, text in findings if text))


def _equivalence(q: Quantity, confidence: float) -> Finding:
    """The whole interval of the slope, and the last local order, against the band."""
    slope, last, (low, high) = q.fit.slope, q.fit.orders[-1], q.band
    assert slope is not None  # a window has three levels
    start, end = slope.interval(confidence)
    percent = f"{100 * confidence:.3g} % interval {start:.2f} to {end:.2f}"
    text = f"order {slope.value:.2f} ({percent}, last pair {last:.2f}) against {low:.2f} to {high:.2f}"
    if low <= start and end <= high and low <= last <= high:
        return PASS, text
    if slope.value > high or last > high:
        return INCONCLUSIVE, f"{text}: above the band, so the expectation is wrong or errors cancel: {q.finer}"
    if end < low and last < low and not q.fit.rises_to(low):
        return FAIL, f"{text}: below the band"
    return INCONCLUSIVE, f"{text}: undecided: {q.finer}"


def _purity(q: Quantity, shares: Contamination) -> Finding:
    """Lower order and floor in the finest error. Orders that rise to the band tell of coarse grids, not of a defect."""
    parts = f"lower order {shares.lower:.0%}, floor {shares.floor:.0%} of the finest error, at most {shares.most:.1%}"
    if shares.total > DEFECT and not q.fit.rises_to(q.band[0]):
        return FAIL, f"the expected order is the smaller part: {parts}"
    if shares.most > NO_PASS:
        return INCONCLUSIVE, f"contamination of {NO_PASS:.0%} is not ruled out: {parts}: {q.finer}"
    return PASS, f"contamination at most {shares.most:.1%}"


def _magnitude(q: Quantity) -> Finding:
    """The recorded error at its own cell size; if that was not run, carried to the finest, which proves no FAIL."""
    e, fit = q.expectation, q.fit
    if e.constant is None or e.constant_h is None or e.order is None:
        return PASS, ""
    same = np.flatnonzero(np.isclose(fit.h, e.constant_h))
    at = int(same[0]) if len(same) else -1
    ratio = fit.error[at] / e.constant * (1 if len(same) else (e.constant_h / fit.h[at]) ** e.order)
    text = f"the error at h={_inverse(fit.h[at])} is {ratio:.2f} times the recorded one"
    if abs(ratio - 1) <= MAGNITUDE:
        return PASS, text
    return (FAIL, text) if len(same) else (INCONCLUSIVE, f"{text}, carried over: run h={_inverse(e.constant_h)}")


def _non_convergence(q: Quantity, confidence: float) -> Finding:
    """Met if the error grows clearly from its smallest value on, or if runs finer than a finished one lost det F.

    Where a stall is expected, an order that has fallen below it meets it, and lost runs do not.
    """
    e, lost = q.expectation, [level for level in q.ordered if "det F" in level.failed]
    h, error, slope, orders = q.fit.h, q.fit.error, q.fit.slope, q.fit.orders
    best, seen = int(np.argmin(error)), []
    finer = [level for level in lost if level.h < h[0]]
    if error[-1] >= GROWTH * error[best] > 0 and np.polyfit(np.log(h[best:]), np.log(error[best:]), 1)[0] < 0:
        seen.append(f"the error grew {_path(q.fit, best)}")
    if finer and e.stall is None:
        more = f" and {len(finer) - 1} finer as well" if finer[1:] else ""
        seen.append(f"the run at h={_inverse(finer[0].h)} ended with {finer[0].failed}{more}")
    if e.stall is not None and len(h) >= LEVELS and orders[-1] < e.stall and orders.max() - orders[-1] > DROP:
        seen.append(f"the order fell from {orders.max():.2f} to {orders[-1]:.2f} at h={_inverse(h[-1])}")
    if seen:
        return PASS, f"{'stalls' if e.stall is not None else 'does not converge'}, as expected: {', and '.join(seen)}"
    least = CONVERGES if e.stall is None else e.stall
    fine = e.stall_h is None or h[-1] <= e.stall_h * (1 + 1e-9)
    if fine and len(h) >= LEVELS and slope and min(slope.interval(confidence)[0], *orders) > least:
        return FAIL, f"a surprise: not expected to converge, the error fell {_path(q.fit)}, order {slope.value:.2f}"
    went = f"the error went {_path(q.fit)}" if h[1:].size else f"one level finished, h={_inverse(h[0])}"
    wanted = (
        "neither growth nor convergence" if e.stall is None else f"neither a stall below {e.stall:g} nor convergence"
    )
    return INCONCLUSIVE, f"{wanted}: {went}: {q.finer if fine else f'run h={_inverse(e.stall_h or 0.0)}'}"


def _path(fit: Fit, start: int = 0) -> str:
    ends = [f"{_short(fit.error[i])} at h={_inverse(fit.h[i])}" for i in (start, -1)]
    return f"from {ends[0]} to {ends[1]}"


def _short(error: float) -> str:
    return f"{error:.1e}".replace("e-0", "e-").replace("e+0", "e+")


def _inverse(h: float) -> str:
    """1/64 for a cell size of 0.015625: people count cells."""
    cells = round(1 / h)
    return f"1/{cells}" if cells > 1 and np.isclose(cells * h, 1) else f"{h:.4g}"
