"""Boundary that a solver can impose on the sides of a body, found from the manufactured fields.

fixed       u = 0
roller      u . n = 0, and no shear traction
free        no traction, P N = 0
pulled      the exact traction P N
prescribed  the exact displacement

Any edge can be of the last two; one of none of the others is pulled, unless it misses one of them by so little that a
constant may have been rounded.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm_verify.mms.components import at
from mpm_verify.mms.discretisation import dimension
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.mms.measure import TIMES, Sampler, WaveMaterial, inside, largest, least_stress
from mpm_verify.solver.sides import SOLID_SIDES
from mpm_verify.solver.state import Floats

POINTS = {1: 1, 2: 65, 3: 17}  # sampled along a side, or along each axis of a face
ROUND = 1e-9  # fraction of the largest displacement or stress: above round-off, below what could be meant
ROUNDED = 5e-3  # fraction of the same: 3.14 for pi misses by less
OPEN = ("pulled", "prescribed")  # kinds that any edge can be of
NEEDS = {
    "fixed": ("normal displacement", "tangential displacement"),
    "roller": ("normal displacement", "tangential traction"),
    "free": ("normal traction", "tangential traction"),
}


@dataclass(frozen=True)
class Peak:
    """Largest size of a quantity on a side, with its reference position and time."""

    value: float
    X: Floats
    t: float

    def __str__(self) -> str:
        return f"{self.value:.3g} at {at(self.X)}, t = {self.t:.4g}"


@dataclass(frozen=True)
class Side:
    """Largest normal and tangential displacement, largest normal and tangential traction."""

    name: str
    normal: Peak
    tangential: Peak
    normal_traction: Peak
    tangential_traction: Peak


@dataclass(frozen=True)
class Edges:
    """Sides of a body; `reach` is its largest displacement, `motion` the largest component of one.

    `move` and `stress` are sizes below which a displacement and a traction are round-off. `uniform` says that F is the
    same everywhere at a time.
    """

    sides: tuple[Side, ...]
    reach: float
    motion: float
    move: float
    stress: float
    uniform: bool = False

    @property
    def kinds(self) -> tuple[str, ...]:
        """First kind that holds, one a side; "" where it may be meant to be another than `pulled`, see `rounded`."""
        return tuple((*self.possible(side), "" if self.rounded(side) else OPEN[0])[0] for side in self.sides)

    def rounded(self, side: Side) -> bool:
        """Whether the side misses the kind that it is nearest to by what a rounded constant makes."""
        return self.miss(side, self.nearest(side))[0] <= ROUNDED

    def nearest(self, side: Side) -> str:
        """Kind of a wall or a free edge that the side misses by the least."""
        return min(NEEDS, key=lambda kind: self.miss(side, kind)[0])

    def misses(self, side: Side) -> dict[str, tuple[float, Peak]]:
        """Displacements and tractions of the side as fractions of the body's largest, with their peaks."""
        motion, stress = self.motion or 1.0, self.stress / ROUND
        return {
            "normal displacement": (side.normal.value / motion, side.normal),
            "tangential displacement": (side.tangential.value / motion, side.tangential),
            "normal traction": (side.normal_traction.value / stress, side.normal_traction),
            "tangential traction": (side.tangential_traction.value / stress, side.tangential_traction),
        }

    def miss(self, side: Side, kind: str) -> tuple[float, str]:
        """Fraction of the body's largest by which the side is not of the kind, and in what."""
        return max((self.misses(side)[need][0], need) for need in NEEDS[kind])

    def possible(self, side: Side) -> tuple[str, ...]:
        """Kinds that hold on the side; fixed before roller before free."""
        still, no_shear = side.normal.value <= self.move, side.tangential_traction.value <= self.stress
        holds = {
            "fixed": still and side.tangential.value <= self.move,
            "roller": still and no_shear,
            "free": no_shear and side.normal_traction.value <= self.stress,
        }
        return tuple(kind for kind, true in holds.items() if true)

    def wrong(self, kinds: tuple[str, ...]) -> str:
        """Line on the first side that cannot be of the kind it is meant to be; empty where all can."""
        for side, kind in zip(self.sides, kinds, strict=True):
            if kind not in (*self.possible(side), *OPEN):
                return self.line(side, kind)
        return ""

    def line(self, side: Side, kind: str) -> str:
        """Line on how far the side is from the kind it is meant to be, or "" from any, and what to write."""
        meant = kind or self.nearest(side)
        fraction, quantity = self.miss(side, meant)
        if fraction <= ROUNDED:
            return (
                f"the {side.name} edge is not quite {meant}: its {self.told(side, quantity)}. That looks like a "
                "rounded constant, such as 3.14 for pi: write sp.pi, sp.Rational(1, 3), sp.sqrt(2); if it is meant so, "
                'name the edge pulled or prescribed in "boundary"'
            )
        holds = self.possible(side)
        instead = f"it is {holds[0]}" if holds else "it is pulled or prescribed"
        return (
            f"the {side.name} edge cannot be {kind}: its {self.told(side, quantity)}; {instead}: write that, or leave "
            '"boundary" out'
        )

    def told(self, side: Side, quantity: str) -> str:
        """Text of a quantity with its peak, and as a fraction."""
        fraction, peak = self.misses(side)[quantity]
        of = "motion" if "displacement" in quantity else "stress"
        return f"{quantity} is {peak}, {fraction:.1g} of the largest {of}"


def examine(solution: Any, exact: Manufactured, material: WaveMaterial) -> Edges:
    """Find displacements and tractions on the sides of the body over the duration."""
    sampler, times, d = Sampler(exact), np.linspace(0.0, solution.duration, TIMES), dimension(solution)
    body = sampler(inside(solution).X, times)
    reach, sides = length(body.u), []
    for number, name in enumerate(SOLID_SIDES[: 2 * d]):
        axis, corner = number // 2, (solution.lower, solution.upper)[number % 2]
        X, others = lattice(solution, POINTS[d], axis, corner[axis]), [k for k in range(d) if k != axis]
        s = sampler(X, times)
        reach = max(reach, length(s.u))
        quantities = (s.u[..., [axis]], s.u[..., others], s.P[..., [axis], axis], s.P[..., others, axis])
        sides.append(Side(name, *(peak(values, X, times) for values in quantities)))
    motion = max(largest(body.u), *(peak.value for side in sides for peak in (side.normal, side.tangential)))
    stress = ROUND * max(largest(body.P), least_stress(material))
    uniform = largest(body.F - body.F[:, :1]) <= ROUND * largest(body.F - np.eye(body.F.shape[-1]))
    return Edges(tuple(sides), reach, motion, ROUND * reach, stress, uniform)


def lattice(solution: Any, count: int, axis: int = -1, value: float = 0.0) -> Floats:
    """Reference positions (n,d) in rows, `count` on each axis, the sides included; of one value on an `axis`."""
    lines = [np.linspace(solution.lower[k], solution.upper[k], count) for k in range(dimension(solution))]
    if axis >= 0:
        lines[axis] = np.array([value])
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, len(lines))


def length(u: Floats) -> float:
    """Largest length of displacements (...,d)."""
    return float(np.hypot.reduce(u, axis=-1).max())


def peak(values: Floats, X: Floats, times: Floats) -> Peak:
    """Largest size of the components of `values` (T,P,n), zero where there are none."""
    size = np.abs(values).max(axis=-1, initial=0.0)
    k, p = np.unravel_index(int(size.argmax()), size.shape)
    return Peak(float(size[k, p]), X[p], float(times[k]))
