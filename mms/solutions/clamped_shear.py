"""Shear and stretch in a clamped square, with different wave numbers and phases in x and y.

    u_x = G sin(pi X / L) sin(pi Y / L) (1 - cos w t)
    u_y = 0.7 G sin(2 pi X / L) sin(pi Y / L) sin w t,       w = pi C / L, on 0 <= X, Y <= L

Boundary: u = 0 on all four sides, so fixed walls. F is full and not symmetric, J varies, and both 1 - cos (which starts
with acceleration) and sin (which starts with velocity) occur: what axis_aligned cannot see, this one does.
Source: the project's own. The bound on G keeps the displacement gradient below one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from mpm_verify.mms.square import Square

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class ClampedShear(Square):
    """Shear and stretch in a clamped square.

    Parameters
    ----------
    L
        Side of the square, above zero.
    C
        Speed that sets the period, above zero.
    G
        Amplitude, a length, below L / (2 pi) in size.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    G: float = 0.05
    boundary: ClassVar[str] = "fixed"

    def __post_init__(self) -> None:
        super().__post_init__()
        self.limit("G", self.G, self.L / 6.283185307179586)

    @property
    def amplitude(self) -> float:
        """Amplitude G over the side."""
        return abs(self.G) / self.L

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,) of the reference position X and the time t."""
        import sympy as sp

        x, y = (sp.pi * coordinate / self.exact(self.L) for coordinate in X)
        angle = sp.pi * self.exact(self.C) * t / self.exact(self.L)
        shear = self.G * sp.sin(x) * sp.sin(y) * (1 - sp.cos(angle))
        return sp.Matrix([shear, 0.7 * self.G * sp.sin(2 * x) * sp.sin(y) * sp.sin(angle)])
