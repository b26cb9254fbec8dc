"""What the order rule takes and gives: Expectation and Level in, Outcome and Verdict out."""

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:  # a run's records know an Expectation, and no edit of a fit makes them be run again
    from mpm_verify.cases.judging.fit import Contamination


class Outcome(StrEnum):
    """What the harness says of one quantity."""

    PASS = "PASS"
    FAIL = "FAIL"
    INCONCLUSIVE = "INCONCLUSIVE"
    ERROR = "ERROR"


@dataclass(frozen=True)
class Expectation:
    """Registered before the run: the band [order - below, order + above], its source, and the recorded error.

    `constant` is the error once recorded at cell size `constant_h`. An order of None expects non-convergence: growth of
    the error, or fine runs that lose their det F; if `stall` is given, a local order that falls below it on cells of
    `stall_h` or finer; if `lost` is given, that every run ends with these words in its reason.
    Raises ValueError if only one of the two is given, if the band has no width, or for a stall beside an order.
    """

    order: float | None
    below: float = 0.2
    above: float = 0.3
    source: str = ""
    constant: float | None = None
    constant_h: float | None = None
    stall: float | None = None
    stall_h: float | None = None
    lost: str = ""

    def __post_init__(self) -> None:
        if (self.constant is None) != (self.constant_h is None):
            raise ValueError("constant and constant_h belong together")
        if self.below <= 0 or self.above <= 0:
            raise ValueError(f"a band needs width on both sides, not {self.below} and {self.above}")
        if self.stall is not None and self.order is not None:
            raise ValueError(f"expected is either the order {self.order} or a stall below {self.stall}, not both")

    @property
    def kind(self) -> str:
        """`order 2`, `diverges`, `stalls`, or `lost` with the reason."""
        if self.order is not None:
            return f"order {self.order:g}"
        return "stalls" if self.stall is not None else f"lost: {self.lost}" if self.lost else "diverges"


@dataclass(frozen=True)
class Level:
    """Errors at one cell size `h`: one, or one a replicate, the run on the unshifted grid first.

    Raises ValueError for a cell size that is not positive or a negative error: a norm has no sign.
    """

    h: float
    errors: tuple[float, ...]
    failed: str = ""

    def __post_init__(self) -> None:
        if not self.h > 0 or any(e < 0 for e in self.errors):
            raise ValueError(f"not a level: h = {self.h}, errors = {self.errors}")

    @property
    def ended(self) -> str:
        """Why this level has no error to judge; empty if it has one."""
        if self.failed or not self.errors:
            return self.failed or "no error"
        return "" if np.isfinite(self.errors).all() else "an error that is not finite"


@dataclass(frozen=True)
class Verdict:
    """Outcome, what decided it in one sentence, and the numbers behind it, over the finished levels, coarse to fine."""

    outcome: Outcome
    expected: float | None
    observed: float | None
    interval: tuple[float, float] | None
    reason: str
    local_orders: tuple[float, ...] = ()
    window: tuple[int, int] | None = None
    contamination: "Contamination | None" = None
