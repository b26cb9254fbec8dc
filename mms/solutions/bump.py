"""Bump in the middle of a free square, at rest and without traction at its edges: a study without walls.

    u = A (sin(pi X / L) sin(pi Y / L))^4 (1 - cos w t, 0.7 sin w t),   w = pi C / L, on 0 <= X, Y <= L

Boundary: the fourth power and its first derivatives vanish on all four sides, so there u = 0, F = I and P = 0: the
edges are free, and no wall is needed. The grid is wider than the body. The duration 2 L / C is one period.
Source: the project's own. It separates walls from the interior: a code that has order 2 here and not in
clamped_shear is wrong at its walls. Both 1 - cos (which starts with acceleration) and sin (which starts with velocity)
occur, and F is full and not symmetric.
What it cannot see: nothing of walls; with A = 1e-6 no particle crosses a cell, and all is linear in the strain.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from mpm_verify.mms.bump import Bumped

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class Bump(Bumped):
    """Bump in the middle of a free square.

    Parameters
    ----------
    L
        Side of the square, above zero.
    C
        Speed that sets the period, above zero.
    A
        Amplitude, a length, with which F cannot be singular: half the largest displacement.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    in_single: ClassVar[dict[str, float]] = {"A": 1e-3}  # for solvers in single precision, whose rounding is above 1e-6

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,) of the reference position X and the time t."""
        import sympy as sp

        angle = sp.pi * self.exact(self.C) * t / self.exact(self.L)
        x, y = (sp.sin(sp.pi * coordinate / self.exact(self.L)) for coordinate in X)
        bump = self.A * (x * y) ** 4
        return sp.Matrix([bump * (1 - sp.cos(angle)), 0.7 * bump * sp.sin(angle)])
