"""Functions of an exported case as straight-line code that no language is chosen for yet."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from mpm_verify.mms.derive import Fields
from mpm_verify.mms.straight_line import assignments, factors, whole_numbers


@dataclass(frozen=True)
class Program:
    """Straight-line code of one function.

    Parameters
    ----------
    name
        Name of the function.
    inputs
        Names of the arguments that are arrays, with the symbols of their components; t is the last argument of all.
    statements
        Symbols and their expressions, in order.
    results
        Expressions of the components that it gives.
    shape
        Shape of the components, such as (2, 2).
    """

    name: str
    inputs: dict[str, tuple[sp.Symbol, ...]]
    statements: tuple[tuple[sp.Symbol, sp.Expr], ...]
    results: tuple[sp.Expr, ...]
    shape: tuple[int, ...]

    @property
    def used(self) -> set[sp.Symbol]:
        """Symbols that the code reads."""
        parts = (*(e for _, e in self.statements), *self.results)
        return set().union(*(e.free_symbols for e in parts))


def programs(fields: Fields) -> list[Program]:
    """Functions of a solution: its exact fields, and the step of Newton's method from a position to the reference one.

    Parameters
    ----------
    fields
        Expressions of the solution.

    Returns
    -------
    list of Program
        body_force, displacement, velocity, deformation, stress, newton_step.
    """
    d, here = len(fields.X), {"position": tuple(fields.X)}
    stress, gradient = (len(fields.sigma),), (d, d) if len(fields.F) == d * d else (len(fields.F),)
    made = [
        program("body_force", here, fields, fields.b, (d,)),
        program("displacement", here, fields, fields.u, (d,)),
        program("velocity", here, fields, fields.v, (d,)),
        program("deformation", here, fields, fields.F, gradient),
        program("stress", here, fields, fields.sigma, stress),
    ]
    goal = sp.symbols(f"goal0:{d}", real=True)
    return [*made, program("newton_step", {**here, "goal": goal}, fields, newton_step(fields, goal), (d,))]


def newton_step(fields: Fields, goal: Sequence[sp.Symbol]) -> list[sp.Expr]:
    """Components of F^-1 (goal - X - u), the step of Newton's method to the reference position of `goal`."""
    d = len(fields.X)
    symbols = [symbol if not e.is_number else e for symbol, e in list(fields.inner.items())[: d * d]]
    F = sp.Matrix(d, d, symbols)
    gap = sp.Matrix([goal[k] - fields.X[k] - fields.u[k] for k in range(d)])
    return list(F.adjugate() * gap / F.det())


def program(
    name: str,
    inputs: dict[str, tuple[sp.Symbol, ...]],
    fields: Fields,
    expressions: Sequence[sp.Expr],
    shape: tuple[int, ...],
) -> Program:
    """Program of some expressions, subexpressions and bases of powers first."""
    targets = [(k, whole_numbers(e)) for k, e in enumerate(expressions)]
    inner = {symbol: whole_numbers(e) for symbol, e in fields.inner.items()}
    order = based(assignments(inner, targets))
    count = len(targets)
    return Program(name, inputs, tuple(order[:-count]), tuple(e for _, e in order[-count:]), shape)


def based(order: Sequence[tuple[sp.Symbol | int, sp.Expr]]) -> list[tuple[sp.Symbol, sp.Expr]]:
    """Assignments with a symbol as the base of each power that is written as a product."""
    made: list[tuple[sp.Symbol, sp.Expr]] = []
    names = sp.numbered_symbols("p", real=True)

    def rewrite(e: sp.Expr) -> sp.Expr:
        if not e.args:
            return e
        arguments = [rewrite(argument) for argument in e.args]
        if e.is_Pow and abs(factors(e.exp)) > 1 and arguments[0].args:
            symbol = next(names)
            made.append((symbol, arguments[0]))
            return sp.Pow(symbol, e.exp)
        return e.func(*arguments, evaluate=False) if arguments != list(e.args) else e

    results: list[tuple[sp.Symbol, sp.Expr]] = []
    for target, expression in order:
        new = rewrite(expression)
        (results if isinstance(target, int) else made).append((target, new))
    return made + results
