"""Rotation about a skew axis and change of shape in a free cube: all nine components of F, undeformed at t = 0.

    u = h [(1 - cos w t) / 2 (Q - I) + B sin w t diag(1, -1/2, 3/4)] (X - c),   w = pi C / L, c the centre
    h = (1 - x^2)^3 (1 - y^2)^3 (1 - z^2)^3,   x = 2 X / L - 1 and so on,   on 0 <= X, Y, Z <= L
    Q = I + sin A K + (1 - cos A) K^2, the rotation by A about n = (1, 2, 2) / 3, where K a = n x a

Boundary: h and its first two derivatives vanish on all six faces, so there u = 0, F = I, P = 0 and Div P = 0: the faces
are free, and no wall is needed. The grid is wider than the body. At t = 0 the body is undeformed: u = 0, F = I,
sigma = 0. The duration 2 L / C is one period.
Source: the project's own, for solvers of three dimensions; the reference solver has two. F is full and not symmetric,
F and its rate do not commute, and both 1 - cos (which starts with acceleration) and sin (which starts with velocity)
occur: defects of shear and of rotation show. For |A| < 1.5 and |B| < 0.3, det F > 0.3.
What it cannot see: walls. Classical MPM does not converge where particles cross cells: with it take A=1e-6,B=1e-6.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin
from typing import TYPE_CHECKING, Any, ClassVar

from mpm_verify.mms.square import Cube

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class Swirl3d(Cube):
    """Rotation about a skew axis and change of shape in a free cube.

    Parameters
    ----------
    L
        Side of the cube, above zero.
    C
        Speed that sets the period, above zero.
    A
        Angle of the centre at half time, radians, below 1.5 in size.
    B
        Amplitude of its change of shape, below 0.3 in size.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    A: float = 0.6
    B: float = 0.1
    boundary: ClassVar[str] = "free"

    def __post_init__(self) -> None:
        super().__post_init__()
        self.limit("A", self.A, 1.5)
        self.limit("B", self.B, 0.3)

    @property
    def margin(self) -> float:
        """Distance by which the grid is wider than the body: one cell where four cover it."""
        return 0.25 * self.L

    @property
    def amplitude(self) -> float:
        """Larger of the angle and the change of shape."""
        return max(abs(self.A), abs(self.B))

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (3,) of the reference position X and the time t."""
        import sympy as sp

        L = self.exact(self.L)
        w_t = sp.pi * self.exact(self.C) * t / L
        half_way, beside = L / 4 * (1 - sp.cos(w_t)), L / 2 * self.B * sp.sin(w_t)
        K = sp.Matrix([[0, -2, 2], [2, 0, -1], [-2, 1, 0]]) / 3
        shape = sp.diag(1, -sp.S.Half, sp.Rational(3, 4))
        M = (sin(self.A) * K + (1 - cos(self.A)) * K * K) * half_way + shape * beside
        x, y, z = (2 * coordinate / L - 1 for coordinate in X)
        around = sp.Matrix([odd(x) * even(y) * even(z), even(x) * odd(y) * even(z), even(x) * even(y) * odd(z)])
        return M * around


def even(x: Any) -> Any:
    """Sum for (1 - x^2)^3: its derivatives stay one factor each, which keeps the exported force small."""
    return 1 - 3 * x**2 + 3 * x**4 - x**6


def odd(x: Any) -> Any:
    """Sum for x (1 - x^2)^3."""
    return x - 3 * x**3 + 3 * x**5 - x**7
