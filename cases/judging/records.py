"""Records of the order rule: Expectation and Level in, Outcome, Reason and Verdict out; no words."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from math import isfinite, sqrt

from mpm_verify.solver.failure import Failure, FailureKind


class Outcome(StrEnum):
    """Outcome for one quantity."""

    PASS = "PASS"
    FAIL = "FAIL"
    INCONCLUSIVE = "INCONCLUSIVE"
    ERROR = "ERROR"


WORST = (Outcome.FAIL, Outcome.ERROR, Outcome.INCONCLUSIVE, Outcome.PASS)


def worst(outcomes: Iterable[Outcome]) -> Outcome:
    """The outcome that decides among several; INCONCLUSIVE where there is none."""
    found = set(outcomes)
    return next((outcome for outcome in WORST if outcome in found), Outcome.INCONCLUSIVE)


@dataclass(frozen=True)
class Recorded:
    """Error once recorded at a cell size h, or its range over variants of a method, low to high."""

    h: float
    low: float
    high: float

    def ratio(self, error: float) -> float:
        """Error over the recorded one; over the nearest end of a range, and 1 inside it."""
        return error / min(max(error, self.low), self.high)


@dataclass(frozen=True)
class Expectation:
    """Expectation, registered before the run.

    Parameters
    ----------
    order
        Expected order; None expects non-convergence: growth of the error, or fine runs whose particles are inverted.
    below, above
        Band [order - below, order + above] that the whole interval must lie in.
    source
        Where the expectation comes from.
    recorded
        Errors that are known.
    within, finest
        Largest relative distance from them; and whether of the finest level that has one alone, or of all.
    stall, stall_h
        Local order that the order falls below, on cells of `stall_h` or finer; without it, on which runs are inverted.
    failed
        Kind of failure that every run ends with.

    Raises
    ------
    ValueError
        If the band has no width, or for a stall beside an order.
    """

    order: float | None
    below: float = 0.2
    above: float = 0.3
    source: str = ""
    recorded: tuple[Recorded, ...] = ()
    within: float = 0.1
    finest: bool = False
    stall: float | None = None
    stall_h: float | None = None
    failed: FailureKind | None = None

    def __post_init__(self) -> None:
        if self.below <= 0 or self.above <= 0:
            raise ValueError(f"below = {self.below} and above = {self.above} must both be above zero")
        if self.stall is not None and self.order is not None:
            raise ValueError(f"expected is either the order {self.order} or a stall below {self.stall}, not both")

    @property
    def kind(self) -> str:
        """Kind in words: `order 2`, `diverges`, `stalls`, or `failed` with the kind of failure."""
        if self.order is not None:
            return f"order {self.order:g}"
        return "stalls" if self.stall is not None else f"failed {self.failed}" if self.failed else "diverges"


@dataclass(frozen=True)
class Ended:
    """Level without an error to judge: its cell size, why, and which of its replicates, 0 the unshifted one."""

    h: float
    failure: Failure
    replicate: int = 0


@dataclass(frozen=True)
class Level:
    """Level of a refinement.

    Parameters
    ----------
    h
        Cell size.
    errors
        One error, or one a replicate, the run on the unshifted grid first.
    failed
        What ended a run of the level, and `replicate` which one.
    replicate
        Number of the run that failed, 0 the unshifted one.

    Raises
    ------
    ValueError
        For a cell size that is not positive or a negative error: a norm has no sign.
    """

    h: float
    errors: tuple[float, ...]
    failed: Failure | None = None
    replicate: int = 0

    def __post_init__(self) -> None:
        if not self.h > 0 or any(e < 0 for e in self.errors):
            raise ValueError(f"a level needs h > 0 and errors >= 0, not h = {self.h} and errors = {self.errors}")

    @property
    def ended(self) -> Ended | None:
        """Reason why this level has no error to judge; None if it has one."""
        if self.failed:
            return Ended(self.h, self.failed, self.replicate)
        if self.errors and all(map(isfinite, self.errors)):
            return None
        kind = FailureKind.ERROR_NOT_FINITE if self.errors else FailureKind.NO_ERROR
        return Ended(self.h, Failure(kind, step=-1))

    def failed_by(self, kind: FailureKind) -> bool:
        """Whether a failure of that kind ended it."""
        return self.failed is not None and self.failed.kind is kind


class ReasonCode(StrEnum):
    """Reason of a verdict; in brackets its numbers. The words are in reports/sentences/verdicts.py."""

    AS_EXPECTED = "as_expected"  # PASS [those of ORDER_*, most, squared, and of MAGNITUDE if an error is recorded]
    ALL_FAILED = "all_failed"  # PASS: every run ended with the registered kind
    DIVERGES = "diverges"  # PASS [h_0, error_0, h_1, error_1 of growth; finer runs that failed]
    STALLS = "stalls"  # PASS [order_best, order_last, h_last; those of growth]
    ORDER_BELOW = "order_below"  # FAIL [order, start, end, confidence, last, band_low, band_high; from, of a window]
    CONTAMINATED = "contaminated"  # FAIL [lower, floor, error: the finest; least and power of a tail, or most, squared]
    MAGNITUDE = "magnitude"  # FAIL [h, ratio, within]
    FAR_OFF = "far_off"  # FAIL: more than FAR times the recorded error, carried over [h, ratio, recorded_h]
    NOTHING_MOVES = "nothing_moves"  # FAIL: the error of u is u itself
    RUN_ENDED = "run_ended"  # FAIL: particles were inverted or left the grid, where an order is expected
    FALLS_SHORT = "falls_short"  # FAIL: both finest local orders [first, last, band_low; flat, of a floor]
    CONVERGES = "converges"  # FAIL: not expected [h_0, error_0, h_1, error_1, order]
    NOTHING_FINISHED = "nothing_finished"  # ERROR
    TOO_FEW_LEVELS = "too_few_levels"  # INCONCLUSIVE from here on [levels needed]
    LEVEL_MISSING = "level_missing"
    NEAR_ROUND_OFF = "near_round_off"  # [error, floor; zeros: levels, where nothing else is there]
    TIME_STEP_UNKNOWN = "time_step_unknown"
    TIME_STEP_COUPLED = "time_step_coupled"  # [change: error with half the time step over the other, less 1]
    ERROR_RISES = "error_rises"  # [h]
    NOT_SETTLED = "not_settled"  # [local orders; lower, floor, error where they fall]
    ORDER_ABOVE = "order_above"
    ORDER_UNDECIDED = "order_undecided"
    CONTAMINATION_OPEN = "contamination_open"  # [limit, lower, floor, error, most, squared]
    ADDS_IN_SQUARE = "adds_in_square"  # [shown]
    MAGNITUDE_CARRIED = "magnitude_carried"  # [h, ratio]
    NEITHER = "neither"  # growth, or a stall below `stall`, nor convergence [stall, h_0, error_0, h_1, error_1]


class Action(StrEnum):
    """Change of the study that would decide."""

    ADD_LEVEL = "add_level"
    REPLACE_FINEST = "replace_finest"  # by a level coarser than all
    HALVE_FINEST = "halve_finest"  # the time step of the finest level, beside the whole one
    HALVE_ALL = "halve_all"  # the time step of every level
    FINISH = "finish"  # a level that has no error


@dataclass(frozen=True)
class Wanted:
    """Run that would decide: what it changes, its cell size, and all cells to run then.

    `cells` is empty where cell sizes are not one over whole numbers.
    """

    action: Action
    h: float
    cells: tuple[int, ...] = ()


Numbers = dict[str, float | tuple[float, ...]]


@dataclass(frozen=True)
class Reason:
    """Reason of a verdict: a code, its numbers, levels without an error, and the run that would decide."""

    code: ReasonCode
    numbers: Numbers = field(default_factory=dict, hash=False)
    failed: tuple[Ended, ...] = ()
    wanted: Wanted | None = None


@dataclass(frozen=True, slots=True)
class Contamination:
    """Fractions of the finest error that are not of the expected order.

    Parameters
    ----------
    lower, floor
        Lower-order term and floor in the best fit of the error.
    added
        Largest total that the data do not refute.
    squared
        The same of parts that add in the square, which raise an error by less than their fraction.
    shown
        Fraction that adds in the square and is shown to be there; 0 where none is.
    """

    lower: float
    floor: float
    added: float
    squared: float = 0.0
    shown: float = 0.0

    @property
    def total(self) -> float:
        """Fraction of the finest error that is not of the expected order."""
        return self.lower + self.floor

    @property
    def most(self) -> float:
        """Largest fraction by which the finest error would fall without what contaminates it, in either way."""
        return max(self.added, 1 - sqrt(1 - min(self.squared, 1.0) ** 2))


@dataclass(frozen=True)
class Verdict:
    """Verdict on one quantity.

    Parameters
    ----------
    outcome, reason
        What came out, and what decided it.
    expected
        Expected order; None if none is.
    observed, interval
        Fitted order and its interval; None with fewer than three finished levels.
    local_orders
        Orders between consecutive finished levels, coarse to fine.
    window
        First and last finished level of the asymptotic window.
    contamination
        Fractions of the finest error that are not of the expected order.
    """

    outcome: Outcome
    expected: float | None
    observed: float | None
    interval: tuple[float, float] | None
    reason: Reason
    local_orders: tuple[float, ...] = ()
    window: tuple[int, int] | None = None
    contamination: "Contamination | None" = None
