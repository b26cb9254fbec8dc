"""Expressions as straight-line code: common subexpressions first, small whole powers as products."""

from collections.abc import Mapping, Sequence
from typing import Any

import sympy as sp

WHOLE = 2**53  # beyond, whole numbers are not integers that a compiler can type
MOST_FACTORS = 8


def assignments(
    inner: Mapping[sp.Symbol, sp.Expr], targets: Sequence[tuple[Any, sp.Expr]], letters: str = "vw"
) -> list[tuple[Any, sp.Expr]]:
    """Assignments in the order in which they are computed.

    Parameters
    ----------
    inner
        Expressions of symbols that the targets are written in; those that occur are computed first.
    targets
        Names, of any type, with their expressions.
    letters
        Letters of the common subexpressions of `inner` and of the targets.

    Returns
    -------
    list of tuple
        A name and its expression each: symbols of subexpressions, of `inner`, and the targets last.
    """
    used: set[sp.Symbol] = set().union(*(e.free_symbols for _, e in targets)) if targets else set()
    given = [(symbol, e) for symbol, e in inner.items() if symbol in used]
    early, first = sp.cse([e for _, e in given], symbols=sp.numbered_symbols(letters[0]))
    late, last = sp.cse([e for _, e in targets], symbols=sp.numbered_symbols(letters[1]))
    order = [*early, *zip([s for s, _ in given], first, strict=True), *late]
    return order + list(zip([target for target, _ in targets], last, strict=True))


def whole_numbers(expression: sp.Expr) -> sp.Expr:
    """Write J**(-2.0) as J**(-2): with a whole exponent it is two products, with another a call of pow()."""
    return sp.sympify(expression).replace(
        lambda e: e.is_Float and abs(e) < WHOLE and float(e).is_integer(), lambda e: sp.Integer(int(e))
    )


def factors(exponent: sp.Expr) -> int:
    """Number of factors of a product that a power is written as, negative in a denominator; 0 where it is none."""
    return int(exponent) if exponent.is_Integer and abs(int(exponent)) <= MOST_FACTORS else 0
