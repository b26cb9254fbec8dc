"""Standing wave on a bar that is held at both ends: one dimension, uniaxial strain F = diag(1 + du/dX, 1, 1).

    u = A sin(n pi X / L) sin(C pi t / L + phase),   0 <= X <= L

With F = 1 + du/dX, P = mu (F - 1/F) + lam ln F / F. The lateral stress is not told.
Boundary: u = 0 at both ends, which are fixed. At t = 0, with phase = 0, the body is undeformed and moves.
The duration 2 L / C is one period. A < L / (n pi), or F is not invertible.
Source: the uniaxial form of Wallstedt & Guilkey 2008; with a small A the standing wave on which one-dimensional
programs are tried. `bar` is the same on a square.
What it cannot see: one dimension has no shear and no rotation; with phase = 0 the motion starts without acceleration,
which hides a missing half-step start.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING, ClassVar

from mpm_verify.mms.square import Line

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class Bar1d(Line):
    """Standing wave on a bar in one dimension.

    Parameters
    ----------
    L
        Length of the bar, above zero.
    C
        Speed that sets the period, above zero.
    A
        Amplitude, a length, below L / (n pi) in size.
    n
        Half waves, a whole number from 1 on.
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
    phase: float = 0.0
    boundary: ClassVar[str] = "fixed"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (self.n >= 1 and float(self.n).is_integer()):
            raise ValueError(f"n = {self.n} must be a whole number of half waves, 1 or more")
        self.limit("A", self.A, self.L / (self.n * pi))

    @property
    def amplitude(self) -> float:
        """Amplitude over the length."""
        return abs(self.A) / self.L

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (1,) of the reference position X and the time t."""
        import sympy as sp

        L = self.exact(self.L)
        angle = self.exact(self.C) * sp.pi * t / L + self.exact(self.phase)
        return sp.Matrix([self.A * sp.sin(self.exact(self.n) * sp.pi * X[0] / L) * sp.sin(angle)])
