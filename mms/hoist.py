"""Split of expressions: what depends on X alone is tabulated once a particle, what depends on t alone once a step.

A product such as A sin(2 pi X) sin(w t) is split into a column of the table, sin(2 pi X), and a scalar, A sin(w t);
only what mixes both is left for the inner loop.
"""

from collections.abc import Iterable

import sympy as sp


class Hoist:
    """Collector of columns (functions of X, Y) and scalars (functions of the times) while it rewrites expressions."""

    def __init__(self, X: Iterable[sp.Symbol], times: Iterable[sp.Symbol]) -> None:
        self.X, self.times = set(X), set(times)
        self.columns: dict[sp.Expr, sp.Symbol] = {}
        self.scalars: dict[sp.Expr, sp.Symbol] = {}

    def __call__(self, expression: sp.Expr) -> sp.Expr:
        """Write an expression in columns, scalars and numbers alone."""
        free = expression.free_symbols
        if not free:
            return expression
        if free <= self.X:
            return self._column(expression)
        if free <= self.times:
            return self._named(self.scalars, expression, "s")
        if isinstance(expression, sp.Mul | sp.Add):
            return self._grouped(expression)
        return expression.func(*(self(argument) for argument in expression.args))

    def _grouped(self, expression: sp.Expr) -> sp.Expr:
        """Split a sum or product into its part in X, its part in time with the numbers, and the rest."""
        fixed = [a for a in expression.args if a.free_symbols and a.free_symbols <= self.X]
        times = [a for a in expression.args if a.free_symbols <= self.times]
        mixed = [self(a) for a in expression.args if a not in fixed and a not in times]
        parts = [self(expression.func(*group)) for group in (fixed, times) if group]
        return expression.func(*parts, *mixed)

    def _column(self, expression: sp.Expr) -> sp.Expr:
        """Name a column; constant factors stay outside, so that sin and -4 pi^2 sin share one."""
        constant, rest = expression.as_independent(*self.X, as_Add=False)
        return constant * self._named(self.columns, rest, "c")

    @staticmethod
    def _named(known: dict[sp.Expr, sp.Symbol], expression: sp.Expr, letter: str) -> sp.Symbol:
        return known.setdefault(expression, sp.Symbol(f"{letter}{len(known)}", real=True))
