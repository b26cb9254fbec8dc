"""Strain in a small part of a clamped square: a bump about the centre that goes round on a circle.

    u = A g (sin w t, 1 - cos w t) / 2,   g = [sin(pi X / L) sin(pi Y / L)]^n,   w = pi C / L, on 0 <= X, Y <= L

For large n, g is nearly a Gaussian of width L / (pi sqrt(n)); with n = 16 that is 0.08 L, and 90 % of the integral of
|F - I|^2 lies on a tenth of the area. F = I + d (x) grad g, so J = 1 + d . grad g, with d the motion of the centre.
Boundary: g = 0 on all four sides, so u = 0 and fixed walls. The duration 2 L / C is one period.
Source: the project's own, for layouts that are finer where strain is expected (Moormann, Giridharan & Stolle 2022,
end of section 2.1). F is full and not symmetric, and both 1 - cos (which starts with acceleration) and sin (which
starts with velocity) occur.
What it cannot see: next to nothing happens at the walls, so of them it sees only that nothing moves.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, sqrt
from typing import TYPE_CHECKING, ClassVar

from mpm_verify.mms.square import Square

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class Localised(Square):
    """Localised strain in a clamped square.

    Parameters
    ----------
    L
        Side of the square, above zero.
    C
        Speed that sets the period, above zero.
    A
        Diameter of the circle, a length, with which F cannot be singular; |grad g| is largest on the lines of symmetry.
    n
        Power, a whole number from 2 on.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    A: float = 0.04
    n: float = 16
    boundary: ClassVar[str] = "fixed"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (self.n >= 2 and float(self.n).is_integer()):
            raise ValueError(f"n = {self.n} must be a whole number, 2 or more")
        self.limit("A", self.A, self.L / (pi * sqrt(self.n) * (1 - 1 / self.n) ** ((self.n - 1) / 2)))

    @property
    def amplitude(self) -> float:
        """Diameter A over the side."""
        return abs(self.A) / self.L

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,) of the reference position X and the time t."""
        import sympy as sp

        angle = sp.pi * self.exact(self.C) * t / self.exact(self.L)
        x, y = (sp.sin(sp.pi * coordinate / self.exact(self.L)) for coordinate in X)
        bump = self.A * (x * y) ** int(self.n) / 2
        return sp.Matrix([bump * sp.sin(angle), bump * (1 - sp.cos(angle))])
