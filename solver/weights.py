"""Contract between bases and transfers: one table of weights for a block of particles, one signature to fill it.

The table of a basis with K support nodes a particle, for a block of BLOCK particles, is two flat arrays:

    node[k*B + b]              support node k of particle b, an index of grid arrays
    table[k*B + b]             N, its shape value
    table[(K + k)*B + b]       dN/dx
    table[(2*K + k)*B + b]     dN/dy

A fill sees the arrays of its block alone, flat: x[2*b + axis], F[4*b + 2*row + column], and domain[W*b + entry], W
numbers that the basis keeps of each particle's domain. Both layouts are there for the compiler: with fixed distances
between the streams, and as few arrays as this, it works on eight particles at once (five times faster than a table
[b, k]). So, in a fill: no branch, no division but the one needed, floor() for the cell.

A fill returns False, and its table is not used, if a support node lies outside `box` = (x0, x1, y0, y1), in cells from
the grid's origin. Comparisons are written so that a NaN lies outside. The walls of the grid stand PAD cells inside its
nx by ny nodes.
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
Fault = tuple[FailureKind, dict[str, float]]  # kind and numbers, see Failure
Position = Callable[[Floats], Floats]  # from reference positions (n,2) to positions (n,2)


@dataclass(frozen=True)
class Basis:
    """Weights of particles at nodes: data plus one kernel; the file in solver/basis is the name. This one knows points.

    Attributes
    ----------
    support
        Support nodes K of a particle.
    order
        Order of the displacement in dx while no particle crosses a cell; its source is in the module's docstring.
    fill
        Kernel of signature FILL.
    domain_size
        Numbers W that are kept of each particle's domain.
    domain_motion
        Motion of the domains, by which exact tests know them: ``fixed``, ``stretched`` by the diagonal of F alone, or
        ``deformed``, with the area J V0; empty of points, and of a basis that does not say.
    positive
        Whether shape values inside the grid are not negative.
    faces_carry
        Whether the field on a face of a domain is linear between its corners, so that forces on the edge of a body act
        through those; otherwise they act through points, see solver/surface.py.
    gradients_jump
        Whether gradients of weights jump where a particle crosses a cell.
    reference
        Whether weights are those of the reference positions (total Lagrangian), their gradients pushed forward by F.
    has_limit
        Whether half diagonals of domains can have a limit.
    limit
        That limit, in cells.
    """

    support: ClassVar[int]
    order: ClassVar[float]
    fill: ClassVar[Callable[..., bool]]
    domain_size: ClassVar[int] = 0
    domain_motion: ClassVar[str] = ""
    positive: ClassVar[bool] = True
    faces_carry: ClassVar[bool] = False
    gradients_jump: ClassVar[bool] = False
    reference: ClassVar[bool] = False
    has_limit: ClassVar[bool] = False
    limit = inf

    def domain(self, layout: Layout, position: Position) -> Floats:
        """Numbers (P,W) that the basis keeps of the domains; `position` takes reference positions to the start."""
        return np.zeros((len(layout), 0))

    def populate(self, layout: Layout, rho0: float, position: Position = lambda X: X) -> Particles:
        """Make particles at the reference positions of a layout.

        Parameters
        ----------
        layout
            Reference positions and domains of P particles.
        rho0
            Density at reference.
        position
            From reference positions (n,2) to those at the start (n,2): for domains with corners of their own.

        Returns
        -------
        Particles
            At rest and undeformed, x = X.
        """
        return Particles(layout.X, rho0 * layout.V0, layout.V0, self.domain(layout, position))

    def on_grid(self, particles: Particles) -> Floats:
        """Positions (P,2) at which particles are on the grid: x, or X where weights are those of the reference."""
        return particles.X if self.reference else particles.x

    @classmethod
    def promises(cls, crossing: bool) -> Promise:
        """Promise of how the error of a body between walls falls on refinement.

        Parameters
        ----------
        crossing
            Whether particles cross cells; by default that changes nothing.

        Returns
        -------
        Promise
            Judged against the observed order.
        """
        return Promise(cls.order)

    @staticmethod
    def corners(x: Floats, F: Floats, domain: Floats, dx: float) -> Floats | None:
        """Corners of the domains of particles.

        Parameters
        ----------
        x, F, domain
            Arrays of P particles, (P,2), (P,2,2), (P,W).
        dx
            Side of a cell.

        Returns
        -------
        ndarray or None
            Corners (P,4,2) in the order of solver.layout.SIDES; None for points.
        """
        return None

    @staticmethod
    def fault(F: Floats, domain: Floats, dx: float) -> Fault:
        """Fault for which the fill returns False for a particle with F (2,2) and domain (W,) on the whole grid."""
        return FailureKind.OUTSIDE_GRID, {}

    @staticmethod
    def cut(F: Floats, domain: Floats, dx: float) -> NDArray[np.bool_]:
        """Whether a half diagonal is longer than the limit (P,)."""
        return np.zeros(len(F), dtype=bool)

    def limited(self, limit: float) -> "Basis":
        """Basis with half diagonals of domains no longer than `limit`, in cells; itself if it has one or knows none."""
        return self

    @staticmethod
    def convect(particles: Particles, grid: Grid, dt: float) -> None:
        """Move what follows the grid's velocity without F, by a step of length dt."""


@kernel(inline=True)
def bilinear(k, K, b, x, y, weight, gx, gy, ny, table, node):
    """Write four nodes k ... k+3 around the point (x, y), in cells: hat function S times weight, and S (gx, gy)."""
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
    """Write one row of the table."""
    node[k * BLOCK + b] = number
    table[k * BLOCK + b] = weight * S
    table[(K + k) * BLOCK + b] = gx * S
    table[(2 * K + k) * BLOCK + b] = gy * S


@kernel(inline=True)
def outside(x0, x1, y0, y1, left, right, below, above):
    """Number of the four sides of the box that are passed; a NaN passes each."""
    return int(not (left >= x0)) + int(not (right < x1)) + int(not (below >= y0)) + int(not (above < y1))
