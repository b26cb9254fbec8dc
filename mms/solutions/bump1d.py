"""Bump in the middle of a free bar, at rest and without stress at its ends: one dimension without walls.

    u = A sin(pi X / L)^4 (1 - cos w t),   w = pi C / L,   0 <= X <= L

in uniaxial strain, F = diag(1 + du/dX, 1, 1).
Boundary: the fourth power and its first derivative vanish at both ends, so there u = 0, F = 1 and P = 0: the ends are
free, and no wall is needed. The grid is longer than the body. At t = 0 the body is undeformed and at rest.
The duration 2 L / C is one period.
Source: the project's own, `bump` in one dimension.
What it cannot see: nothing of walls; it starts at rest, which hides wrong initial velocities; with A = 1e-6 no particle
crosses a cell, and all is linear in the strain.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mpm_verify.mms.bump import Bumped
from mpm_verify.mms.square import Line

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class Bump1d(Bumped, Line):
    """Bump in the middle of a free bar.

    Parameters
    ----------
    L
        Length of the bar, above zero.
    C
        Speed that sets the period, above zero.
    A
        Amplitude, a length, with which F cannot be singular: half the largest displacement.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (1,) of the reference position X and the time t."""
        import sympy as sp

        L = self.exact(self.L)
        angle = sp.pi * self.exact(self.C) * t / L
        return sp.Matrix([self.A * sp.sin(sp.pi * X[0] / L) ** 4 * (1 - sp.cos(angle))])
