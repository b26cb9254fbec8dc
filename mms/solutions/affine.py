"""Homogeneous deformation of a square: the patch test, with rotation, shear and volume change.

    u = (F(t) - I) X,   F = [[1 + a sin w t, b (1 - cos w t)], [c sin w t, 1 + d (1 - cos w t)]],   w = pi C / L

on 0 <= X, Y <= L. Stress is uniform, so the divergence of P vanishes and b = F'' X. Boundary: the edge moves, so the
nodes of cells that the body does not fill have the body's affine velocity, continued: at the node x at time t that of
the material point there, F'(t + dt/2) F(t)^-1 x. With it, F <- (I + dt L) F is exact up to the error of the midpoint
rule in time; what is left is how well momentum is mapped between particles and grid.
Source: the project's own; bounds on the parameters keep det F > 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from mpm_verify.mms.square import Square
from mpm_verify.solver.state import Floats

if TYPE_CHECKING:
    import sympy as sp


@dataclass(frozen=True)
class Affine(Square):
    """Affine motion.

    Parameters
    ----------
    L
        Side of the square, above zero.
    C
        Speed that sets the period, above zero.
    a, b, c, d
        Amplitudes of the four components of F, each below 0.25 in size.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    a: float = 0.1
    b: float = 0.08
    c: float = -0.06
    d: float = -0.05
    boundary: ClassVar[str] = "moving"

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in "abcd":
            self.limit(name, getattr(self, name), 0.25)

    @property
    def margin(self) -> float:
        """Room around the square: the largest displacement is 0.61 L with all parameters at their bounds."""
        return 0.65 * self.L

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (2,) of the reference position X and the time t."""
        import sympy as sp

        angle = sp.pi * self.exact(self.C) * t / self.exact(self.L)
        return sp.Matrix(self._matrix(sp.sin(angle), 1 - sp.cos(angle))) * sp.Matrix(list(X))

    def walls(self, nodes: Floats, t: float, dt: float) -> tuple[NDArray[np.bool_], Floats, Floats]:
        """Walls of a step from t to t + dt: nodes that are not surrounded by filled cells, with the body's motion.

        Parameters
        ----------
        nodes
            Positions x of the nodes, (n,2).
        t, dt
            Start and length of the step.

        Returns
        -------
        tuple
            Whether a node is held, its velocity F'(t + dt/2) F^-1 x and its acceleration F'' F^-1 x, (n,2) each.
        """
        w = np.pi * self.C / self.L
        inverse = np.linalg.inv(np.eye(2) + self._numbers(np.sin(w * t), 1 - np.cos(w * t)))
        return self._held(nodes, inverse, t, dt)

    def reference_walls(self, nodes: Floats, t: float, dt: float) -> tuple[NDArray[np.bool_], Floats, Floats]:
        """Walls of a step, as `walls`, of nodes that stay at their reference positions X (n,2)."""
        return self._held(nodes, np.eye(2), t, dt)

    def _held(
        self, nodes: Floats, inverse: NDArray[Any], t: float, dt: float
    ) -> tuple[NDArray[np.bool_], Floats, Floats]:
        """Walls of a step; `inverse` (2,2) takes nodes (n,2) to X."""
        w, dx = np.pi * self.C / self.L, float(nodes[1, 1] - nodes[0, 1])
        inside = np.ones(len(nodes), dtype=bool)
        for corner in ((-dx, -dx), (-dx, dx), (dx, -dx), (dx, dx)):
            X = (nodes + corner) @ inverse.T
            inside &= ((X >= -1e-9 * self.L) & (X <= (1 + 1e-9) * self.L)).all(axis=1)
        half = w * (t + 0.5 * dt)
        X = nodes @ inverse.T
        velocity = X @ (w * self._numbers(np.cos(half), np.sin(half))).T
        acceleration = X @ (w * w * self._numbers(-np.sin(w * t), np.cos(w * t))).T
        return np.repeat(~inside[:, None], 2, axis=1), velocity, acceleration

    def _matrix(self, odd: Any, even: Any) -> list[list[Any]]:
        """Matrix F - I, or one of its rates, from the values that sin w t and 1 - cos w t, or their rates, have."""
        return [[self.a * odd, self.b * even], [self.c * odd, self.d * even]]

    def _numbers(self, odd: float, even: float) -> Floats:
        return np.array(self._matrix(odd, even))
