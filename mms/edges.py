"""Which boundary a solver can impose on the four sides of a rectangle, found from the manufactured fields.

fixed    u = 0
roller   u . n = 0, and no shear traction
free     no traction, P N = 0
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.mms.measure import CELLS, TIMES, Law, Sampler, largest, least_stress
from mpm_verify.solver.state import Floats

SIDES = ("left", "right", "bottom", "top")  # side // 2 is the axis of the normal, side % 2 lower or upper
PLACES = 65  # along a side
ROUND = 1e-9  # of the largest displacement or stress: above round-off, below what could be meant


@dataclass(frozen=True)
class Peak:
    """The largest size of a quantity on a side, with its place and time."""

    value: float
    X: Floats
    t: float

    def __str__(self) -> str:
        return f"{self.value:.3g} at (X, Y) = ({self.X[0]:.4g}, {self.X[1]:.4g}), t = {self.t:.4g}"


@dataclass(frozen=True)
class Side:
    """Largest displacement across and along a side, largest traction across and along."""

    name: str
    across: Peak
    along: Peak
    pull: Peak
    shear: Peak


@dataclass(frozen=True)
class Edges:
    """The four sides; `reach` is the largest displacement in the body.

    `move` and `stress` are sizes below which a displacement and a traction are round-off.
    """

    sides: tuple[Side, ...]
    reach: float
    move: float
    stress: float

    @property
    def kinds(self) -> tuple[str, ...]:
        """The first that holds, one a side; "" where it is nothing that the solver has."""
        return tuple((*self.possible(side), "")[0] for side in self.sides)

    def possible(self, side: Side) -> tuple[str, ...]:
        """What holds on the side; fixed before roller before free."""
        still, no_shear = side.across.value <= self.move, side.shear.value <= self.stress
        holds = {
            "fixed": still and side.along.value <= self.move,
            "roller": still and no_shear,
            "free": no_shear and side.pull.value <= self.stress,
        }
        return tuple(kind for kind, true in holds.items() if true)

    def wrong(self, kinds: tuple[str, ...]) -> str:
        """One sentence on the first side that cannot be of the kind it is meant to be; empty where all can."""
        for side, kind in zip(self.sides, kinds, strict=True):
            if kind not in self.possible(side):
                meant = f"cannot be {kind}" if kind else "is neither fixed nor roller nor free"
                return (
                    f"the {side.name} edge {meant}: u across it {side.across}; u along it {side.along}; "
                    f"traction across it {side.pull}; traction along it {side.shear}"
                )
        return ""


def examine(solution: Any, exact: Manufactured, law: Law) -> Edges:
    """Displacements and tractions on the four sides of the body over the duration."""
    sampler, times = Sampler(exact), np.linspace(0.0, solution.duration, TIMES)
    body = sampler(solution.layout(float(solution.upper[0] - solution.lower[0]) / CELLS, 4).X, times)
    reach, sides = float(np.hypot(body.u[..., 0], body.u[..., 1]).max()), []
    for number, name in enumerate(SIDES):
        axis, corner = number // 2, (solution.lower, solution.upper)[number % 2]
        X = np.linspace(solution.lower, solution.upper, PLACES)
        X[:, axis] = corner[axis]
        s = sampler(X, times)
        reach = max(reach, float(np.hypot(s.u[..., 0], s.u[..., 1]).max()))
        quantities = (s.u[..., axis], s.u[..., 1 - axis], s.P[..., axis, axis], s.P[..., 1 - axis, axis])
        sides.append(Side(name, *(peak(values, X, times) for values in quantities)))
    return Edges(tuple(sides), reach, ROUND * reach, ROUND * max(largest(body.P), least_stress(law)))


def peak(values: Floats, X: Floats, times: Floats) -> Peak:
    """The largest size of `values` (T,P)."""
    k, p = np.unravel_index(int(np.abs(values).argmax()), values.shape)
    return Peak(float(abs(values[k, p])), X[p], float(times[k]))
