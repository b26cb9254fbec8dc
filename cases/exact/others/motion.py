"""Motion of a free body with a uniform F, which an explicit step follows exactly: a solution as the export takes one.

    x = c + (F0 + t M + t^2/2 A) (X - c) + t V + t^2/2 G + t^3/6 J,   c the middle of the body

F is uniform, so there is no divergence of the stress, and b = A (X - c) + G + t J. At t = 0 the particles are a lattice
on the grid, symmetric about each node. Then sum m N (x_p - x_i) = 0 and sum V dN = 0 hold at each node inside, for any
shape functions that are those of the next node, shifted: nodes have the velocity and the acceleration of x_i, and one
step takes F to (1 + dt grad v) F and keeps it uniform, with FLIP, PIC and APIC. That ends with the first step where F
changes; where it does not, it holds for any number of steps.

Leapfrog, v half a step before x, follows t and t^2 exactly, and v too with J; x is then t J dt^2 / 24 short.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mpm_verify.solver.layout import Layout, rectangle
from mpm_verify.solver.state import Floats

if TYPE_CHECKING:
    import sympy as sp

COURANT = 0.3
AROUND = 5  # cells of the grid around the body
DEEP = 8  # cells from its sides to the particles that the sides do not reach in a step
Matrix = tuple[tuple[float, float], tuple[float, float]]
Vector = tuple[float, float]
UNIT: Matrix = ((1.0, 0.0), (0.0, 1.0))
NONE: Matrix = ((0.0, 0.0), (0.0, 0.0))
STILL: Vector = (0.0, 0.0)


@dataclass(frozen=True)
class Motion:
    """Uniform motion in so many steps.

    Parameters
    ----------
    F, M, A
        F0, M dt and A dt^2: without unit.
    V, G, J
        V, G dt and J dt^2 over the speed C.
    cells
        Cells of the body in x and y.
    steps, C
        Number of steps, and the speed that sets dt = courant dx / C.
    """

    F: Matrix = UNIT
    M: Matrix = NONE
    A: Matrix = NONE
    V: Vector = STILL
    G: Vector = STILL
    J: Vector = STILL
    cells: tuple[int, int] = (20, 20)
    steps: int = 1
    C: float = 1.0
    boundary: ClassVar[str] = "free"

    @property
    def dx(self) -> float:
        """Side of a cell, a length; the body is 1 wide."""
        return 1.0 / self.cells[0]

    @property
    def dt(self) -> float:
        """Length of a step."""
        return COURANT * self.dx / self.C

    @property
    def duration(self) -> float:
        """Time of all steps."""
        return self.steps * self.dt

    @property
    def lower(self) -> Floats:
        """Lower corner (2,) of the body at t = 0."""
        return np.zeros(2)

    @property
    def upper(self) -> Floats:
        """Upper corner (2,) of the body at t = 0."""
        return np.array([1.0, self.cells[1] * self.dx])

    @property
    def middle(self) -> Floats:
        """Middle c (2,) of the body."""
        return 0.5 * self.upper

    @property
    def margin(self) -> float:
        """Distance by which the grid is wider than the body."""
        return (AROUND - 0.5) * self.dx

    @property
    def rates(self) -> tuple[Floats, Floats, Floats]:
        """Rates of F: F0, M and A, (2,2)."""
        return np.array(self.F), np.array(self.M) / self.dt, np.array(self.A) / self.dt**2

    @property
    def drifts(self) -> tuple[Floats, Floats, Floats]:
        """Velocity V, acceleration G and its rate J, (2,)."""
        return self.C * np.array(self.V), self.C / self.dt * np.array(self.G), self.C / self.dt**2 * np.array(self.J)

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,) of the reference position X and the time t."""
        import sympy as sp

        F, M, A = (sp.Matrix(one.tolist()) for one in self.rates)
        V, G, J = (sp.Matrix(one.tolist()) for one in self.drifts)
        away = sp.Matrix(list(X)) - sp.Matrix(self.middle.tolist())
        return (F + t * M + t**2 * A / 2 - sp.eye(2)) * away + t * V + t**2 * G / 2 + t**3 * J / 6

    def layout(self, dx: float, ppc: int) -> Layout:
        """Layout that F0 makes a regular lattice of."""
        there = rectangle(self.lower, self.upper, dx, ppc)
        inverse = np.linalg.inv(np.array(self.F))
        X = self.middle + (there.X - self.middle) @ inverse.T
        return Layout(X, there.V0 * np.linalg.det(inverse), there.r0 @ inverse.T)

    def b(self, X: Floats, t: float) -> Floats:
        """Body force per mass (n,2) at reference positions X (n,2)."""
        _, G, J = self.drifts
        found: Floats = (X - self.middle) @ self.rates[2].T + G + t * J
        return found

    def x(self, X: Floats, t: float, short: bool = False) -> Floats:
        """Positions (n,2); as leapfrog has them where they are `short`."""
        (V, G, J), F = self.drifts, self.F_at(t)
        less = t * self.dt**2 / 24 if short else 0.0
        found: Floats = self.middle + (X - self.middle) @ F.T + t * V + t**2 / 2 * G + (t**3 / 6 - less) * J
        return found

    def v(self, X: Floats, t: float) -> Floats:
        """Velocities (n,2)."""
        (_, M, A), (V, G, J) = self.rates, self.drifts
        found: Floats = (X - self.middle) @ (M + t * A).T + V + t * G + t**2 / 2 * J
        return found

    def F_at(self, t: float) -> Floats:
        """Deformation gradient (2,2)."""
        F, M, A = self.rates
        found: Floats = F + t * M + t**2 / 2 * A
        return found

    def F_written(self, t: float, lag: float) -> Floats | None:
        """Deformation gradient (2,2) of an answer at t whose F is 0 or 1 steps behind; None of any other.

        One step behind, F is advanced from -dt by the velocity at the nodes before the force acts.
        """
        F, M, A = self.rates
        if lag == 0:
            return self.F_at(t)
        if lag != 1:
            return None
        L = (M - self.dt / 2 * A) @ np.linalg.inv(F)
        found: Floats = self.F_at(-self.dt) + self.dt * L @ self.F_at(-self.dt)
        return found

    @property
    def bends(self) -> bool:
        """Whether the acceleration differs from particle to particle."""
        return bool(np.any(self.A))

    @property
    def grows(self) -> bool:
        """Whether the force grows in time."""
        return bool(np.any(self.J))

    def compared(self, X: Floats) -> Any:
        """Which particles are judged: all where F stays as it is and is not strained; else those deep inside."""
        if self.F == UNIT and self.M == self.A == NONE:
            return np.ones(len(X), dtype=bool)
        return self.deep(self.x(X, 0.0))

    def deep(self, x: Floats) -> Any:
        """Which positions (n,2) are so deep inside that the sides do not reach them in a step."""
        room = DEEP * self.dx
        return ((x > self.lower + room) & (x < self.upper - room)).all(axis=1)
