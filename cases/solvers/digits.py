"""Digits of an answer: the rounding of each of its columns, which is a floor of the error."""

from decimal import Decimal, InvalidOperation
from typing import Any

import numpy as np

MOST = 140  # power of ten of a number whose rounding can be squared
SAMPLE = 200  # numbers that the digits of a file are told from


def rounding(columns: dict[str, Any]) -> dict[str, float]:
    """Standard deviation of the rounding of each column, from its type, or from the digits that the texts have.

    Numbers that happen to be round have few: so the digits are those of the column that has most.
    """
    texts = {name: some(values) for name, values in columns.items() if name != "id" and values.dtype.kind not in "fiu"}
    told = [number for numbers in texts.values() for number, _ in numbers]
    digits = max((len(number.as_tuple().digits) for number in told), default=17)
    fixed = not any(power for numbers in texts.values() for _, power in numbers)
    decimals = max((-int(number.as_tuple().exponent) for number in told), default=17) if fixed else 400
    found = {}
    for name, values in columns.items():
        if name in texts:
            ulps = [max(10.0 ** (number.adjusted() - digits + 1), 10.0**-decimals) for number, _ in texts[name]]
            found[name] = float(np.sqrt(np.mean(np.square(ulps)) / 12)) if ulps else 0.0
        elif values.dtype.kind == "f" and len(values):
            size = np.sqrt(np.mean(np.square(values, dtype=np.float64)))
            found[name] = float(np.finfo(values.dtype).eps * size / np.sqrt(12.0))
    return found


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
