"""Where a refinement stalls, and why: each cause that could be, weighed by measured numbers.

A stall is a local order of the finest pair of levels below what is usual, and lower than before. The part of the finest
error that the usual order does not explain, the *excess*, is what a cause has to explain. A run that differs in nothing
but the cause and has a smaller error *shows* it; what is only measured where the order falls is *present*. A cause that
explains half of the excess is named, one that explains a quarter is named as a part, and where none does the report
says so.
"""

from dataclasses import dataclass, field
from enum import StrEnum
from math import log

from mpm_verify.cases.judging.fit import local

USUAL, BELOW = 2.0, 0.2  # order of u of every method here before particles cross cells, and the band of the order rule
DROP = 0.1  # a smaller fall of the local order is none
FLAT = 0.5  # a local order below it is a stall without a fall before it
NAMED, PART = 0.5, 0.25  # shares of the excess
CLEAR = 100.0  # times the round-off floor, as in the order rule
SPACING = 0.02  # gap between domains, in particle spacings, below which it is none
FOLLOWS = 0.5  # the excess grows with the crossings: least power
ALIKE = 0.25  # relative difference of crossings that are as many


class Finding(StrEnum):
    """How well a cause is known."""

    SHOWN = "shown"
    PRESENT = "present"
    EXCLUDED = "excluded"
    UNKNOWN = "not measured"


@dataclass(frozen=True)
class Peer:
    """Another method on the same solution, cells and particle count: what is measured on its finest level."""

    method: str
    order: float
    crossings: float
    gap: float | None


@dataclass(frozen=True)
class Measured:
    """What is measured of one refinement: sequences over the finished levels, coarse to fine.

    `gaps` in particle spacings, None for methods that know points only. `halved` is the finest error with half the time
    step, `other` another particle count and the errors of the finest levels with it. `lost` says how finer runs ended.
    """

    cells: tuple[int, ...]
    errors: tuple[float, ...]
    crossings: tuple[float, ...]  # faces of cells that a particle passed
    gaps: tuple[float | None, ...]
    ppc: int
    floor: float = 0.0
    halved: float | None = None
    other: tuple[int, tuple[float, ...]] | None = None
    peers: tuple[Peer, ...] = ()
    lost: str = ""
    order: float = USUAL
    below: float = BELOW

    @property
    def orders(self) -> list[float]:
        """Local orders (n-1,)."""
        return [p for p in local([(1 / n, e) for n, e in zip(self.cells, self.errors, strict=True)]) if p is not None]

    @property
    def excess(self) -> list[float]:
        """The part of each error beyond the smallest that the usual order gives from a coarser level, (n,)."""
        return [max(0.0, e - min(self._carried(i))) for i, e in enumerate(self.errors)]

    def _carried(self, level: int) -> list[float]:
        """The errors up to a level, carried to it by the usual order."""
        known = zip(self.cells[: level + 1], self.errors, strict=False)
        return [e * (n / self.cells[level]) ** self.order for n, e in known]


@dataclass(frozen=True)
class Cause:
    """One cause: how it is known, the share of the excess that it explains (0 to 1), and the numbers in a sentence."""

    name: str
    finding: Finding
    weight: float
    text: str


@dataclass(frozen=True)
class Stall:
    """Where, the finest local order and those before it, and the causes: shown before present, then by weight."""

    where: str
    order: float | None
    before: tuple[float, ...]
    causes: tuple[Cause, ...] = field(default=())

    @property
    def named(self) -> list[Cause]:
        """What the evidence names."""
        return [c for c in self.causes if c.weight >= NAMED]

    @property
    def parts(self) -> list[Cause]:
        """What explains a part."""
        return [c for c in self.causes if PART <= c.weight < NAMED]

    @property
    def reasons(self) -> list[str]:
        """What explains the excess, or a part of it, in sentences; where no cause is named, they say so."""
        said = [f"{c.name[:1].upper()}{c.name[1:]}: {c.text}." for c in self.named]
        said = said or ["The evidence does not name a cause."]
        return said + [f"In part {c.name}: {c.text}." for c in self.parts]

    @property
    def why(self) -> list[str]:
        """All causes in sentences: `reasons`, then those that are not it or not known in one sentence each."""
        said = list(self.reasons)
        for label, finding in (("Not", Finding.EXCLUDED), ("Not measured", Finding.UNKNOWN)):
            some = [f"{c.name} ({c.text})" for c in self.causes if c.finding is finding]
            said += [f"{label}: {'; '.join(some)}."] if some else []
        small = [c for c in self.causes if c.finding is Finding.PRESENT and c.weight < PART]
        return said + [f"Measured too: {c.name} ({c.text})." for c in small]


def explain(m: Measured) -> Stall | None:
    """The stall of a refinement, None where the order is as usual or too little is known."""
    orders = m.orders
    if not (m.cells and (m.lost or stalls(m))):
        return None
    if not stalls(m):
        end = (Cause("a lost run", Finding.SHOWN, 1.0, m.lost), *_crossings_alone(m))
        where = f"the finest run that finished has {m.cells[-1]} cells"
        return Stall(where, orders[-1] if orders else None, tuple(orders[:-1]), end)
    before = f"; {', '.join(f'{p:.2f}' for p in orders[:-1])} before" if orders[1:] else ""
    where = f"from {m.cells[-2]} to {m.cells[-1]} cells the order is {orders[-1]:.2f}{before}"
    where += f"; {m.lost}" if m.lost else ""
    others = [_particles(m), _gaps(m), _time_step(m), _floor(m)]
    causes = [_crossings(m, max(c.weight for c in others)), *others]
    rank = list(Finding)
    causes.sort(key=lambda c: (-(c.weight >= NAMED), rank.index(c.finding), -c.weight))
    return Stall(where, orders[-1], tuple(orders[:-1]), tuple(causes))


