"""Bump in the middle of a free cube, at rest and without traction at its faces: three dimensions without walls.

    u = A (sin(pi X / L) sin(pi Y / L) sin(pi Z / L))^4 (1 - cos w t, 0.7 sin w t, 0.5 sin(w t / 2)),  w = pi C / L

on 0 <= X, Y, Z <= L. Boundary: the fourth power and its first derivatives vanish on all six faces, so there u = 0,
F = I and P = 0: the faces are free, and no wall is needed. The grid is wider than the body. At t = 0 the body is
undeformed: u = 0, F = I, sigma = 0. The duration 2 L / C is one period of the first two.
Source: the project's own, for solvers of three dimensions; the reference solver has two. Each component has a time of
its own, so that components which are exchanged show.
What it cannot see: nothing of walls; with A = 1e-6 no particle crosses a cell, and all is linear in the strain.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from mpm_verify.mms.bump import Bumped
from mpm_verify.mms.square import Cube

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class Bump3d(Bumped, Cube):
    """Bump in the middle of a free cube.

    Parameters
    ----------
    L
        Side of the cube, above zero.
    C
        Speed that sets the period, above zero.
    A
        Amplitude, a length, with which F cannot be singular: half the largest displacement.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    gradients: ClassVar[int] = 3

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (3,) of the reference position X and the time t."""
        import sympy as sp

        angle = sp.pi * self.exact(self.C) * t / self.exact(self.L)
        x, y, z = (sp.sin(sp.pi * coordinate / self.exact(self.L)) for coordinate in X)
        bump = self.A * (x * y * z) ** 4
        return sp.Matrix([
            bump * (1 - sp.cos(angle)), 0.7 * bump * sp.sin(angle), 0.5 * bump * sp.sin(angle / 2)
        ])  # fmt: skip
