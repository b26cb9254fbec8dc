"""Bases of the solutions on a line, a square and a cube, and around an axis: domain, reference speed and duration."""

from dataclasses import dataclass, replace
from math import inf
from typing import Any, ClassVar

import numpy as np

from mpm_verify.solver.layout import CENTRED, Layout, Offset, rectangle
from mpm_verify.solver.state import Floats


@dataclass(frozen=True)
class Square:
    """Body of a solution on a square; a study lasts 2 L / C.

    Parameters
    ----------
    L
        Side, above zero.
    C
        Reference speed, above zero: dt = courant dx / C.

    Raises
    ------
    ValueError
        For another side or speed.
    """

    L: float = 1.0
    C: float = 100.0
    material: ClassVar[str] = "neo_hookean"  # what a study of it takes if nothing else is asked for
    coordinates: ClassVar[int] = 2

    def __post_init__(self) -> None:
        if not (self.L > 0 and self.C > 0):
            raise ValueError(f"L = {self.L} and C = {self.C} must be above zero")

    @property
    def lower(self) -> Floats:
        """Lower corner of the domain, (2,), of a cube (3,), of a line (1,)."""
        return np.zeros(self.coordinates)

    @property
    def upper(self) -> Floats:
        """Upper corner of the domain, (2,), of a cube (3,), of a line (1,)."""
        return np.full(self.coordinates, self.L)

    def layout(self, dx: float, ppc: int, offset: Offset = CENTRED) -> Layout:
        """Layout of square or cubic domains, `ppc` in a cell of side dx."""
        return rectangle(self.lower, self.upper, dx, ppc, offset)

    @property
    def margin(self) -> float:
        """Distance that the body may move out of its reference square; the grid is wider by it."""
        return 0.0

    @property
    def amplitude(self) -> float:
        """Largest displacement over the side, or angle, up to a factor of order one; inf where nothing is known."""
        return inf

    @property
    def duration(self) -> float:
        """Time that a study covers."""
        return 2 * self.L / self.C

    @staticmethod
    def limit(name: str, value: float, bound: float) -> None:
        """Raise ValueError unless |value| < bound: beyond it F is not invertible somewhere."""
        if not abs(value) < bound:
            raise ValueError(f"{name} = {value} must be below {bound:.4g} in size, to keep F invertible")

    @staticmethod
    def exact(value: float) -> Any:
        """Make an integer of a whole number, so that SymPy keeps sin(2 pi X) and its like exact."""
        import sympy as sp

        return sp.Integer(int(value)) if float(value).is_integer() else sp.Float(value)


@dataclass(frozen=True)
class Cube(Square):
    """Body of a solution in three dimensions, on a cube: for other solvers, as the reference solver has two."""

    coordinates: ClassVar[int] = 3


@dataclass(frozen=True)
class Line(Square):
    """Body of a solution in one dimension, in uniaxial strain: for other solvers, as the reference solver has two."""

    coordinates: ClassVar[int] = 1


@dataclass(frozen=True)
class Revolved(Square):
    """Body of an axisymmetric solution, a square of radius X and axis Y: for other solvers.

    Volumes are per radian: the area of a domain times the radius of its middle, which is exact.
    """

    axisymmetric: ClassVar[bool] = True

    def layout(self, dx: float, ppc: int, offset: Offset = CENTRED) -> Layout:
        """Layout of square domains, `ppc` in a cell of side dx, with volumes per radian."""
        return per_radian(super().layout(dx, ppc, offset))


def per_radian(flat: Layout) -> Layout:
    """Layout of a section around an axis: each volume is the area times the radius of its middle."""
    return replace(flat, V0=flat.V0 * flat.X[:, 0])
