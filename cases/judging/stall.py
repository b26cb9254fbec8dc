"""Stalls of a refinement, and their causes: each that could be, weighed by measured numbers.

A stall is a local order of the finest pair of levels below what is usual, and lower than before. The part of the finest
error that the usual order does not explain, the *excess*, is what a cause has to explain. A run that differs in nothing
but the cause and has a smaller error *shows* it; what is only measured where the order falls is *present*. A cause that
explains half of the excess is named, one that explains a quarter is named as a part, and where none does the report
says so. Causes are codes with numbers; their words are in reports/sentences/stalls.py.
"""

from dataclasses import dataclass, field
from enum import StrEnum
from itertools import pairwise
from math import log, sqrt

from mpm_verify.cases.judging.fit import local
from mpm_verify.cases.judging.records import Ended

USUAL, BELOW = 2.0, 0.2  # order of u of every method here before particles cross cells, and the band of the order rule
DROP = 0.1  # a smaller fall of the local order is none
FLAT = 0.5  # a local order below it is a stall without a fall before it
NAMED, PART = 0.5, 0.25  # fractions of the excess
CLEAR = 100.0  # times the round-off floor, as in the order rule
SPACING = 0.02  # gap between domains, in particle spacings, below which it is none
FOLLOWS = 0.5  # the excess grows with the crossings: least power
EDGE_NOISE = 0.75  # at most of what no measured cause explains: on 16 and 32 cells of docs/own-solution.md
STEADY = 0.5, 1.5  # floor of the finest pair over that of the pair before: one that grows or dies out is no floor
STIFF = 20.0  # bulk over shear modulus from which locking is asked for: a Poisson's ratio of 0.476
OUTGROWN = 0.25  # bulk over shear modulus, over the square of the cells, at which locking is half of the excess
ALIKE = 0.25  # relative difference of crossings that are as many


class Finding(StrEnum):
    """Evidence for a cause."""

    SHOWN = "shown"
    PRESENT = "present"
    EXCLUDED = "excluded"
    UNKNOWN = "not measured"


class CauseCode(StrEnum):
    """Causes that make an order fall; in brackets the numbers of the Cause, none where nothing is measured."""

    FAILED_RUN = "failed_run"  # a finer run failed, and so nothing is known of its order
    CROSSINGS = "cell_crossings"  # [faces; cells; faces_first, cells_first; cells_before, ratio, ...]
    QUADRATURE = "quadrature"  # with so few particles [ppc, other_ppc, change; order]
    GAPS = "gaps"  # and overlaps between domains [gap, gap_first, cells_first]
    TIME_STEP = "time_step"  # [change]
    ROUND_OFF = "round_off"  # [times: the finest error over its floor]
    LOCKING = "locking"  # too many constraints on the volume [ratio, cells; change, with a smoothed volume ratio]
    OTHER_SOLID = "other_solid"  # than that of the problem, by the rate of the material [error, size of the motion]
    EDGE_NOISE = "edge_noise"  # of particles beside a prescribed edge, undamped [error; change, where it is damped]
    SMALL_STRAIN = "small_strain"  # a material of small strains under others [floor, strain, size]
    DAMPING = "damping"  # that the problem does not have [alpha; change, without it]


@dataclass(frozen=True)
class Peer:
    """Another method on the same solution, cells and particle count: what is measured on its finest level."""

    method: str
    order: float
    crossings: float
    gap: float | None


