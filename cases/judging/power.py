"""Rates of the order rule over sequences whose right verdict is known: how safe it is, and how powerful.

Each sequence is drawn many times with scatter and judged, with the gates of round-off and time step open. A rate has a
Wilson interval; and a bad sequence has the least rate of PASS that any rule can have which passes clean second order as
often: two sequences that differ by less than the scatter cannot be told apart.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from math import sqrt
from zlib import crc32

import numpy as np

from mpm_verify.cases.judging.known import CELLS, KNOWN, SCATTERS, Known
from mpm_verify.cases.judging.order import Expectation, Level, Outcome, Verdict, judge

CLEAN = KNOWN[0]
SECOND = Expectation(2.0)
FLOOR, HALVED = 1e-15, 1.02  # round-off floor; error with half the time step over the other
DRAWS, SEED = 400, 0
Z = 1.959963984540054  # of a two-sided 95 % interval
SAFE, SOUND = 0.05, 0.01  # of bad sequences pass; of sound ones fail
POWER = {"default": 0.95, "quick": 0.85, "six levels": 0.95}  # of clean second order passes with this scatter:
SCATTER = 0.03
Item = tuple[str, str, float]  # names of a sequence and of levels, scatter; a process can be given it


@dataclass(frozen=True)
class Row:
    """Verdicts on one sequence: how many draws passed, failed, and were left open.

    Parameters
    ----------
    sequence, levels, scatter
        Name of the sequence, name of the levels, scatter of an error.
    sound
        Whether PASS is right.
    other
        Fraction of the finest error that is not of second order.
    passed, failed, left
        Numbers of draws: PASS, FAIL, INCONCLUSIVE.
    reason
        Code of the commonest reason of those that did not pass.
    """

    sequence: str
    levels: str
    scatter: float
    sound: bool
    other: float
    passed: int
    failed: int
    left: int
    reason: str

    @property
    def draws(self) -> int:
        """Number of draws."""
        return self.passed + self.failed + self.left

    @property
    def wrong(self) -> int:
        """Number of wrong verdicts: FAIL of what is sound, PASS of what is bad."""
        return self.failed if self.sound else self.passed

    @property
    def right(self) -> int:
        """Number of right verdicts; the others are INCONCLUSIVE."""
        return self.passed if self.sound else self.failed

    def least(self, other: "Row") -> float:
        """Least rate of wrong verdicts of any rule that is right on `other` as often as this one.

        `other` has another right verdict, on the same levels and with the same scatter.

        References
        ----------
        Neyman & Pearson (1933), Philos. Trans. R. Soc. A 231, 289, doi:10.1098/rsta.1933.0009
        """
        from scipy.special import ndtr, ndtri

        power = interval(other.right, other.draws)[0]
        return float(ndtr(ndtri(power) - _distance(self, other))) if power > 0 else 0.0


def interval(count: int, draws: int) -> tuple[float, float]:
    """95 % interval of a rate.

    References
    ----------
    Wilson (1927), J. Am. Stat. Assoc. 22, 209, doi:10.1080/01621459.1927.10502953
    """
    rate, width = count / draws, Z**2 / draws
    middle, half = rate + width / 2, Z * sqrt(rate * (1 - rate) / draws + width / (4 * draws))
    return max(0.0, (middle - half) / (1 + width)), min(1.0, (middle + half) / (1 + width))


def judged(h: np.ndarray, error: np.ndarray) -> Verdict:
    """Verdict on errors (n,) at cell sizes (n,), both gates open."""
    levels = [Level(size, (e,)) for size, e in zip(h.tolist(), error.tolist(), strict=True)]
    return judge(levels, SECOND, floor=FLOOR, dt_halved=HALVED * float(error[-1]))


def row(item: Item, draws: int, seed: int) -> Row:
    """Count the verdicts on one sequence; a draw hangs on the seed, the names and its number alone."""
    name, levels, scatter = item
    known = named(name)
    h = 1 / np.array(CELLS[levels], dtype=np.float64)
    rng = np.random.default_rng([seed, crc32(f"{known.name}, {levels}, {scatter:g}".encode())])
    found = [judged(h, known.drawn(h, scatter, rng)) for _ in range(draws if scatter or known.cross else 1)]
    count = Counter(verdict.outcome for verdict in found)
    repeat = draws // len(found)  # without scatter every draw is the same
    reasons = Counter(str(verdict.reason.code) for verdict in found if verdict.outcome is not Outcome.PASS)
    return Row(
        known.name,
        levels,
        scatter,
        known.sound(h),
        known.other(h),
        repeat * count[Outcome.PASS],
        repeat * count[Outcome.FAIL],
        repeat * count[Outcome.INCONCLUSIVE],
        reasons.most_common(1)[0][0] if reasons else "",
    )


def named(name: str) -> Known:
    """Sequence of that name."""
    return next(one for one in KNOWN if one.name == name)


def _distance(one: Row, other: Row) -> float:
    """Distance of a sequence from a multiple of the other, the nearest one, in standard deviations of the scatter."""
    h = 1 / np.array(CELLS[one.levels], dtype=np.float64)
    ratio = np.log(named(one.sequence).error(h) / named(other.sequence).error(h))
    return float(np.linalg.norm(ratio - ratio.mean())) / one.scatter


def measure(draws: int = DRAWS, seed: int = SEED, mapping: Callable[..., Iterable[Row]] = map) -> list[Row]:
    """Rows of every sequence, levels and scatter.

    Parameters
    ----------
    draws, seed
        Draws of each row, and what they derive from.
    mapping
        Built-in map, or that of a pool of processes.

    Returns
    -------
    list of Row
        In the order of CELLS, SCATTERS and KNOWN.
    """
    items = [(known.name, levels, scatter) for levels in CELLS for scatter in SCATTERS for known in KNOWN]
    return list(mapping(partial(row, draws=draws, seed=seed), items))


class Standing(StrEnum):
    """Standing of a promise: its rate is as wanted, or its interval alone reaches to it, or not even that."""

    SHOWN = "shown"
    OPEN = "not shown"
    BROKEN = "broken"


@dataclass(frozen=True)
class Promise:
    """Promise of the rule on some levels: the row that comes nearest to breaking it, its rate and the limit.

    Parameters
    ----------
    kind
        `bad_passes`, `sound_fails` or `clean_passes`.
    row
        The worst of all.
    count
        Draws of it that count.
    limit
        Of their rate: the largest of what is wrong, the smallest of `clean_passes`.
    """

    kind: str
    row: Row
    count: int
    limit: float

    @property
    def kept(self) -> bool:
        """Whether the interval of the rate reaches to the right side of the limit."""
        low, high = interval(self.count, self.row.draws)
        return high >= self.limit if self.kind == "clean_passes" else low <= self.limit

    @property
    def standing(self) -> Standing:
        """Standing by rate and interval."""
        rate = self.count / self.row.draws
        wanted = rate >= self.limit if self.kind == "clean_passes" else rate <= self.limit
        return Standing.SHOWN if wanted else Standing.OPEN if self.kept else Standing.BROKEN


def promises(rows: Sequence[Row]) -> list[Promise]:
    """Promises on each of the levels; what no rule can tell is not held against it."""
    found, least = [], floors(rows)
    for levels in dict.fromkeys(one.levels for one in rows):
        here = [one for one in rows if one.levels == levels]
        clean = next(one for one in here if one.sequence == CLEAN.name and one.scatter == SCATTER)
        bad = max((one for one in here if not one.sound and least[one] <= SAFE), key=_wrong)
        sound = max((one for one in here if one.sound and least[one] <= SOUND), key=_wrong)
        found += [Promise("bad_passes", bad, bad.passed, SAFE), Promise("sound_fails", sound, sound.failed, SOUND)]
        found.append(Promise("clean_passes", clean, clean.passed, POWER[levels]))
    return found


def floors(rows: Sequence[Row]) -> dict[Row, float]:
    """Least rate of wrong verdicts of any rule, for each row; 0 without scatter, where all can be told."""
    found = dict.fromkeys(rows, 0.0)
    for one in rows:
        like = [o for o in rows if (o.levels, o.scatter) == (one.levels, one.scatter) and o.sound != one.sound]
        found[one] = max((one.least(other) for other in like if one.scatter), default=0.0)
    return found


def _wrong(one: Row) -> float:
    """Rate of wrong verdicts."""
    return one.wrong / one.draws
