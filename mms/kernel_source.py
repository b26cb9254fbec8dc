"""Source of the kernel of the exact fields: expressions hoisted, without powers, printed in three loops."""

import sympy as sp
from sympy.printing.pycode import PythonCodePrinter

from mpm_verify.mms.derive import Fields
from mpm_verify.mms.exact import ROOM
from mpm_verify.mms.hoist import Hoist
from mpm_verify.mms.printed import printed
from mpm_verify.mms.straight_line import assignments, factors, whole_numbers

T_VELOCITY = sp.Symbol("t_velocity", real=True)  # time level of v, half a step before t where a run is staggered
HEADER = '''"""Generated from a manufactured solution; not for editing."""
import math
from mpm_verify.solver._jit import BLOCK, kernel
from mpm_verify.mms.exact import EXACT


@kernel(EXACT)
def exact(c, s, n, out):
'''


def write(fields: Fields) -> list[str]:
    """Sources of the kernel, of its columns and of its scalars: hoist, find common subexpressions, print.

    Of two coordinates, as the reference solver has them.
    """
    assert len(fields.X) == 2
    tv = T_VELOCITY
    hoist = Hoist(fields.X, (fields.t, tv))
    inner = {symbol: hoist(e) for symbol, e in fields.inner.items()}
    rows = [hoist(e) for e in fields.u]
    rows += [hoist(e.xreplace({fields.t: tv})) for e in fields.v]
    rows += [sp.Symbol(str(f), real=True) for f in list(fields.inner)[:4]]
    rows += [whole_numbers(e) for e in fields.sigma + fields.b]
    source = HEADER + _body(inner, rows, hoist)
    return [source, printed(fields.X, list(hoist.columns)), printed((fields.t, tv), list(hoist.scalars))]


class Printer(PythonCodePrinter):
    """Printer of small whole powers as products: Numba makes a loop of x**(-2), and a vectoriser passes loops by."""

    def _print_Pow(self, expr: sp.Pow, rational: bool = False) -> str:
        base, exponent = expr.as_base_exp()
        count = factors(exponent)
        if not count:
            return str(super()._print_Pow(expr, rational=rational))
        product = "*".join([f"({self._print(base)})"] * abs(count))
        return f"({product})" if exponent > 0 else f"(1.0/({product}))"


def _body(inner: dict[sp.Symbol, sp.Expr], rows: list[sp.Expr], hoist: Hoist) -> str:
    """Statements of the kernel: arguments of logarithms, logarithms, all the rest.

    Three loops, because a call of log() keeps the compiler from working on eight particles at once.
    """
    rows = [row.xreplace(inner) if row in inner and inner[row].is_number else row for row in rows]
    logs = sorted(set().union(*(row.atoms(sp.log) for row in rows)), key=str)[: ROOM - 14]
    names = sp.symbols(f"log0:{len(logs)}")
    rows = [row.xreplace(dict(zip(logs, names, strict=True))) for row in rows]
    width = max(1, len(hoist.columns))
    fetch = [f"{c} = c[{width} * b + {k}]" for k, c in enumerate(hoist.columns.values())]
    kept = [f"{name} = out[{14 + k} * BLOCK + b]" for k, name in enumerate(names)]
    scratch = [(f"out[{14 + k} * BLOCK + b]", log.args[0]) for k, log in enumerate(logs)]
    results = [(f"out[{r} * BLOCK + b]", row) for r, row in enumerate(rows)]
    logarithms = [f"{target} = math.log({target})" for target, _ in scratch]
    text = "".join(f"    {s} = s[{k}]\n" for k, s in enumerate(hoist.scalars.values()))
    text += _loop(fetch + _statements(inner, scratch)) + _loop(logarithms)
    return text + _loop(fetch + kept + _statements(inner, results))


def _loop(statements: list[str]) -> str:
    return "    for b in range(n):\n" + "".join(f"        {s}\n" for s in statements or ["pass"])


def _statements(inner: dict[sp.Symbol, sp.Expr], targets: list[tuple[str, sp.Expr]]) -> list[str]:
    """Assignments to `targets`, common subexpressions first; inner symbols that occur are computed before them."""
    printer = Printer()
    return [f"{target} = {printer.doprint(expression)}" for target, expression in assignments(inner, targets)]
