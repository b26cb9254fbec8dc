"""Axis-aligned displacement in a square, paper eq. (5) (Sadeghirad, Brannon & Burghardt 2011).

    u_x = A sin(2 pi X / L) sin(C pi t / L + phase)
    u_y = A sin(2 pi Y / L) sin(C pi t / L + phase + pi)      on 0 <= X, Y <= L

Boundary: u_n = 0 on all four sides and P is diagonal, so rollers are consistent. The
duration 2 L / C is one period. A < L / (2 pi), or F is not invertible.
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
    """A: amplitude; L: side; C: speed that sets the period; phase: in radians."""

    A: float = 0.05
    phase: float = 0.0
    boundary: ClassVar[str] = "roller"

    def __post_init__(self) -> None:
        super().__post_init__()
        self.limit("A", self.A, self.L / 6.283185307179586)

    @property
    def amplitude(self) -> float:
        """A over the side."""
        return abs(self.A) / self.L

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """u of the reference place X and the time t."""
        import sympy as sp

        angle = self.exact(self.C) * sp.pi * t / self.exact(self.L) + self.exact(self.phase)
        wave = [sp.sin(2 * sp.pi * coordinate / self.exact(self.L)) for coordinate in X]
        return sp.Matrix([self.A * wave[0] * sp.sin(angle), self.A * wave[1] * sp.sin(angle + sp.pi)])
