"""Function of SymPy for the square of the difference of principal logarithms; imported by who has loaded SymPy."""

from typing import Any

import sympy as sp

from mpm_verify.solver.log_spread import written


class SpreadSquared(sp.Function):  # type: ignore[misc]
    """Derivative number n by y of d^2, for y = cosh d - 1: SpreadSquared(y, n), known up to the second."""

    nargs = (2,)
    is_real = True

    def fdiff(self, argindex: int = 1) -> Any:
        """Derivative by y."""
        y, n = self.args
        return SpreadSquared(y, n + 1)

    def _eval_expand_func(self, **hints: Any) -> Any:
        y, n = self.args
        return written(y, int(n), sp.sqrt, sp.Rational)
