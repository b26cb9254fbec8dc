"""The contract between bases and transfers: one table of weights for a block of particles, one signature to fill it.

The table of a basis with K neighbours a particle, for a block of BLOCK particles, is two flat arrays:

    node[k*B + b]              neighbour k of particle b, an index of grid arrays
    table[k*B + b]             N, its shape value
    table[(K + k)*B + b]       dN/dx
    table[(2*K + k)*B + b]     dN/dy

A fill sees the arrays of its block alone, flat: x[2*b + axis], F[4*b + 2*row + column], and domain[W*b + entry], W
numbers that the basis keeps of each particle's domain. Both layouts are there for the compiler: with fixed distances
between the streams, and as few arrays as this, it works on eight particles at once (five times faster than a table
[b, k]). So, in a fill: no branch, no division but the one needed, floor() for the cell.

A fill returns False, and its table is not used, if a neighbour lies outside `box` = (x0, x1, y0, y1), in cells from the
grid's origin. Comparisons are written so that a NaN lies outside. The walls of the grid stand PAD cells inside its nx
by ny nodes.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mpm_verify.solver._jit import BLOCK, F1, I1, f8, flag, function_type, i8, kernel
from mpm_verify.solver.failure import FailureKind
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.promise import Promise as Promise
from mpm_verify.solver.state import Floats, Grid, Particles

#         x   F  domain ox  oy 1/dx nx  ny  x0  x1  y0  y1 table node
FILL = flag(F1, F1, F1, f8, f8, f8, i8, i8, f8, f8, f8, f8, F1, I1)
Fill = function_type(FILL)
Refusal = tuple[FailureKind, dict[str, float]]  # and its numbers, see Failure
Place = Callable[[Floats], Floats]


@dataclass(frozen=True)
class Basis:
    """A basis is data plus one kernel; its file in solver/basis is its name. This one knows points alone."""

    support: ClassVar[int]  # K
    order: ClassVar[float]  # of the displacement while no particle crosses a cell; source in the docstring
    fill: ClassVar[Callable[..., bool]]  # a kernel of signature FILL
    domain_size: ClassVar[int] = 0  # W
    gradients_jump: ClassVar[bool] = False  # those of weights, where a particle crosses a cell
    has_limit: ClassVar[bool] = False  # of the half diagonals of domains
    limit = inf  # that limit, in cells

    def domain(self, layout: Layout, place: Place) -> Floats:
        """What the basis keeps of the domains, (P,W); `place` takes reference places (n,2) to those at the start."""
        return np.zeros((len(layout), 0))

    def populate(self, layout: Layout, rho0: float, place: Place = lambda X: X) -> Particles:
        """Particles at the places of the layout, and their domains where `place` takes them."""
        return Particles(layout.X, rho0 * layout.V0, layout.V0, self.domain(layout, place))

    @classmethod
    def promises(cls, crossing: bool) -> Promise:
        """Promise of a body between walls, with particles that cross cells or with none; by default it is the same."""
        return Promise(cls.order)

    @staticmethod
    def corners(x: Floats, F: Floats, domain: Floats, dx: float) -> Floats | None:
        """Corners (P,4,2) of particles with these arrays, in the order of solver.layout.SIDES; None for points."""
        return None

    @staticmethod
    def refusal(F: Floats, domain: Floats, dx: float) -> Refusal:
        """Why the fill refuses a particle on the whole grid, and numbers; F (2,2) and domain (W,) are its own."""
        return FailureKind.OUTSIDE_GRID, {}

    @staticmethod
    def cut(F: Floats, domain: Floats, dx: float) -> NDArray[np.bool_]:
        """Whether a half diagonal is longer than the limit (P,)."""
        return np.zeros(len(F), dtype=bool)

    def limited(self, limit: float) -> "Basis":
        """The basis with half diagonals of domains no longer than `limit`, in cells, unless it has a limit."""
        return self

    @staticmethod
    def convect(particles: Particles, grid: Grid, dt: float) -> None:
        """Move what follows the grid's velocity without F."""


@kernel(inline=True)
def bilinear(k, K, b, x, y, weight, gx, gy, ny, table, node):
    """Four nodes k ... k+3 around the point (x, y), in cells: hat function S times weight, and S times (gx, gy)."""
    i = np.floor(x)
    j = np.floor(y)
    right = x - i
    above = y - j
    left = 1.0 - right
    below = 1.0 - above
    first = np.int64(i) * ny + np.int64(j)
    entry(k, K, b, first, left * below, weight, gx, gy, table, node)
    entry(k + 1, K, b, first + 1, left * above, weight, gx, gy, table, node)
    entry(k + 2, K, b, first + ny, right * below, weight, gx, gy, table, node)
    entry(k + 3, K, b, first + ny + 1, right * above, weight, gx, gy, table, node)


@kernel(inline=True)
def entry(k, K, b, number, S, weight, gx, gy, table, node):
    """One row of the table."""
    node[k * BLOCK + b] = number
    table[k * BLOCK + b] = weight * S
    table[(K + k) * BLOCK + b] = gx * S
    table[(2 * K + k) * BLOCK + b] = gy * S


@kernel(inline=True)
def outside(x0, x1, y0, y1, left, right, below, above):
    """How many of the four sides of the box are passed; a NaN passes each."""
    return int(not (left >= x0)) + int(not (right < x1)) + int(not (below >= y0)) + int(not (above < y1))
