"""Bump in the middle of a free ring of square section, away from its axis: axisymmetric without walls.

    u = A (sin(pi (X - bore) / L) sin(pi Y / L))^4 (1 - cos w t, 0.7 sin w t),   w = pi C / L

in r and z, of the radius X and the height Y on bore <= X <= bore + L, 0 <= Y <= L.
Boundary: the fourth power and its first derivatives vanish on all four edges of the section, so there u = 0, F = I and
P = 0: the edges are free, and no wall is needed. The grid is wider than the section, and ends before the axis.
At t = 0 the body is undeformed. The duration 2 L / C is one period.
Source: the project's own, `bump` around an axis, for axisymmetric solvers; the reference solver is in plane strain.
What it cannot see: nothing of walls, nor of the axis; with A = 1e-6 no particle crosses a cell, and all is linear in
the strain; with a wide bore the hoop terms are small.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from mpm_verify.mms.bump import Bumped
from mpm_verify.mms.square import Revolved
from mpm_verify.solver.state import Floats

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class BumpRz(Bumped, Revolved):
    """Bump in the middle of a free ring of square section.

    Parameters
    ----------
    L
        Side of the section, above zero.
    C
        Speed that sets the period, above zero.
    A
        Amplitude, a length, with which F cannot be singular: half the largest displacement.
    bore
        Inner radius, at least half of L: the grid is wider than the section.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    bore: float = 0.5
    gradients: ClassVar[int] = 4

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.5 * self.L <= self.bore < 1e6 * self.L:
            raise ValueError(f"bore = {self.bore} must be half of L = {self.L} at least, so that the grid has room")

    @property
    def lower(self) -> Floats:
        """Lower corner of the section, radius and height, (2,)."""
        return np.array([self.bore, 0.0])

    @property
    def upper(self) -> Floats:
        """Upper corner of the section, radius and height, (2,)."""
        return np.array([self.bore + self.L, self.L])

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,), in r and z, of the radius and height X and the time t."""
        import sympy as sp

        L = self.exact(self.L)
        x, y = (sp.sin(sp.pi * along / L) for along in (X[0] - self.exact(self.bore), X[1]))
        bump, angle = self.A * (x * y) ** 4, sp.pi * self.exact(self.C) * t / L
        return sp.Matrix([bump * (1 - sp.cos(angle)), 0.7 * bump * sp.sin(angle)])
