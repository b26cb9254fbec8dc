"""Notation of expressions in a language: operators, names of functions, literals in 17 digits."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import sympy as sp

from mpm_verify.mms.straight_line import factors

SUM, PRODUCT, ATOM = 1, 2, 3  # how tightly the parts of a text hold together
KNOWN = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt")


@dataclass(frozen=True)
class Notation:
    """Notation of a language.

    Parameters
    ----------
    literal
        Pattern of a number, such as ``{}_dp``; the number has as many digits as it takes to read the same double.
    times, over
        Operators of a product and a quotient.
    power
        Pattern of a power that is no product, of base and exponent.
    minus
        Text before a first term that is negative; ``0 - `` where a parser takes no sign there.
    functions
        Names of functions that differ from SymPy's.
    """

    literal: str = "{}"
    times: str = "*"
    over: str = "/"
    power: str = "pow({}, {})"
    minus: str = "-"
    functions: Mapping[str, str] = field(default_factory=dict)

    def __call__(self, expression: sp.Expr) -> str:
        """Text of an expression. Raises ValueError for a function that no language has."""
        return self._text(expression)[0]

    def number(self, value: float) -> str:
        """Literal of a number that is not negative."""
        return self.literal.format(repr(float(value)))

    def _text(self, e: sp.Expr) -> tuple[str, int]:
        """Text, and how tightly its parts hold together."""
        if e.is_number and not e.args:
            value = float(e)
            return (self.number(value), ATOM) if value >= 0 else (self.minus + self.number(-value), SUM)
        if e.is_Symbol:
            return str(e), ATOM
        if e.is_Add:
            return self._sum(e), SUM
        if e.is_Mul:
            return self._product(e)
        if e.is_Pow:
            return self._power(e)
        return f"{self._function(e.func.__name__)}({self(e.args[0])})", ATOM

    def _function(self, name: str) -> str:
        if name not in KNOWN:
            raise ValueError(f"the function {name} cannot be written in other languages; use {', '.join(KNOWN)}")
        return self.functions.get(name, name)

    def _held(self, e: sp.Expr, tightly: int) -> str:
        """Text that holds together within an operator."""
        text, holds = self._text(e)
        return text if holds >= tightly else f"({text})"

    def _sum(self, e: sp.Expr) -> str:
        terms = [(sign(term), positive(term)) for term in e.args]
        terms.sort(key=lambda term: -term[0])  # one without a sign first, where there is one
        text = self.minus * (terms[0][0] < 0) + self._held(terms[0][1], PRODUCT)
        for way, term in terms[1:]:
            text += (" + " if way > 0 else " - ") + self._held(term, PRODUCT)
        return text

    def _product(self, e: sp.Expr) -> tuple[str, int]:
        if sign(e) < 0:
            return self.minus + self._held(positive(e), PRODUCT), SUM
        below = [part for part in e.args if part.is_Pow and part.exp.is_number and part.exp.is_negative]
        above = [self._held(part, PRODUCT) for part in e.args if part not in below and part != 1]
        top = self.times.join(above) or self.number(1)
        if not below:
            return top, PRODUCT
        parts = [self._held(sp.Pow(part.base, -part.exp), PRODUCT) for part in below]
        single = len(parts) == 1 and self.times not in parts[0]
        return top + self.over + (parts[0] if single else f"({self.times.join(parts)})"), PRODUCT

    def _power(self, e: sp.Pow) -> tuple[str, int]:
        base, exponent = e.base, e.exp
        if exponent.is_number and exponent.is_negative:
            return self.number(1) + self.over + self._below(sp.Pow(base, -exponent)), PRODUCT
        if (count := factors(exponent)) and not base.args:
            return self.times.join([self._held(base, ATOM)] * count), PRODUCT
        if exponent == sp.S.Half:
            return f"{self._function('sqrt')}({self(base)})", ATOM
        return self.power.format(self._held(base, ATOM), self._held(exponent, ATOM)), ATOM

    def _below(self, e: sp.Expr) -> str:
        """Text of a denominator."""
        text, holds = self._text(e)
        return text if holds == ATOM else f"({text})"


def sign(e: sp.Expr) -> int:
    """Sign that is written before a term."""
    return -1 if (e if e.is_number and not e.args else e.as_coeff_Mul()[0]).is_negative else 1


def positive(e: sp.Expr) -> sp.Expr:
    """Term without the sign that is written before it."""
    return e if sign(e) > 0 else -e
