"""Values to check an exported function against: by mpmath at 30 digits, with a tolerance for each row.

The tolerance is a bound of the rounding errors of the exported code at that row (mms/export/bounds.py), so it follows
from the conditioning: where terms cancel it is wide, elsewhere it is narrow.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
import sympy as sp

from mpm_verify.mms.derive import Fields
from mpm_verify.mms.export.bounds import UNIT, evaluate
from mpm_verify.mms.export.notation import Notation
from mpm_verify.mms.export.program import Program
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.state import Floats

ROWS = 40
DIGITS = 30
SHORT = 1e-9  # of the width, over which a slope is taken at 30 digits
SLACK = 2.0  # for what is of second order in the rounding
CLOSE = 64.0  # roundings of the width by which Newton's method may end beside the reference position


@dataclass(frozen=True)
class Checked:
    """Values (R,C) and tolerances (R,C) of a function at R rows."""

    values: Floats
    tolerance: Floats


def rows(layout: Layout, duration: float) -> tuple[Floats, Floats]:
    """Reference positions (R,d) in the domains of some particles, and times (R,), the start among them."""
    rng = np.random.default_rng(13)
    chosen = rng.integers(0, len(layout), ROWS)
    within = rng.uniform(-1, 1, (ROWS, layout.X.shape[1]))
    times = duration * rng.permutation(np.arange(ROWS)) / (ROWS - 1)
    return layout.X[chosen] + np.einsum("ps,psa->pa", within, layout.r0[chosen]), times


def checked(program: Program, expressions: Sequence[sp.Expr], exact: Fields, X: Floats, times: Floats) -> Checked:
    """Values and tolerances of an exported function.

    Parameters
    ----------
    program
        Function as it is exported.
    expressions
        Its results without rounded constants, of the exact fields.
    exact
        Fields without rounded constants.
    X, times
        Rows: reference positions (R,d) and times (R,).

    Returns
    -------
    Checked
        Values that are right to the last digit of a double, and tolerances.
    """
    precise = precisely(exact, expressions)
    values = np.array([[float(value) for value in precise(*at, t)] for at, t in zip(X.tolist(), times, strict=True)])
    tolerance = SLACK * UNIT * np.array([errors(program, exact, at, t) for at, t in zip(X, times, strict=True)])
    smallest = UNIT * np.abs(values).max(axis=0)  # a zero that is left over of a sum
    return Checked(values, tolerance + smallest)


def precisely(fields: Fields, expressions: Sequence[sp.Expr]) -> Any:
    """Function of the coordinates and the time that gives the expressions at 30 digits, a list of mpmath numbers.

    Where they are long the symbols that they are written in are evaluated first, else all is in coordinates alone.
    """
    expressions = expressions if fields.long else fields.full(list(expressions))
    at, used = (*fields.X, fields.t), set().union(*(sp.sympify(e).free_symbols for e in expressions))
    inner = {symbol: e for symbol, e in fields.inner.items() if symbol in used}
    first = sp.lambdify(at, list(inner.values()), "mpmath", cse=True)
    last = sp.lambdify((*at, *inner), list(expressions), "mpmath", cse=True)

    def evaluated(*at: Any) -> list[Any]:
        with mpmath.workdps(DIGITS):
            known = [mpmath.mpf(value) for value in at]
            return [mpmath.mpf(value) for value in last(*known, *first(*known))]

    return evaluated


def errors(program: Program, fields: Fields, X: Floats, t: float) -> list[float]:
    """Bounds of the errors of the results of a program, in units of one rounding. Raises ValueError without one."""
    write = Notation()
    statements = [(str(name), write(e)) for name, e in program.statements]
    known = {str(symbol): value for symbol, value in zip((*fields.X, fields.t), (*X, t), strict=True)}
    try:
        found = evaluate(statements, [write(e) for e in program.results], known)
    except (ArithmeticError, ValueError) as error:
        raise ValueError(f"{program.name} cannot be evaluated at X = {X.tolist()}, t = {t:g}: {error}") from None
    return [one.error for one in found]


def at_position(force: Checked, exact: Fields, X: Floats, times: Floats, width: float) -> Checked:
    """Force at the current positions x of the rows: the tolerance has room for an X that is found to some roundings.

    Parameters
    ----------
    force
        Force of the rows, as a function of the reference position.
    exact
        Fields without rounded constants.
    X, times
        Rows: reference positions (R,d) and times (R,).
    width
        Extent of the body, a length: its roundings are those of a position.

    Returns
    -------
    Checked
        Same values, wider tolerances.
    """
    b, F, h = precisely(exact, exact.b), precisely(exact, exact.F), SHORT * width
    tolerance = force.tolerance.copy()
    for row, (at, t) in enumerate(zip(X, times, strict=True)):
        slope = np.abs(np.stack([difference(b, at, t, e) for e in h * np.eye(len(at))], axis=-1)) / h
        plane = np.array(F(*at, t), dtype=float)[: len(at) ** 2]  # in axisymmetry that of the two coordinates
        stretch = np.abs(np.linalg.inv(plane.reshape(len(at), -1)))
        tolerance[row] += slope @ (CLOSE * UNIT * width * (1 + stretch.sum(axis=1)))
    return Checked(force.values, tolerance)


def difference(f: Any, X: Floats, t: float, step: Floats) -> Floats:
    """Half the difference of a precise function between X + step and X - step, as doubles."""
    before, after = (f(*(mpmath.mpf(a) + way * mpmath.mpf(b) for a, b in zip(X, step, strict=True)), t)
                     for way in (-1, 1))  # fmt: skip
    with mpmath.workdps(DIGITS):
        return np.array([float((b - a) / 2) for a, b in zip(before, after, strict=True)])
