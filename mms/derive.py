"""Derivation of stress and body force from a displacement and an energy, by SymPy and the chain rule.

    F = I + du/dX,  P = dW/dF,  sigma = P F^T / det F,  b = d2u/dt2 - Div P / rho0,
    Div P_i = sum over J, k, L of d2W/dF_iJ dF_kL * d2u_k/dX_L dX_J

The energy is differentiated once, by the components of F as symbols; nothing is simplified (it does not end on these).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Protocol

import sympy as sp

from mpm_verify.mms.energy import Energy, check_energy

Expressions = list[sp.Expr]


class Solution(Protocol):
    """A displacement field as a plug-in of mms/solutions; the problem statement is its docstring."""

    def displacement(self, X: Sequence[sp.Symbol], t: sp.Symbol) -> sp.Matrix:
        """Displacement u (2,) of the reference position X = (X, Y) and the time t."""


@dataclass(frozen=True)
class Fields:
    """Expressions in X, Y and t. Components in the order of the solver: F and P xx, xy, yx, yy; sigma xx, yy, zz, xy.

    P, sigma and b are written in the symbols of `inner`, which stand for components of F, of its gradient and of the
    acceleration; `full` puts those in.
    """

    X: tuple[sp.Symbol, sp.Symbol]
    t: sp.Symbol
    u: Expressions
    v: Expressions
    F: Expressions
    P: Expressions
    sigma: Expressions
    b: Expressions
    inner: dict[sp.Symbol, sp.Expr]

    def full(self, expressions: Expressions) -> Expressions:
        """Write expressions in X, Y and t alone."""
        return [sp.sympify(e).xreplace(self.inner) for e in expressions]


def derive(solution: Solution, material: Energy, rho0: float, exact: bool = False) -> Fields:
    """Derive all fields of a solution.

    Parameters
    ----------
    solution
        Displacement as an expression.
    material
        Constitutive model with an energy.
    rho0
        Density at reference.
    exact
        Whether floating-point numbers become the fractions that they are, so that no product of two is rounded: for
        values in more digits than a double has.

    Returns
    -------
    Fields
        Expressions in X, Y and t.

    Raises
    ------
    ValueError
        For a material without an energy.
    """
    check_energy(material)
    X, t = sp.symbols("X Y", real=True), sp.Symbol("t", real=True)
    number = fractions if exact else sp.sympify
    u = [number(component) for component in solution.displacement(X, t)]
    f = sp.symbols("Fxx Fxy Fyx Fyy", real=True)
    Fzz = sp.Symbol("Fzz", real=True)
    W = number(material.energy([[f[0], f[1], 0], [f[2], f[3], 0], [0, 0, Fzz]], sp.log))
    P = [sp.diff(W, component).xreplace({Fzz: sp.Integer(1)}) for component in (*f, Fzz)]
    F = [sp.diff(u[k], X[L]) + int(k == L) for k in (0, 1) for L in (0, 1)]

    inner: dict[sp.Symbol, sp.Expr] = dict(zip(f, F, strict=True))
    divergence = [sp.Integer(0), sp.Integer(0)]
    for i, J, q in product((0, 1), (0, 1), range(4)):  # q runs over the components kL of F
        second = inner_symbol(inner, sp.diff(F[q], X[J]), f"d{f[q]}_d{X[J]}")
        divergence[i] += sp.diff(P[2 * i + J], f[q]) * second
    b = [inner_symbol(inner, sp.diff(u[i], t, 2), f"a{X[i]}") - divergence[i] / number(rho0) for i in (0, 1)]

    J = f[0] * f[3] - f[1] * f[2]
    sigma = [
        (P[0] * f[0] + P[1] * f[1]) / J,
        (P[2] * f[2] + P[3] * f[3]) / J,
        P[4] / J,
        (P[0] * f[2] + P[1] * f[3]) / J,
    ]
    zeros = {symbol: e for symbol, e in inner.items() if e.is_number}  # a diagonal F makes most terms vanish
    P, sigma, b = ([sp.sympify(e).xreplace(zeros) for e in group] for group in (P[:4], sigma, b))
    return Fields(X, t, u, [sp.diff(e, t) for e in u], F, P, sigma, b, inner)


def fractions(expression: sp.Expr) -> sp.Expr:
    """Expression with each floating-point number as the fraction that it is."""
    e = sp.sympify(expression)
    return e.xreplace({number: sp.Rational(float(number)) for number in e.atoms(sp.Float)})


def inner_symbol(inner: dict[sp.Symbol, sp.Expr], expression: sp.Expr, name: str) -> sp.Symbol:
    """Symbol that stands for `expression`, new or known by its name."""
    symbol = sp.Symbol(name, real=True)
    inner[symbol] = expression
    return symbol
