"""Base of the solutions on a ring around the origin: the body, the reference speed and the clearance."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from mpm_verify.solver.layout import CENTRED, Layout, Offset, annulus
from mpm_verify.solver.state import Floats


@dataclass(frozen=True)
class Annulus:
    """Body of a solution on a ring; both edges are free, and the displacement must leave them without traction.

    Parameters
    ----------
    inner, outer
        Radii of the body, 0 < inner < outer.
    C
        Reference speed, above zero: dt = courant dx / C.

    Raises
    ------
    ValueError
        For other radii or speeds.
    """

    inner: float = 0.75
    outer: float = 1.25
    C: float = 1.0
    boundary: ClassVar[str] = "free"

    def __post_init__(self) -> None:
        if not 0 < self.inner < self.outer:
            raise ValueError(f"inner = {self.inner} and outer = {self.outer} must be 0 < inner < outer")
        if not self.C > 0:
            raise ValueError(f"C = {self.C} must be above zero")

    @property
    def L(self) -> float:
        """Thickness, the length on which the fields vary."""
        return self.outer - self.inner

    @property
    def lower(self) -> Floats:
        """Lower corner of the box around the body, (2,)."""
        return np.full(2, -self.outer)

    @property
    def upper(self) -> Floats:
        """Upper corner of the box around the body, (2,)."""
        return np.full(2, self.outer)

    @property
    def margin(self) -> float:
        """Distance by which the grid is wider than the box: two cells where eight cover the body.

        Domains beside a free edge are parallelograms, and in strong shear their corners reach beyond the edge.
        """
        return 0.5 * self.outer

    def layout(self, dx: float, ppc: int, offset: Offset = CENTRED) -> Layout:
        """Layout of rings, spaced as `ppc` in a cell of side dx; the same for every `offset`, which moves the grid."""
        return annulus(self.inner, self.outer, dx, ppc)
