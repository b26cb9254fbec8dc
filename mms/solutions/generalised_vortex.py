"""Generalised vortex: rings turn back and forth about the origin by an angle that depends on the radius.

    x = Q(alpha) X,   alpha = A sin(pi rate t) h(R),   h = (1 - s^2)^2,   s = (2 R - inner - outer) / (outer - inner)

on inner <= R <= outer, Q(alpha) the rotation by alpha. With radii 3/4 and 5/4, h = 1 - 32 (R - 1)^2 + 256 (R - 1)^4.
J = 1 everywhere. With g = R alpha', P = mu g (e_r x E_Theta + e_theta x E_R), e at the angle Theta + alpha, and

    b_r = R (mu alpha'^2 / rho0 - alpha_t^2),   b_theta = R alpha_tt - mu (3 alpha' + R alpha'') / rho0

Boundary: h and h' vanish at both radii, so there nothing moves and the traction is zero: the edges are free, no wall is
needed. Source: Brannon, Kamojjala & Sadeghirad, Particles 2011, where `rate` is c, with E = 1000, nu = 0.3,
rho0 = 1000, A = 1; duration 1, as in Uintah's input for it: out to 57 degrees at half time, and back.
The shear g reaches 7.1 A: stretches of 7.2 and 0.14 for A = 1, the hardest problem for a particle domain.
The acceleration at t = 0 is the centripetal one, so a missing half-step start is seen.
What it cannot see: J = 1, so nothing of lam, of pressure or of volume; stress vanishes at t = 0; the edges rest, so
free surfaces that move take no part.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from mpm_verify.mms.annulus import Annulus
from mpm_verify.mms.square import Square

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class GeneralisedVortex(Annulus):
    """Generalised vortex.

    The fastest are the shear wave in the direction of the longest stretch, 7.2 sqrt(mu / rho0) = 4.4, and the
    particles, 3.1: with C = 5 and a Courant number of 0.4, both together pass 0.6 of a cell in a step. Larger A or rate
    need a larger C.

    Parameters
    ----------
    inner, outer
        Radii of the body, 0 < inner < outer.
    C
        Reference speed of dt alone, above zero.
    A
        Largest angle, radians, below 2 in size: there stretches exceed 14.
    rate
        Half turns of the sine per unit of time, above zero.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    C: float = 5.0
    A: float = 1.0
    rate: float = 1.0
    material: ClassVar[str] = "neo_hookean:E=1000,rho0=1000"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.rate > 0:
            raise ValueError(f"rate = {self.rate} must be above zero")
        if not abs(self.A) < 2:
            raise ValueError(f"A = {self.A} must be below 2 in size")

    @property
    def duration(self) -> float:
        """Time of half a period of the sine: out and back."""
        return 1 / self.rate

    @property
    def period(self) -> float:
        """Time of a whole period: out to both sides."""
        return 2 / self.rate

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,) of the reference position X and the time t."""
        import sympy as sp

        s = (2 * sp.sqrt(X[0] ** 2 + X[1] ** 2) - Square.exact(self.inner + self.outer)) / Square.exact(self.L)
        angle = self.A * sp.sin(sp.pi * Square.exact(self.rate) * t) * (1 - 2 * s**2 + s**4)
        return sp.Matrix([[sp.cos(angle) - 1, -sp.sin(angle)], [sp.sin(angle), sp.cos(angle) - 1]]) * sp.Matrix(list(X))
