"""Numbers that carry a bound of their rounding error, for straight-line code in double precision.

To first order, as in running error analysis: an operation passes on the errors of its operands by its derivatives, and
rounds its own value once; a function of the library is allowed four roundings. The bound holds for any order in which a
compiler adds the terms of one sum, up to a factor that is small, and for fused operations.

Reference: Higham 2002, Accuracy and Stability of Numerical Algorithms, section 3.3, doi:10.1137/1.9780898718027.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

UNIT = 2.0**-53  # one rounding, relative
LIBRARY = 4.0  # roundings in a function of a library


@dataclass(frozen=True)
class Bounded:
    """Number with a bound of its absolute error, in units of one rounding."""

    value: float
    error: float

    def __add__(self, other: Any) -> "Bounded":
        o = bounded(other)
        value = self.value + o.value
        return Bounded(value, self.error + o.error + abs(value))

    def __sub__(self, other: Any) -> "Bounded":
        return self + -bounded(other)

    def __mul__(self, other: Any) -> "Bounded":
        o = bounded(other)
        value = self.value * o.value
        return Bounded(value, abs(self.value) * o.error + abs(o.value) * self.error + abs(value))

    def __truediv__(self, other: Any) -> "Bounded":
        o = bounded(other)
        value = self.value / o.value
        return Bounded(value, (self.error + abs(value) * o.error) / abs(o.value) + abs(value))

    def __neg__(self) -> "Bounded":
        return Bounded(-self.value, self.error)

    def __radd__(self, other: Any) -> "Bounded":
        return bounded(other) + self

    def __rsub__(self, other: Any) -> "Bounded":
        return bounded(other) - self

    def __rmul__(self, other: Any) -> "Bounded":
        return bounded(other) * self

    def __rtruediv__(self, other: Any) -> "Bounded":
        return bounded(other) / self


def bounded(number: Any) -> Bounded:
    """Constant or number: one that is not whole was rounded twice, when it was derived and when it is read."""
    if isinstance(number, Bounded):
        return number
    value = float(number)
    return Bounded(value, 0.0 if value.is_integer() else 2 * abs(value))


def function(f: Callable[[float], float], slope: Callable[[float, float], float]) -> Callable[[Any], Bounded]:
    """Function of the library for numbers with bounds; `slope(x, f(x))` is its derivative."""

    def of(argument: Any) -> Bounded:
        x = bounded(argument)
        value = f(x.value)
        return Bounded(value, abs(slope(x.value, value)) * x.error + LIBRARY * abs(value))

    return of


def power(base: Any, exponent: Any) -> Bounded:
    """Power of a base above zero with an exact exponent."""
    x, n = bounded(base), float(exponent)
    value = x.value**n
    return Bounded(value, abs(n * value / x.value) * x.error + LIBRARY * abs(value))


FUNCTIONS: dict[str, Callable[..., Bounded]] = {
    "sin": function(math.sin, lambda x, f: math.cos(x)),
    "cos": function(math.cos, lambda x, f: math.sin(x)),
    "tan": function(math.tan, lambda x, f: 1 + f * f),
    "asin": function(math.asin, lambda x, f: 1 / math.sqrt(1 - x * x)),
    "acos": function(math.acos, lambda x, f: 1 / math.sqrt(1 - x * x)),
    "atan": function(math.atan, lambda x, f: 1 / (1 + x * x)),
    "sinh": function(math.sinh, lambda x, f: math.cosh(x)),
    "cosh": function(math.cosh, lambda x, f: math.sinh(x)),
    "tanh": function(math.tanh, lambda x, f: 1 - f * f),
    "exp": function(math.exp, lambda x, f: f),
    "log": function(math.log, lambda x, f: 1 / x),
    "sqrt": function(math.sqrt, lambda x, f: 0.5 / f),
    "pow": power,
}


def evaluate(statements: Sequence[tuple[str, str]], results: Sequence[str], known: dict[str, Any]) -> list[Bounded]:
    """Results of straight-line code, written as Python, for inputs that are rounded once themselves.

    Parameters
    ----------
    statements
        Names and texts of their expressions, in order.
    results
        Texts of the results.
    known
        Values of the inputs by their names.

    Returns
    -------
    list of Bounded
        One for each result.
    """
    names: dict[str, Any] = {**FUNCTIONS, "__builtins__": {}}
    names |= {name: Bounded(float(value), abs(float(value))) for name, value in known.items()}
    for name, text in statements:
        names[name] = eval(text, names)
    return [bounded(eval(text, names)) for text in results]
