"""Cylinder in a smooth can: axisymmetric, from the axis to a wall, with smooth walls below and above.

    u_r = A X/L (1 - X^2/L^2) cos(pi Y / L) sin w t
    u_z = B cos(pi X / L) sin(pi Y / L) (1 - cos w t),   w = pi C / L

of the radius X and the height Y on 0 <= X, Y <= L. F has the components of the plane of X and Y, and around the axis
the hoop stretch 1 + u_r / X, in which no X is left: on the axis it is the radial stretch.
Boundary: on the axis and at X = L u_r = 0, at Y = 0 and Y = L u_z = 0, and on all four F is diagonal, so no shear
traction: rollers on all four, the axis among them.
At t = 0 the body is undeformed; it starts with velocity in r and with acceleration in z. The duration 2 L / C is one
period of both.
Source: the project's own, for axisymmetric solvers; the reference solver is in plane strain.
What it cannot see: free edges; A and B small leave no particle that crosses a cell, and all is linear in the strain.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING, ClassVar

from mpm_verify.mms.square import Revolved

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class CylinderRz(Revolved):
    """Cylinder in a smooth can, axisymmetric.

    Parameters
    ----------
    L
        Radius and height, above zero.
    C
        Speed that sets the period, above zero.
    A, B
        Amplitudes in r and z, lengths, with which F cannot be singular.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    A: float = 0.1
    B: float = 0.04
    boundary: ClassVar[str] = "roller"

    def __post_init__(self) -> None:
        super().__post_init__()
        self.limit("A", self.A, self.L / (2 + pi * 2 / 27**0.5))  # sums of the rows of F - I stay below 1
        self.limit("B", self.B, self.L / (2 * pi))

    @property
    def amplitude(self) -> float:
        """Larger amplitude over the height."""
        return max(abs(self.A), abs(self.B)) / self.L

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,), in r and z, of the radius and height X and the time t."""
        import sympy as sp

        L = self.exact(self.L)
        r, z, angle = X[0] / L, sp.pi * X[1] / L, sp.pi * self.exact(self.C) * t / L
        return sp.Matrix([
            self.A * r * (1 - r**2) * sp.cos(z) * sp.sin(angle),
            self.B * sp.cos(sp.pi * r) * sp.sin(z) * (1 - sp.cos(angle)),
        ])  # fmt: skip