def stalls(m: Measured) -> bool:
    """Whether the finest local order is too low and has fallen."""
    orders = m.orders
    if len(orders) < len(m.cells) - 1 or not orders:  # an error of zero
        return False
    fell = len(orders) > 1 and orders[-1] <= max(orders[:-1]) - DROP
    return orders[-1] < m.order - m.below and (fell or orders[-1] < FLAT)


def _share(m: Measured, removed: float) -> float:
    """What a change of the finest error is of the excess, 0 to 1."""
    return min(1.0, max(0.0, removed) / m.excess[-1]) if m.excess[-1] > 0 else 0.0


def _judged(weight: float) -> Finding:
    return Finding.SHOWN if weight >= PART else Finding.EXCLUDED


def _particles(m: Measured) -> Cause:
    """The same cells with more particles, or with fewer where none has more."""
    name = "quadrature with so few particles"
    if m.other is None:
        return Cause(name, Finding.UNKNOWN, 0.0, "one particle count only; a list for --ppc adds others")
    ppc, errors = m.other
    more, change = ppc > m.ppc, errors[-1] / m.errors[-1] - 1
    weight = _share(m, -change * m.errors[-1]) if more else _share(m, m.errors[-1] * (1 - m.errors[-1] / errors[-1]))
    word = "smaller" if change < 0 else "larger"
    text = f"with {ppc} per cell in place of {m.ppc} the finest error is {abs(change):.0%} {word}"
    if len(errors) > 1 and min(errors) > 0:
        text += f" and its order {log(errors[-2] / errors[-1]) / log(m.cells[-1] / m.cells[-2]):.2f}"
    return Cause(name, _judged(weight), weight, text)


def _gaps(m: Measured) -> Cause:
    """Gaps that stay the same share of the spacing leave an error that refinement does not reduce as the order asks."""
    name = "gaps and overlaps between domains"
    if m.gaps[-1] is None or m.gaps[0] is None:
        return Cause(name, Finding.EXCLUDED, 0.0, "this method knows points only")
    first, last = m.gaps[0], m.gaps[-1]
    text = f"corners are off by {last:.1%} of the particle spacing, {first:.1%} at {m.cells[0]} cells"
    if last < SPACING or first <= 0:
        return Cause(name, Finding.EXCLUDED, 0.0, text)
    best = _best([p for p in m.peers if p.gap is not None and p.gap < last / 2], m)
    text += f"; {best.method} has {best.gap:.1%} and order {best.order:.2f}" if best else ""
    falls = log(first / last) / log(m.cells[-1] / m.cells[0])  # 1 where corners are as near as the motion is smooth
    weight = min(1.0, max(0.0, 1 - falls))
    return Cause(name, Finding.PRESENT if weight >= PART else Finding.EXCLUDED, weight, text)


def _time_step(m: Measured) -> Cause:
    name = "the time step"
    if m.halved is None:
        return Cause(name, Finding.UNKNOWN, 0.0, "no run with half of it; a list for --courant adds one")
    change = m.halved / m.errors[-1] - 1
    weight = _share(m, -change * m.errors[-1])
    text = f"half of it changes the finest error by {change:+.1%}"
    return Cause(name, _judged(weight), weight, text)


def _floor(m: Measured) -> Cause:
    name = "round-off"
    if m.floor <= 0:
        return Cause(name, Finding.UNKNOWN, 0.0, "no floor is known")
    above = m.errors[-1] / m.floor
    weight = min(1.0, CLEAR / above)
    return Cause(name, _judged(weight), weight, f"the finest error is {above:.1g} times its floor")


def _crossings(m: Measured, explained: float) -> Cause:
    """Crossings explain what other causes leave, or more where the excess grows with them.

    Every run of a moving body has them, so nothing shows them by themselves: a run without them has another motion.
    """
    name, first, last = "cell crossings", m.crossings[0], m.crossings[-1]
    text = f"a particle passes {last:.1f} faces, {first:.1f} at {m.cells[0]} cells"
    if last < PART:
        return Cause(name, Finding.EXCLUDED, 0.0, f"a particle passes {last:.2g} faces")
    weight = min(1.0, last) * (1 - explained)
    early, late = m.excess[-2:]
    if early > 0.05 * m.errors[-2] and m.crossings[-1] > m.crossings[-2] > 0 and late > 0:
        power = log(late / early) / log(m.crossings[-1] / m.crossings[-2])
        ratio = m.crossings[-1] / m.crossings[-2]
        if power >= FOLLOWS:
            weight = max(weight, min(1.0, power))
            text += f"; from {m.cells[-2]} to {m.cells[-1]} cells they grow {ratio:.1f}-fold and the error beyond "
            text += f"order {m.order:g} {late / early:.1f}-fold"
    best = _best([p for p in m.peers if abs(p.crossings / last - 1) <= ALIKE], m)
    text += f"; {best.method} passes {best.crossings:.1f} and has order {best.order:.2f}" if best else ""
    return Cause(name, Finding.PRESENT, weight, text)


def _best(peers: list[Peer], m: Measured) -> Peer | None:
    """Of methods that are like this one in some way, the one that keeps its order best: then it is not that way."""
    kept = [p for p in peers if p.order >= m.order - m.below]
    return min(kept, key=lambda p: abs(p.order - m.order), default=None)


def _crossings_alone(m: Measured) -> list[Cause]:
    """Crossings where no order is known to fall."""
    last = m.crossings[-1]
    text = f"a particle passes {last:.1f} faces at {m.cells[-1]} cells"
    return [Cause("cell crossings", Finding.PRESENT, 0.0, text)] if last >= PART else []
