"""What depends on the place alone is tabulated once a particle, what depends on the time alone once a step.

A product such as A sin(2 pi X) sin(w t) is split into a column of the table, sin(2 pi X), and a scalar, A sin(w t);
only what mixes both is left for the inner loop.
"""

from collections.abc import Iterable

import sympy as sp


class Hoist:
    """Collects columns (functions of X, Y) and scalars (functions of the times) while it rewrites expressions."""

    def __init__(self, place: Iterable[sp.Symbol], times: Iterable[sp.Symbol]) -> None:
        self.place, self.times = set(place), set(times)
        self.columns: dict[sp.Expr, sp.Symbol] = {}
        self.scalars: dict[sp.Expr, sp.Symbol] = {}

    def __call__(self, expression: sp.Expr) -> sp.Expr:
        """The expression in columns, scalars and numbers alone."""
        free = expression.free_symbols
        if not free:
            return expression
        if free <= self.place:
            return self._column(expression)
        if free <= self.times:
            return self._named(self.scalars, expression, "s")
        if isinstance(expression, sp.Mul | sp.Add):
            return self._grouped(expression)
        return expression.func(*(self(argument) for argument in expression.args))

    def _grouped(self, expression: sp.Expr) -> sp.Expr:
        """A sum or product: its place part, its time part with the numbers, and the rest."""
        place = [a for a in expression.args if a.free_symbols and a.free_symbols <= self.place]
        times = [a for a in expression.args if a.free_symbols <= self.times]
        mixed = [self(a) for a in expression.args if a not in place and a not in times]
        parts = [self(expression.func(*group)) for group in (place, times) if group]
        return expression.func(*parts, *mixed)

    def _column(self, expression: sp.Expr) -> sp.Expr:
        """Constant factors stay outside, so that sin and -4 pi^2 sin share a column."""
        constant, rest = expression.as_independent(*self.place, as_Add=False)
        return constant * self._named(self.columns, rest, "c")

    @staticmethod
    def _named(known: dict[sp.Expr, sp.Symbol], expression: sp.Expr, letter: str) -> sp.Symbol:
        return known.setdefault(expression, sp.Symbol(f"{letter}{len(known)}", real=True))
