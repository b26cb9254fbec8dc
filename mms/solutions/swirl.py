"""Rotation and change of volume together in a clamped square.

    u = h [(1 - cos w t) / 2 (Q(A) - I) + B sin w t I] (X - c),   w = pi C / L, c the centre, Q(A) rotation by A
    h = (1 - x^2)^2 (1 - y^2)^2,   x = 2 X / L - 1, y = 2 Y / L - 1,   on 0 <= X, Y <= L

So the centre is turned on a chord from I to Q(A), which shrinks it by cos(A/2) half-way, and scaled beside.
Boundary: h = 0 on all four sides, so u = 0 and fixed walls. The duration 2 L / C is one period.
Source: the project's own. With A = 0.9 and B = 0.1 the body turns by up to 52 degrees, J lies between 0.66 and 1.32,
the principal stretches between 0.59 and 1.60, and (F^T F)_xy reaches 0.88. F is full and not symmetric, and both
1 - cos (which starts with acceleration) and sin (which starts with velocity) occur. For |A| < 1.5 and |B| < 0.3,
det F > 0.26.
What it cannot see: grad h = 0 on the sides too, so F = I and the stress is zero there: of a wall it sees only that
nothing moves. The solution clamped_shear has stress at its walls.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin
from typing import TYPE_CHECKING, Any, ClassVar

from mpm_verify.mms.square import Square

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class Swirl(Square):
    """Rotation and change of volume in a clamped square.

    Parameters
    ----------
    L
        Side of the square, above zero.
    C
        Speed that sets the period, above zero.
    A
        Angle of the centre at half time, radians, below 1.5 in size.
    B
        Amplitude of its swelling, below 0.3 in size.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    A: float = 0.9
    B: float = 0.1
    boundary: ClassVar[str] = "fixed"

    def __post_init__(self) -> None:
        super().__post_init__()
        self.limit("A", self.A, 1.5)
        self.limit("B", self.B, 0.3)

    @property
    def amplitude(self) -> float:
        """Larger of the angle and the swelling."""
        return max(abs(self.A), abs(self.B))

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,) of the reference position X and the time t."""
        import sympy as sp

        L = self.exact(self.L)
        w_t = sp.pi * self.exact(self.C) * t / L
        half_way = L / 4 * (1 - sp.cos(w_t))
        swell = L / 2 * self.B * sp.sin(w_t) + (cos(self.A) - 1) * half_way
        turn = sin(self.A) * half_way
        x, y = (2 * coordinate / L - 1 for coordinate in X)
        right, up = odd(x) * even(y), even(x) * odd(y)
        return sp.Matrix([swell * right - turn * up, swell * up + turn * right])


def even(x: Any) -> Any:
    """Sum for (1 - x^2)^2: its derivatives stay one factor each, which keeps the generated kernel small."""
    return 1 - 2 * x**2 + x**4


def odd(x: Any) -> Any:
    """Sum for x (1 - x^2)^2."""
    return x - 2 * x**3 + x**5
