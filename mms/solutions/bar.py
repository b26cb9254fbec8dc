"""Standing wave in a bar: uniaxial strain of large amplitude, along one axis of a square.

    u = A sin(n pi X / L) sin(C pi t / L + phase)      along the axis, on 0 <= X <= L; none across it

With F = 1 + du/dX, P = mu (F - 1/F) + lam ln F / F, and

    b = -(C pi / L)^2 u + (n pi / L)^2 u / rho0 [mu + (mu + lam (1 - ln F)) / F^2]

Boundary: u = 0 at both ends and P is diagonal, so rollers on all four sides.
The duration 2 L / C is one period. A < L / (n pi), or F is not invertible.
Source: the uniaxial form of Wallstedt & Guilkey, J. Comput. Phys. 227 (2008) 9628. With A = 0.1 and n = 1, F lies
between 0.69 and 1.31, and on 64 cells the middle moves by 6 of them to each side.
What it cannot see: all that the other axis does; F is diagonal, so shear, rotation and transposes; with phase = 0 the
motion starts without acceleration, which hides a missing half-step start.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING, ClassVar

from mpm_verify.mms.square import Square

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class Bar(Square):
    """A: amplitude; n: half waves, a whole number; axis: 0 for x, 1 for y; phase: in radians; L: side; C: speed.

    Raises ValueError for an amplitude, a number of half waves or an axis that is not allowed.
    """

    A: float = 0.1
    n: float = 1
    axis: float = 0
    phase: float = 0.0
    boundary: ClassVar[str] = "roller"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (self.n >= 1 and float(self.n).is_integer()):
            raise ValueError(f"n = {self.n} must be a whole number of half waves, 1 or more")
        if self.axis not in (0, 1):
            raise ValueError(f"axis = {self.axis} must be 0 for x or 1 for y")
        self.limit("A", self.A, self.L / (self.n * pi))

    @property
    def amplitude(self) -> float:
        """A over the side."""
        return abs(self.A) / self.L

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """u of the reference place X and the time t."""
        import sympy as sp

        axis, L = int(self.axis), self.exact(self.L)
        angle = self.exact(self.C) * sp.pi * t / L + self.exact(self.phase)
        u = sp.zeros(2, 1)
        u[axis] = self.A * sp.sin(self.exact(self.n) * sp.pi * X[axis] / L) * sp.sin(angle)
        return u
