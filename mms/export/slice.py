"""Slice of a plane-strain solution, one cell thick, for programs that have three dimensions and no other."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mpm_verify.mms.discretisation import dimension, width
from mpm_verify.solver.layout import Layout, per_side
from mpm_verify.solver.state import Floats

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class Slice:
    """Slice of a plane solution: nothing moves in z, and the two faces in z let particles slip along them.

    Parameters
    ----------
    plane
        Solution of two coordinates.
    dx
        Side of a cell, a length: the extent in z, from 0.
    """

    plane: Any
    dx: float
    faces: ClassVar[dict[str, str]] = {"back": "roller", "front": "roller"}

    lower = property(lambda self: np.append(self.plane.lower, 0.0))
    upper = property(lambda self: np.append(self.plane.upper, self.dx))
    duration = property(lambda self: self.plane.duration)
    C = property(lambda self: self.plane.C)

    @property
    def margin(self) -> Floats:
        """Room beyond the body below and above, (2,3): that of the plane solution, none in z."""
        return np.column_stack([np.broadcast_to(self.plane.margin, (2, 2)), np.zeros(2)])

    def layout(self, dx: float, ppc: int) -> Layout:
        """Layout of the plane solution, in as many layers as a cell has particles along a side."""
        plane, layers = self.plane.layout(dx, ppc), per_side(ppc)
        half = self.dx / layers / 2
        z = half * (2 * np.arange(layers) + 1)
        X = np.column_stack([np.repeat(plane.X, layers, axis=0), np.tile(z, len(plane))])
        r0 = np.zeros((len(X), 3, 3))
        r0[:, :2, :2] = np.repeat(plane.r0, layers, axis=0)
        r0[:, 2, 2] = half
        return Layout(X, 2 * half * np.repeat(plane.V0, layers), r0)

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (3,) of the reference position X and the time t: that of the plane solution, none in z."""
        import sympy as sp

        return sp.Matrix([*self.plane.displacement(X[:2], t), 0])


def sliced(solution: Any, dim: int, cells: int) -> Any:
    """Solution in so many dimensions: itself, or its slice on a grid of so many cells."""
    return solution if dimension(solution) == dim else Slice(solution, width(solution) / cells)