@dataclass(frozen=True)
class Measured:
    """Measurements of one refinement: sequences over the finished levels, coarse to fine.

    `gaps` in particle spacings, None for methods that know points only. `halved` is the finest error with half the time
    step, `other` another particle count and the errors of the finest levels with it. `ended`: the next finer run, if it
    failed. `damping` is the fraction of the force that damping takes which the problem does not have, `size` that of
    the exact quantity, and `undamped` the finest error without damping. `stiffness` is the bulk modulus over the shear
    modulus, 0 where it is not known or the volume ratio is smoothed, `relieved` the finest error where it is; `strays`
    says whether the material is another solid than the one that the problem was made for, `edge_noise` whether an edge
    is prescribed where nothing damps the noise of particles, `quiet` is the finest error where something does. `strain`
    is the largest component of F - I where the material is one of small strains, and these are not.
    """

    cells: tuple[int, ...]
    errors: tuple[float, ...]
    crossings: tuple[float, ...]  # mean number of cell faces that a particle crossed
    gaps: tuple[float | None, ...]
    ppc: int
    floor: float = 0.0
    halved: float | None = None
    other: tuple[int, tuple[float, ...]] | None = None
    peers: tuple[Peer, ...] = ()
    ended: Ended | None = None
    order: float = USUAL
    below: float = BELOW
    damping: float = 0.0
    size: float = 0.0
    undamped: float | None = None
    stiffness: float = 0.0
    relieved: float | None = None
    strays: bool = False
    edge_noise: bool = False
    quiet: float | None = None
    strain: float = 0.0

    @property
    def orders(self) -> list[float]:
        """Local orders (n-1,)."""
        return [p for p in local([(1 / n, e) for n, e in zip(self.cells, self.errors, strict=True)]) if p is not None]

    @property
    def excess(self) -> list[float]:
        """Part of each error beyond the smallest that the usual order gives from a coarser level, (n,)."""
        return [max(0.0, e - min(self._carried(i))) for i, e in enumerate(self.errors)]

    @property
    def floors(self) -> list[float]:
        """Floor of each pair of levels (n-1,): what does not fall by the usual order, added in the square."""
        rises = [(fine / coarse) ** (2 * self.order) for coarse, fine in pairwise(self.cells)]
        found = zip(rises, pairwise(self.errors), strict=True)
        return [sqrt(max(0.0, r * late**2 - early**2) / (r - 1)) for r, (early, late) in found]

    def _carried(self, level: int) -> list[float]:
        """Errors up to a level, carried to it by the usual order."""
        known = zip(self.cells[: level + 1], self.errors, strict=False)
        return [e * (n / self.cells[level]) ** self.order for n, e in known]


@dataclass(frozen=True)
class Cause:
    """One cause: how it is known, the fraction of the excess that it explains (0 to 1), and what was measured of it.

    `peer` is a method that is like this one in what the cause is about, and keeps its order; `ended` a run that failed.
    """

    code: CauseCode
    finding: Finding
    weight: float
    numbers: dict[str, float] = field(default_factory=dict, hash=False)
    peer: Peer | None = None
    ended: Ended | None = None


@dataclass(frozen=True)
class Stall:
    """The local order from `coarser` to `cells`, those before it, and the causes: shown before present, then by weight.

    `coarser` is None where the order is as usual, and a finer run than that with `cells` failed: `ended`.
    """

    coarser: int | None
    cells: int
    order: float | None
    before: tuple[float, ...]
    causes: tuple[Cause, ...] = ()
    ended: Ended | None = None

    @property
    def named(self) -> list[Cause]:
        """Causes that explain half of the excess or more."""
        return [c for c in self.causes if c.weight >= NAMED]

    @property
    def parts(self) -> list[Cause]:
        """Causes that explain a quarter to a half of it."""
        return [c for c in self.causes if PART <= c.weight < NAMED]


def explain(m: Measured) -> Stall | None:
    """Stall of a refinement, None where the order is as usual or too little is known."""
    orders = m.orders
    if not (m.cells and (m.ended or stalls(m))):
        return None
    before, last = tuple(orders[:-1]), m.cells[-1]
    if not stalls(m):
        end = Cause(CauseCode.FAILED_RUN, Finding.SHOWN, 1.0, ended=m.ended)
        return Stall(None, last, orders[-1] if orders else None, before, (end, *_crossings_alone(m)), m.ended)
    others = [_particles(m), _gaps(m), _time_step(m), _floor(m), *([_damping(m)] if m.damping else [])]
    others += [*([_locking(m)] if m.stiffness >= STIFF else []), *([_other_solid(m)] if m.strays else [])]
    others += [_small_strain(m)] if m.strain else []
    explained = max(c.weight for c in others)
    steady = any(c.code is CauseCode.SMALL_STRAIN and c.weight >= NAMED for c in others)
    follows = 0.0 if steady else _follows(m)  # what stays the same beyond second order seems to grow with anything
    if m.edge_noise:
        others.append(_edge_noise(m, max(explained, follows)))
        explained = max(explained, others[-1].weight)
    causes = [_crossings(m, explained, follows), *others]
    rank = list(Finding)
    causes.sort(key=lambda c: (-(c.weight >= NAMED), rank.index(c.finding), -c.weight))
    return Stall(m.cells[-2], last, orders[-1], before, tuple(causes), m.ended)


def stalls(m: Measured) -> bool:
    """Whether the finest local order is too low and has fallen, or is that of locking or of noise at an edge."""
    orders = m.orders
    if len(orders) < len(m.cells) - 1 or not orders:  # an error of zero
        return False
    fell = len(orders) > 1 and orders[-1] <= max(orders[:-1]) - DROP
    locks = m.stiffness >= STIFF and _locking(m).weight >= PART
    return orders[-1] < m.order - m.below and (fell or locks or m.edge_noise or orders[-1] < FLAT)


