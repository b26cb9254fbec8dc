"""Quantity to be judged: its levels, what is expected of it, and the runs that would decide."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import isclose

import numpy as np

from mpm_verify.cases.judging.fit import LEVELS, Fit
from mpm_verify.cases.judging.records import Action, Ended, Expectation, Level, Recorded, Wanted

LEAST_CELLS = 2  # of a study
FURTHEST = 3  # levels that are asked for at once
ROOM = 2 / 3  # of the band above the order: the rest is for the interval


@dataclass(frozen=True)
class Quantity:
    """Quantity to be judged.

    Parameters
    ----------
    levels, expectation, floor, dt_halved, multiple
        See `order.judge`.
    still
        Whether nothing moves in a run.

    Raises
    ------
    ValueError
        If two levels have the same cell size.
    """

    levels: Sequence[Level]
    expectation: Expectation
    floor: float
    dt_halved: float | None
    multiple: int = 1
    still: bool = False

    def __post_init__(self) -> None:
        if len({level.h for level in self.levels}) < len(self.levels):
            raise ValueError("two levels have the same cell size; give replicates as errors of one level")

    @cached_property
    def ordered(self) -> list[Level]:
        """All levels, coarse to fine."""
        return sorted(self.levels, key=lambda level: -level.h)

    @cached_property
    def fit(self) -> Fit:
        """Fit of the levels that finished, but for what is no finer than an error of zero, if enough are."""
        done = [level for level in self.ordered if not level.ended]
        positive = max((i + 1 for i, level in enumerate(done) if min(level.errors) == 0), default=0)
        done = done[positive:] if len(done) - positive >= LEVELS else done
        return Fit(np.array([level.h for level in done]), [np.array(level.errors) for level in done])

    @property
    def missing(self) -> Ended | None:
        """End of a level that a verdict needs, one among the finest; None where those finished."""
        fine = self.fit.h[-LEVELS:]
        needed = self.ordered if len(fine) < LEVELS else [one for one in self.ordered if one.h < fine[0]]
        return next((end for level in needed if (end := level.ended)), None)

    @cached_property
    def known(self) -> list[tuple[Level, Recorded]]:
        """Levels that finished and have a recorded error, coarse to fine."""
        recorded = [(level, one) for level in self.ordered if not level.ended for one in self.expectation.recorded
                    if isclose(level.h, one.h, rel_tol=1e-6)]  # fmt: skip
        return recorded

    @property
    def finer(self) -> Wanted:
        """Run to ask for when one more level would decide: the refinement goes on as it did last."""
        h = [level.h for level in self.ordered]
        return self.wanted(Action.ADD_LEVEL, h[-1] ** 2 / h[-2] if len(h) > 1 else h[-1] / 2)

    @property
    def beyond(self) -> Wanted:
        """Runs to ask for where the order is above the band: halved cells, until the excess should be in it.

        What makes an order larger than expected falls with h, as the next term of a series does, and where the local
        orders still rise it has not begun to.
        """
        orders, excess = self.fit.orders, float(self.fit.orders[-1]) - (self.expectation.order or 0.0)
        first = 1 if len(orders) > 1 and orders[-1] > orders[-2] else 0
        ahead = [excess / 2 ** max(0, k - first) for k in range(1, FURTHEST + 1)]
        enough = (k for k in range(1, FURTHEST + 1) if self._settled_by(ahead[:k]))
        h = [float(self.fit.h[-1]) / 2**k for k in range(1, next(enough, FURTHEST) + 1)]
        wanted = [self.wanted(Action.ADD_LEVEL, one) for one in h]
        return replace(wanted[-1], cells=tuple(sorted({cells for one in wanted for cells in one.cells})))

    def _settled_by(self, ahead: Sequence[float]) -> bool:
        """Whether the finest levels are in the band, with room, after levels of that excess over the order."""
        excess = [*(self.fit.orders - (self.expectation.order or 0.0)), *ahead][-LEVELS + 1 :]
        return bool(sum(excess) / len(excess) <= ROOM * self.expectation.above)

    @property
    def enough(self) -> Wanted:
        """Runs to ask for where there are fewer than LEVELS: as many as it takes, the refinement going on as it did."""
        quantity, wanted = self, self.finer
        while len(quantity.levels) + 1 < LEVELS:
            quantity = replace(quantity, levels=[*quantity.levels, Level(wanted.h, ())])
            wanted = quantity.finer
        return wanted

    def wanted(self, action: Action, h: float) -> Wanted:
        """Run that would decide, and all the cells of the study then, whole multiples of `multiple`."""
        counts = [round(1 / level.h) for level in self.ordered]
        if any(abs(n * level.h - 1) > 1e-6 for n, level in zip(counts, self.ordered, strict=True)):
            return Wanted(action, h)
        cells = max(1, round(1 / h / self.multiple)) * self.multiple
        if action is Action.ADD_LEVEL:
            finer = (counts[-1] // self.multiple + 1) * self.multiple
            cells = cells if h >= self.ordered[-1].h else max(cells, finer)
            counts.append(cells)
        if action is Action.REPLACE_FINEST:
            counts = [n for n in (cells, *counts[:-1]) if n >= LEAST_CELLS]
        return Wanted(action, 1 / cells if action is Action.ADD_LEVEL else h, tuple(sorted(set(counts))))

    @property
    def band(self) -> tuple[float, float]:
        """Band that the order must lie in; without bounds if none is expected."""
        e = self.expectation
        return (-np.inf, np.inf) if e.order is None else (e.order - e.below, e.order + e.above)
