"""Table of digits: an answer beside the nearest references, a row for each quantity of each."""

from mpm_verify.cases.mms.digits.records import Compared
from mpm_verify.reports import words
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.sentences.digits import digits, scheme

SHOWN = 4  # references, the nearest first


def table(found: Compared, count: int = SHOWN) -> Table:
    """Errors of the answer and of the nearest references, and the digits in which they agree."""
    head = (
        "reference",
        "quantity",
        "yours, rms",
        "its rms",
        "digits of rms",
        *(["of particles"] if found.framed else []),
    )
    rows = []
    for one in found.against[:count]:
        for number, (quantity, size) in enumerate(one.rms.items()):
            name = scheme(one.scheme) if number == 0 else ""
            values = words.sci(found.rms[quantity]), words.sci(size), digits(one.digits[quantity])
            more = [digits(one.particles[quantity])] if found.framed else []
            rows.append((name, words.quantity(quantity), *values, *more))
    return Table("Digits that agree, the nearest reference first", head, tuple(rows), heads=2)
