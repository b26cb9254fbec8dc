"""Digits of an answer: the value of the last digit of each of its numbers, whose rounding is a floor of the error."""

from decimal import Decimal, InvalidOperation
from typing import Any

import numpy as np

from mpm_verify.solver.state import Floats

MOST = 140  # power of ten of a number whose rounding can be squared
SAMPLE = 200  # numbers that the digits of a file are told from
LAST = np.sqrt(12.0)  # last digit over the standard deviation of its rounding


def last_digits(columns: dict[str, Any]) -> dict[str, Floats]:
    """Value of the last digit of each number (P,) by column, from its type, or from the digits that the texts have.

    Numbers that happen to be round have few: so the digits are those of the column that has most. Zero of numbers
    whose last digit is not known.
    """
    texts = {name: some(values) for name, values in columns.items() if name != "id" and values.dtype.kind not in "fiu"}
    told = [number for numbers in texts.values() for number, _ in numbers]
    digits = max((len(number.as_tuple().digits) for number in told), default=17)
    fixed = not any(power for numbers in texts.values() for _, power in numbers)
    decimals = max((-int(number.as_tuple().exponent) for number in told), default=17) if fixed else 400
    found = {}
    for name, values in columns.items():
        if name in texts:
            size = np.abs(values.astype(np.float64))
            known = np.isfinite(size) & (size > 10.0**-MOST) & (size < 10.0**MOST)
            power = np.floor(np.log10(np.where(known, size, 1.0)))
            found[name] = np.where(known, np.maximum(10.0 ** (power - digits + 1), 10.0**-decimals), 0.0)
        elif values.dtype.kind == "f":
            found[name] = float(np.finfo(values.dtype).eps) * np.abs(values.astype(np.float64))
    return found


def rounding(last: Floats) -> float:
    """Standard deviation of the rounding of numbers with such last digits; those that are zero have none."""
    known = last[last > 0]
    return float(np.sqrt(np.mean(np.square(known))) / LAST) if known.size else 0.0


def some(values: Any) -> list[tuple[Decimal, bool]]:
    """Finite numbers of some texts, but zero, and whether each has a power of ten. Raises ValueError."""
    found = []
    for word in values[:: max(1, len(values) // SAMPLE)]:
        try:
            number = Decimal(word.strip().lower().replace("d", "e"))
        except InvalidOperation:
            raise ValueError("not a number") from None
        if number.is_finite() and abs(number.adjusted()) < MOST and number != 0:
            found.append((number, "e" in word.lower() or "d" in word.lower()))
    return found
