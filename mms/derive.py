"""Derivation of stress and body force from a displacement and an energy, by SymPy and the chain rule.

    F = I + du/dX,  P = dW/dF,  sigma = P F^T / det F,  b = d2u/dt2 - Div P / rho0,
    Div P_i = sum over J, k, L of d2W/dF_iJ dF_kL * d2u_k/dX_L dX_J

A solution of two coordinates is in plane strain: F_zz = 1, and no other component of F in z. One of one coordinate is
in uniaxial strain, F = diag(1 + du/dX, 1, 1). In axisymmetry X is the radius, Y the axis and z the hoop direction, F_zz
= 1 + u_x / X, and the virtual work of P per radian, the integral of (P : Grad w + P_zz w_x / X) X dX dY, gives

    Div P_x = dP_xX/dX + dP_xY/dY + (P_xX - P_zz) / X,   Div P_y = dP_yX/dX + dP_yY/dY + P_yX / X

The energy is differentiated once, by the components of F as symbols; nothing is simplified (it does not end on these).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Protocol

import sympy as sp

from mpm_verify.mms.components import AXES, COMPONENTS
from mpm_verify.mms.discretisation import axisymmetric
from mpm_verify.mms.energy import Energy, check_energy
from mpm_verify.solver.state import Floats

Expressions = list[sp.Expr]
PER_RADIUS = sp.Symbol("per_X", real=True)
LONG = 5000  # operations of b with its repetitions; a neo-Hookean solid has 432 in two dimensions, 9315 in three


class Solution(Protocol):
    """A displacement field as a plug-in of mms/solutions; the problem statement is its docstring."""

    @property
    def lower(self) -> Floats:
        """Lower corner of the body's box, (d,), with as many coordinates as the solution has.

        One with `axisymmetric` has the radius and the axis.
        """

    def displacement(self, X: Sequence[sp.Symbol], t: sp.Symbol) -> sp.Matrix:
        """Displacement u (d,) of the reference position X = (X, Y) or (X, Y, Z) and the time t."""


@dataclass(frozen=True)
class Fields:
    """Expressions in X, Y and t, or X, Y, Z and t. F and P row by row: xx, xy, yx, yy; sigma as COMPONENTS has it.

    In one dimension they are in X and t; in axisymmetry F and P have zz, the hoop direction, as a fifth component.
    P, sigma and b are written in the symbols of `inner`, which stand for components of F, of its gradient and of the
    acceleration, and in axisymmetry of 1/X; `full` puts those in.
    """

    X: tuple[sp.Symbol, ...]
    t: sp.Symbol
    u: Expressions
    v: Expressions
    F: Expressions
    P: Expressions
    sigma: Expressions
    b: Expressions
    inner: dict[sp.Symbol, sp.Expr]

    @property
    def long(self) -> bool:
        """Whether expressions in coordinates and t alone are so long that what is made of them takes minutes."""
        return len(self.X) == 3 or sum(sp.sympify(e).count_ops() for e in self.b) > LONG

    def full(self, expressions: Expressions) -> Expressions:
        """Write expressions in coordinates and t alone."""
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
        Expressions in coordinates and t.

    Raises
    ------
    ValueError
        For a material without an energy.
    """
    check_energy(material)
    d, around = len(solution.lower), axisymmetric(solution)
    X, t = tuple(sp.symbols([*AXES[:d].upper()], real=True)), sp.Symbol("t", real=True)
    number = fractions if exact else sp.sympify
    u = [number(component) for component in solution.displacement(X, t)]
    f = sp.symbols([f"F{a}{b}" for a in AXES[:d] for b in AXES[:d]], real=True)
    Fzz = sp.Symbol("Fzz", real=True)
    F = [sp.diff(u[k], X[L]) + int(k == L) for k in range(d) for L in range(d)]
    whole = [[f[d * i + j] if max(i, j) < d else Fzz * int(i == j) for j in range(3)] for i in range(3)]
    W = number(material.energy(whole, sp.log))
    if around:
        f, F = [*f, Fzz], [*F, 1 + sum(term / X[0] for term in sp.Add.make_args(u[0]))]
    P = [sp.diff(W, component) for component in f]
    if d < 3 and not around:
        P = [e.xreplace({Fzz: sp.Integer(1)}) for e in (*P, *[sp.diff(W, Fzz)] * (d == 2))]

    inner: dict[sp.Symbol, sp.Expr] = dict(zip(f, F, strict=True))
    divergence = [sp.Integer(0)] * d
    for i, J, q in product(range(d), range(d), range(len(f))):  # q runs over the components kL of F
        second = inner_symbol(inner, sp.diff(F[q], X[J]), f"d{f[q]}_d{X[J]}")
        divergence[i] += sp.diff(P[d * i + J], f[q]) * second
    if around:
        divergence = [e + term for e, term in zip(divergence, hoop_terms(P), strict=True)]
    b = [inner_symbol(inner, sp.diff(u[i], t, 2), f"a{X[i]}") - divergence[i] / number(rho0) for i in range(d)]
    inner |= {PER_RADIUS: 1 / X[0]} if around else {}

    sigma = cauchy(P, f, d, Fzz if around else sp.Integer(1))
    zeros = {symbol: e for symbol, e in inner.items() if e.is_number}  # a diagonal F makes most terms vanish
    P, sigma, b = ([sp.expand_func(e).xreplace(zeros) for e in group] for group in (P[: len(f)], sigma, b))
    return Fields(X, t, u, [sp.diff(e, t) for e in u], F, P, sigma, b, inner)


def hoop_terms(P: Expressions) -> Expressions:
    """Terms of Div P without a derivative, of the components xx, xy, yx, yy and zz."""
    return [(P[0] - P[4]) * PER_RADIUS, P[2] * PER_RADIUS]


def cauchy(P: Expressions, f: Sequence[sp.Symbol], d: int, Fzz: sp.Expr) -> Expressions:
    """Components of P F^T / det F in the order of COMPONENTS; of two coordinates P_zz is the last of P."""
    J = (f[0] * f[3] - f[1] * f[2]) * Fzz if d == 2 else sp.Matrix(d, d, f).det()
    rows = {end: [AXES.index(letter) for letter in end] for end in COMPONENTS[d]}
    return [
        P[4] * Fzz / J if d == 2 and end == "zz" else sum(P[d * i + k] * f[d * j + k] for k in range(d)) / J
        for end, (i, j) in rows.items()
    ]


def fractions(expression: sp.Expr) -> sp.Expr:
    """Expression with each floating-point number as the fraction that it is."""
    e = sp.sympify(expression)
    return e.xreplace({number: sp.Rational(float(number)) for number in e.atoms(sp.Float)})


def inner_symbol(inner: dict[sp.Symbol, sp.Expr], expression: sp.Expr, name: str) -> sp.Symbol:
    """Symbol that stands for `expression`, new or known by its name."""
    symbol = sp.Symbol(name, real=True)
    inner[symbol] = expression
    return symbol
