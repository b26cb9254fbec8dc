"""Expanding ring: radial motion with free edges that move.

    u = A sin(C pi t / (inner + outer)) (c3 R^2 + c2 R + c1) X,   on inner <= R <= outer,
    c1 = -6 inner / q,   c2 = 3 (inner + outer) / (outer q),   c3 = -2 / (outer q),   q = outer (outer - 3 inner)

so that u_R(outer) = A sin(.) and du_R/dR is a multiple of (R - inner) (R - outer).
Boundary: at both radii F_RR = 1, so P_RR = lam ln F_TT, with F_TT the hoop stretch: the edges are free of traction for
nu = 0 alone, where lam = 0. With another nu the body force still balances momentum inside, but the missing traction
drives a wave from the edges, and a study does not converge.
Source: Wallstedt & Guilkey 2008: inner = 0.4, outer = 0.6, A = 0.1, E = 1e7, nu = 0, rho0 = 1000. The duration
2 (inner + outer) / C is one period, in and out (0.02 s there).
What it cannot see: nu = 0, so nothing of lam; F is symmetric, so a transpose and rotation are invisible, though shear
in the axes of the grid is not; acceleration and stress vanish at t = 0, which hides a missing half-step start.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from mpm_verify.mms.annulus import Annulus
from mpm_verify.mms.square import Square

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class ExpandingRing(Annulus):
    """Expanding ring.

    Parameters
    ----------
    inner, outer
        Radii of the body, 0 < inner < outer < 3 inner.
    C
        Speed that sets the period, above zero; the wave speed sqrt(E / rho0) of the source's material, too.
    A
        Amplitude at the outer edge, a length, with which no stretch vanishes.

    Raises
    ------
    ValueError
        For a parameter that is out of range.

    References
    ----------
    Wallstedt & Guilkey 2008, doi:10.1016/j.jcp.2008.07.019.
    """

    inner: float = 0.4
    outer: float = 0.6
    C: float = 100.0
    A: float = 0.1
    material: ClassVar[str] = "neo_hookean:E=1e7,nu=0,rho0=1000"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.outer < 3 * self.inner:
            raise ValueError(f"outer = {self.outer} must be below 3 inner = {3 * self.inner:.4g}")
        c1, c2, c3 = self.coefficients()
        middle = (self.inner + self.outer) / 2
        hoop = c3 * self.inner**2 + c2 * self.inner + c1  # falls outwards
        radial = 3 * c3 * middle**2 + 2 * c2 * middle + c1
        Square.limit("A", self.A, 1 / max(abs(hoop), abs(radial)))

    def coefficients(self) -> tuple[float, float, float]:
        """Coefficients c1, c2 and c3."""
        q = self.outer * (self.outer - 3 * self.inner)
        return -6 * self.inner / q, 3 * (self.inner + self.outer) / (self.outer * q), -2 / (self.outer * q)

    @property
    def margin(self) -> float:
        """Room around the ring: the outer edge moves by A, and the inner one never passes it."""
        return super().margin + abs(self.A)

    @property
    def duration(self) -> float:
        """Time of one period."""
        return 2 * (self.inner + self.outer) / self.C

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,) of the reference position X and the time t."""
        import sympy as sp

        c1, c2, c3 = self.coefficients()
        R = sp.sqrt(X[0] ** 2 + X[1] ** 2)
        angle = sp.pi * Square.exact(self.C) * t / Square.exact(self.inner + self.outer)
        return self.A * sp.sin(angle) * (c3 * R**2 + c2 * R + c1) * sp.Matrix(list(X))
