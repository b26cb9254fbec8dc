"""Axis-aligned displacement in a square, paper eq. (5) (Sadeghirad, Brannon & Burghardt 2011).

    u_x = A sin(2 pi X / L) sin(C pi t / L + phase)
    u_y = A sin(2 pi Y / L) sin(C pi t / L + phase + pi)      on 0 <= X, Y <= L

Boundary: u_n = 0 on all four sides and P is diagonal, so rollers are consistent. The duration 2 L / C is one period.
A < L / (2 pi), or F is not invertible.
What it cannot see: F is diagonal, so shear, rotation and transposes are invisible; with phase = 0 the motion starts
without acceleration, which hides a missing half-step start.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from mpm_verify.mms.square import Square

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class AxisAligned(Square):
    """Axis-aligned displacement.

    Parameters
    ----------
    L
        Side of the square, above zero.
    C
        Speed that sets the period, above zero.
    A
        Amplitude, a length, below L / (2 pi) in size.
    phase
        Phase at t = 0, radians.

    Raises
    ------
    ValueError
        For a parameter that is out of range.

    References
    ----------
    Sadeghirad, Brannon & Burghardt 2011, doi:10.1002/nme.3110.
    """

    A: float = 0.05
    phase: float = 0.0
    boundary: ClassVar[str] = "roller"

    def __post_init__(self) -> None:
        super().__post_init__()
        self.limit("A", self.A, self.L / 6.283185307179586)

    @property
    def amplitude(self) -> float:
        """Amplitude over the side."""
        return abs(self.A) / self.L

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,) of the reference position X and the time t."""
        import sympy as sp

        angle = self.exact(self.C) * sp.pi * t / self.exact(self.L) + self.exact(self.phase)
        wave = [sp.sin(2 * sp.pi * coordinate / self.exact(self.L)) for coordinate in X]
        return sp.Matrix([self.A * wave[0] * sp.sin(angle), self.A * wave[1] * sp.sin(angle + sp.pi)])
