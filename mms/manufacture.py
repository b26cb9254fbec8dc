"""manufacture(): a displacement and a material become exact fields and the body force that makes them a solution."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from mpm_verify.mms.derive import Expressions, Fields, Solution, derive
from mpm_verify.mms.energy import Energy
from mpm_verify.mms.exact import ExactKernel, compile_exact
from mpm_verify.solver.state import Floats

Field = Callable[[Floats, float], Floats]


@dataclass(frozen=True)
class Manufactured:
    """Exact fields as functions of (X, t): reference positions X (P,2), t a number.

    Parameters
    ----------
    fields
        Expressions that the functions are made from.
    """

    fields: Fields

    def x(self, X: Floats, t: float) -> Floats:
        """Position x (P,2), a length."""
        return X + self.u(X, t)

    @cached_property
    def u(self) -> Field:
        """Displacement u (P,2), a length."""
        return self._function(self.fields.u, (2,))

    @cached_property
    def v(self) -> Field:
        """Velocity v (P,2), length per time."""
        return self._function(self.fields.v, (2,))

    @cached_property
    def F(self) -> Field:
        """Deformation gradient F (P,2,2), rows the components of the position."""
        return self._function(self.fields.F, (2, 2))

    @cached_property
    def P(self) -> Field:
        """First Piola stress P (P,2,2), rows the components of the traction."""
        return self._function(self.fields.P, (2, 2))

    @cached_property
    def sigma(self) -> Field:
        """Cauchy stress sigma (P,4): xx, yy, zz, xy, tension positive."""
        return self._function(self.fields.sigma, (4,))

    @cached_property
    def b(self) -> Field:
        """Body force per mass b (P,2), length per time squared."""
        return self._function(self.fields.b, (2,))

    @cached_property
    def kernel(self) -> ExactKernel:
        """Fields as one compiled kernel for blocks of particles."""
        return compile_exact(self.fields)

    def _function(self, expressions: Expressions, shape: tuple[int, ...]) -> Field:
        compiled: Any = sp.lambdify((*self.fields.X, self.fields.t), self.fields.full(expressions), "numpy", cse=True)

        def evaluate(X: Floats, t: float) -> Floats:
            values = [np.broadcast_to(value, len(X)) for value in compiled(X[:, 0], X[:, 1], t)]
            return np.stack(values, axis=-1).astype(np.float64).reshape(len(X), *shape)

        return evaluate


def manufacture(solution: Solution, material: Energy, rho0: float) -> Manufactured:
    """Make exact fields, and the body force that they need, from a displacement.

    The source term comes from the material's energy by differentiation, never from the stress the solver computes.

    Parameters
    ----------
    solution
        Displacement as an expression, such as a plug-in of mms/solutions.
    material
        Constitutive model with an energy.
    rho0
        Density at reference, in the units of the material.

    Returns
    -------
    Manufactured
        x, u, v, F, P, sigma and b as functions of (X, t).

    Raises
    ------
    ValueError
        For a material without an energy; it names those that have one.
    """
    return Manufactured(derive(solution, material, rho0))