def _fraction(m: Measured, removed: float) -> float:
    """Fraction of the excess that a change of the finest error removes, 0 to 1."""
    return min(1.0, max(0.0, removed) / m.excess[-1]) if m.excess[-1] > 0 else 0.0


def _judged(weight: float) -> Finding:
    return Finding.SHOWN if weight >= PART else Finding.EXCLUDED


def _particles(m: Measured) -> Cause:
    """Quadrature: the same cells with more particles, or with fewer where none has more."""
    if m.other is None:
        return Cause(CauseCode.QUADRATURE, Finding.UNKNOWN, 0.0)
    ppc, errors = m.other
    more, change = ppc > m.ppc, errors[-1] / m.errors[-1] - 1
    weight = (
        _fraction(m, -change * m.errors[-1]) if more else _fraction(m, m.errors[-1] * (1 - m.errors[-1] / errors[-1]))
    )
    numbers = {"ppc": float(m.ppc), "other_ppc": float(ppc), "change": change}
    if len(errors) > 1 and min(errors) > 0:
        numbers["order"] = log(errors[-2] / errors[-1]) / log(m.cells[-1] / m.cells[-2])
    return Cause(CauseCode.QUADRATURE, _judged(weight), weight, numbers)


def _gaps(m: Measured) -> Cause:
    """Gaps between domains: where they stay the same part of the spacing, refinement does not reduce their error."""
    if m.gaps[-1] is None or m.gaps[0] is None:
        return Cause(CauseCode.GAPS, Finding.EXCLUDED, 0.0)
    first, last = m.gaps[0], m.gaps[-1]
    numbers = {"gap": last, "gap_first": first, "cells_first": float(m.cells[0])}
    if last < SPACING or first <= 0:
        return Cause(CauseCode.GAPS, Finding.EXCLUDED, 0.0, numbers)
    best = _best([p for p in m.peers if p.gap is not None and p.gap < last / 2], m)
    falls = log(first / last) / log(m.cells[-1] / m.cells[0])  # 1 where corners are as near as the motion is smooth
    weight = min(1.0, max(0.0, 1 - falls))
    finding = Finding.PRESENT if weight >= PART else Finding.EXCLUDED
    return Cause(CauseCode.GAPS, finding, weight, numbers, best)


def _time_step(m: Measured) -> Cause:
    if m.halved is None:
        return Cause(CauseCode.TIME_STEP, Finding.UNKNOWN, 0.0)
    change = m.halved / m.errors[-1] - 1
    weight = _fraction(m, -change * m.errors[-1])
    return Cause(CauseCode.TIME_STEP, _judged(weight), weight, {"change": change})


def _floor(m: Measured) -> Cause:
    if m.floor <= 0:
        return Cause(CauseCode.ROUND_OFF, Finding.UNKNOWN, 0.0)
    above = m.errors[-1] / m.floor
    weight = min(1.0, CLEAR / above)
    return Cause(CauseCode.ROUND_OFF, _judged(weight), weight, {"times": above})


def _damping(m: Measured) -> Cause:
    """Damping that the problem does not have: it moves the body by its own fraction of the motion, or nearly so."""
    numbers = {"alpha": m.damping}
    if m.undamped is None:
        weight = min(1.0, m.damping * m.size / m.errors[-1])
        return Cause(CauseCode.DAMPING, Finding.PRESENT if weight >= PART else Finding.EXCLUDED, weight, numbers)
    change = m.undamped / m.errors[-1] - 1
    weight = _fraction(m, -change * m.errors[-1])
    return Cause(CauseCode.DAMPING, _judged(weight), weight, numbers | {"change": change})


def _locking(m: Measured) -> Cause:
    """Locking: particles hold the volume at more points than there are nodes to move, so that shear bends it too.

    Its error grows with the bulk over the shear modulus, and cells outgrow it: with Poisson's ratios of 0.49 and 0.499
    by 14 and 45, twice the root. Of u that was measured on solutions with pressure, see docs/materials.md.
    """
    numbers = {"ratio": m.stiffness, "cells": float(m.cells[-1])}
    weight, shown = m.stiffness / (m.stiffness + OUTGROWN * m.cells[-1] ** 2), 0.0
    if m.relieved is not None:  # a smoothed volume ratio has an error of its own: what it does not help is not excluded
        numbers["change"] = m.relieved / m.errors[-1] - 1
        shown = min(1.0, max(0.0, -numbers["change"]))
    if shown >= max(PART, weight):
        return Cause(CauseCode.LOCKING, Finding.SHOWN, shown, numbers)
    return Cause(CauseCode.LOCKING, Finding.PRESENT if weight >= PART else Finding.EXCLUDED, weight, numbers)


