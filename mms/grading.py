"""Faces between particles, closer where strain is expected.

The exact motion says beforehand how much each position will be strained. In each direction the particles per length
follow

    n(X) ~ 1 + (contrast - 1) [e(X) / max e]^power,   e(X) = max over time and the other axis of |F^T F - I| / 2

and faces lie so that each domain holds the same part of the integral of n: de Boor's equidistribution (1973, "Good
approximation by splines with variable knots"). The strain of Green and Lagrange does not count rotation. The layout is
a tensor product: what is strained is covered in both directions, and so are its shadows. With a power of 1/2 or more,
domains change size where stress still varies; midpoint sums of stress and of body force then no longer cancel, and that
costs CPDI more than it gains. The usual 1/4 spreads the fine part further out: measured with 1 to 4 particles in a
cell, 64 cells and the solution localised, the error of u is a fifth lower than with 1/2.
Suggested in Moormann, Giridharan & Stolle 2022, end of section 2.1.
"""

from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np

from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.layout import Layout, Offset, graded, per_side
from mpm_verify.solver.state import Floats

POINTS, TIMES = 96, 33  # sampled in a direction and in time


@dataclass(frozen=True)
class Grading:
    """Grading of particles by the strain that is expected; subclasses are layouts.

    Parameters
    ----------
    contrast
        Particles per length where strain is largest, over those where there is none, from 1 to 8.
    power
        Exponent in the formula of the module, above 0 and up to 4.

    Raises
    ------
    ValueError
        For another contrast or power.
    """

    contrast: float = 2.0
    power: float = 0.25

    def __post_init__(self) -> None:
        if not 1 <= self.contrast <= 8:
            raise ValueError(f"contrast = {self.contrast:g} must be from 1, as uniform, to 8")
        if not 0 < self.power <= 4:
            raise ValueError(f"power = {self.power:g} must be above 0 and 4 at most; 0.25 is usual")

    def check(self, solution: Any) -> None:
        """Raise ValueError unless the body is a rectangle with sides in x and y."""
        size = solution.upper - solution.lower
        layout = solution.layout(float(size[0]) / 8, 1)
        if layout.bent is not None or not np.isclose(layout.V0.sum(), size.prod()):
            raise ValueError("graded layouts are for bodies that are rectangles with sides in x and y; choose uniform")

    def crowding(self, strain: Floats, most: float) -> Floats:
        """Density n(X) over its largest possible value, (n,), from 1 / contrast to 1."""
        shape = (strain / most) ** self.power if most > 0 else np.ones_like(strain)
        crowded: Floats = (1 + (self.contrast - 1) * shape) / self.contrast
        return crowded

    def lay(self, solution: Any, exact: Manufactured, dx: float, ppc: int, offset: Offset, *, fewer: bool) -> Layout:
        """Layout of rectangles between graded faces.

        Parameters
        ----------
        solution, exact
            Solution, and its fields.
        dx
            Side of a grid cell.
        ppc
            Particles in a cell, a square number: their mean, or with `fewer` those where e is largest.
        offset
            Shift of the faces in x and y, as fractions of their spacing.
        fewer
            Whether there are fewer particles than in a uniform layout.

        Returns
        -------
        Layout
            Rectangular domains.

        Raises
        ------
        ValueError
            For a body that is not a rectangle.
        """
        self.check(solution)
        strains = expected_strain(exact, solution)
        most, edges = max(float(s.max()) for s in strains), []
        for axis, strain in enumerate(strains):
            n = self.crowding(strain, most)
            whole = (solution.upper[axis] - solution.lower[axis]) / dx * per_side(ppc)
            count = ceil(whole * n.mean() - 1e-9) if fewer else round(whole)
            edges.append(equidistributed(n, solution.lower[axis], solution.upper[axis], count, offset[axis]))
        return graded(edges)


def expected_strain(exact: Manufactured, solution: Any) -> tuple[Floats, Floats]:
    """Strain e (n,) at even positions in x and in y, of a rectangle with sides in x and y."""
    layout = solution.layout(float(solution.upper[0] - solution.lower[0]) / POINTS, 1)
    strain = np.zeros(len(layout))
    for t in np.linspace(0.0, solution.duration, TIMES):
        F = exact.F(layout.X, float(t))
        E = 0.5 * (F.swapaxes(-1, -2) @ F - np.eye(2))
        strain = np.maximum(strain, np.sqrt((E**2).sum(axis=(1, 2))))
    field = strain.reshape(POINTS, -1)  # layouts go column by column
    return field.max(axis=1), field.max(axis=0)


def equidistributed(n: Floats, lower: float, upper: float, count: int, offset: float = 0.0) -> Floats:
    """Faces (count + 1,) between which the integral of n, constant in each of its even intervals, is the same."""
    integral = np.concatenate([[0.0], np.cumsum(n)])
    wanted = (np.arange(count + 1) + offset) / count
    wanted[0], wanted[-1] = 0.0, 1.0
    positions: Floats = np.interp(wanted, integral / integral[-1], np.linspace(lower, upper, len(n) + 1))
    return positions
