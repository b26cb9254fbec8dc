"""Standing wave in a bar: uniaxial strain of large amplitude, in the direction x or y of a square.

    u = A sin(n pi X / L) sin(C pi t / L + phase)      in that direction, on 0 <= X <= L; none in the other

With F = 1 + du/dX, P = mu (F - 1/F) + lam ln F / F, and

    b = -(C pi / L)^2 u + (n pi / L)^2 u / rho0 [mu + (mu + lam (1 - ln F)) / F^2]

Boundary: u = 0 at both ends and P is diagonal, so rollers on all four sides.
The duration 2 L / C is one period. A < L / (n pi), or F is not invertible.
Source: the uniaxial form of Wallstedt & Guilkey 2008. With A = 0.1 and n = 1, F lies between 0.69 and 1.31, and on 64
cells the middle moves by 6 of them to each side.
What it cannot see: all that the other direction does; F is diagonal, so shear, rotation and transposes; with phase = 0
the motion starts without acceleration, which hides a missing half-step start.
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
    """Standing wave in a bar.

    Parameters
    ----------
    L
        Side of the square, above zero.
    C
        Speed that sets the period, above zero.
    A
        Amplitude, a length, below L / (n pi) in size.
    n
        Half waves, a whole number from 1 on.
    axis
        Direction, 0 for x or 1 for y.
    phase
        Phase at t = 0, radians.

    Raises
    ------
    ValueError
        For a parameter that is out of range.

    References
    ----------
    Wallstedt & Guilkey 2008, doi:10.1016/j.jcp.2008.07.019.
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
        """Amplitude over the side."""
        return abs(self.A) / self.L

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,) of the reference position X and the time t."""
        import sympy as sp

        axis, L = int(self.axis), self.exact(self.L)
        angle = self.exact(self.C) * sp.pi * t / L + self.exact(self.phase)
        u = sp.zeros(2, 1)
        u[axis] = self.A * sp.sin(self.exact(self.n) * sp.pi * X[axis] / L) * sp.sin(angle)
        return u