def _other_solid(m: Measured) -> Cause:
    """Material in rate form whose rate has no energy: what the errors converge to is the distance of two solids.

    It is the same on every grid, so it explains of the finest error what is in the least one too, and no growth.
    """
    weight = min(m.errors) / m.errors[-1]
    return Cause(CauseCode.OTHER_SOLID, Finding.PRESENT, weight, {"error": m.errors[-1], "size": m.size})


def _small_strain(m: Measured) -> Cause:
    """Material of small strains: its stress is that of its energy up to the strain, and so is the motion.

    The floor is what the two finest errors have in common, added in the square: at most the least error, and at most
    the strain times the motion, of which 0.17 to 0.43 were measured. It is one on all grids, see `STEADY`.
    """
    floors = m.floors
    floor = min([*floors[-1:], *m.errors, m.strain * m.size])
    steady = len(floors) < 2 or STEADY[0] * floors[-2] <= floors[-1] <= STEADY[1] * floors[-2]
    weight = _fraction(m, floor) if steady else 0.0
    numbers = {"floor": floor, "strain": m.strain, "size": m.size}
    return Cause(CauseCode.SMALL_STRAIN, Finding.PRESENT if weight >= PART else Finding.EXCLUDED, weight, numbers)


def _edge_noise(m: Measured, explained: float) -> Cause:
    """Noise beside a prescribed edge: shown by a run that damps it; without one it explains what others leave."""
    numbers = {"error": m.errors[-1]}
    if m.quiet is None:
        return Cause(CauseCode.EDGE_NOISE, Finding.PRESENT, EDGE_NOISE * (1 - explained), numbers)
    change = m.quiet / m.errors[-1] - 1
    weight = _fraction(m, -change * m.errors[-1])
    return Cause(CauseCode.EDGE_NOISE, _judged(weight), weight, numbers | {"change": change})


def _follows(m: Measured) -> float:
    """Power with which the excess grows with the crossings, at most 1; 0 where it does not, or nothing is known."""
    early, late = m.excess[-2:]
    if not (
        early > 0.05 * m.errors[-2] and m.crossings[-1] > max(PART, m.crossings[-2]) and m.crossings[-2] > 0 < late
    ):
        return 0.0
    power = log(late / early) / log(m.crossings[-1] / m.crossings[-2])
    return min(1.0, power) if power >= FOLLOWS else 0.0


def _crossings(m: Measured, explained: float, follows: float) -> Cause:
    """Cell crossings: they explain what other causes leave, or more where the excess grows with them.

    Every run of a moving body has them, so nothing shows them by themselves: a run without them has another motion.
    """
    first, last = m.crossings[0], m.crossings[-1]
    if last < PART:
        return Cause(CauseCode.CROSSINGS, Finding.EXCLUDED, 0.0, {"faces": last})
    numbers = {"faces": last, "faces_first": first, "cells_first": float(m.cells[0])}
    weight = min(1.0, last) * (1 - explained)
    if follows:
        weight = max(weight, follows)
        numbers |= {"cells": float(m.cells[-1]), "cells_before": float(m.cells[-2]), "usual": m.order}
        numbers |= {"ratio": m.crossings[-1] / m.crossings[-2], "excess_ratio": m.excess[-1] / m.excess[-2]}
    best = _best([p for p in m.peers if abs(p.crossings / last - 1) <= ALIKE], m)
    return Cause(CauseCode.CROSSINGS, Finding.PRESENT, weight, numbers, best)


def _best(peers: list[Peer], m: Measured) -> Peer | None:
    """Best of the methods that are like this one in some way and keep their order: then it is not that way."""
    kept = [p for p in peers if p.order >= m.order - m.below]
    return min(kept, key=lambda p: abs(p.order - m.order), default=None)


def _crossings_alone(m: Measured) -> list[Cause]:
    """Cell crossings where no order is known to fall."""
    numbers = {"faces": m.crossings[-1], "cells": float(m.cells[-1])}
    enough = m.crossings[-1] >= PART
    return [Cause(CauseCode.CROSSINGS, Finding.PRESENT, 0.0, numbers)] if enough else []
