"""Stored digits: rms errors over 16 frames of every reference in the usual cases, read from digits.csv.

The file is made by cases/mms/digits/make.py; a test runs some of its rows again.
"""

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from mpm_verify.cases.mms.digits.compare import QUANTITIES, by_value
from mpm_verify.cases.mms.digits.records import Against, Alike
from mpm_verify.cases.mms.digits.reference import Scheme
from mpm_verify.cases.mms.run import Run
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, canonical, create

FILE = Path(__file__).with_name("digits.csv")
CASES = ("clamped_shear:G=1e-6", "clamped_shear:G=0.05", "bump", "bump:A=0.05", "axis_aligned", "axis_aligned:A=1e-6",
         "swirl")  # fmt: skip
CELLS, PPC, COURANT = (8, 16, 32), 4, 0.4
HEAD = ("solution", "method", "stress", "transfer", "cells", *QUANTITIES, "failed")
SHOWN = 4.0  # digits that tables show: references that agree in all of them are not told apart
STORED = 5.0  # digits that a comparison with a stored number can show
APART = 2.0  # digits: with fewer, a case tells two references apart


@dataclass(frozen=True)
class Case:
    """Stored case: a solution in its own material, on one grid."""

    solution: str
    cells: int


Table = dict[Case, dict[Scheme, dict[str, float]]]


@cache
def table() -> Table:
    """Errors by case, scheme and quantity; empty of a reference that did not come to its end."""
    found: Table = {}
    with FILE.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            scheme = Scheme(row["method"], row["stress"], row["transfer"])
            errors = {} if row["failed"] else {q: float(row[q]) for q in QUANTITIES}
            found.setdefault(Case(row["solution"], int(row["cells"])), {})[scheme] = errors
    return found


def stored(run: Run) -> dict[Scheme, dict[str, float]]:
    """Errors of the references in the case of a run, by scheme and quantity; empty where none are stored."""
    own = canonical(MATERIALS, create(SOLUTIONS, run.solution).material)
    if (run.ppc, run.courant, run.material, run.start) != (PPC, COURANT, own, ""):
        return {}
    return table().get(Case(run.solution, run.cells), {})


def by_rms(rms: dict[str, float], known: dict[Scheme, dict[str, float]]) -> tuple[Against, ...]:
    """References held against rms values alone, the nearest first; those that failed are left out."""
    found = []
    for scheme, errors in known.items():
        both = {q: error for q, error in errors.items() if q in rms}
        if both:
            found.append(Against(scheme, both, by_value(rms, both, STORED)))
    return tuple(sorted(found, key=lambda one: -one.score))


def alike(nearest: Against, others: Iterable[Against]) -> tuple[Alike, ...]:
    """References that agree with the nearest in all digits shown of each quantity."""
    found = []
    for other in others:
        if other.scheme != nearest.scheme and agreement(other.rms, nearest.rms) >= SHOWN:
            found.append(telling(nearest.scheme, other.scheme))
    return tuple(found)


def agreement(one: dict[str, float], other: dict[str, float]) -> float:
    """Digits in which two references agree, in the quantity in which they differ most."""
    both = {q: size for q, size in other.items() if q in one}
    return min(by_value(one, both).values(), default=0.0)


def telling(one: Scheme, other: Scheme) -> Alike:
    """Stored case that tells two references apart best; of those where both came to their end."""
    found = [(agreement(known[one], known[other]), case) for case, known in table().items()
             if known.get(one) and known.get(other)]  # fmt: skip
    best, case = min(found, key=lambda pair: pair[0], default=(SHOWN, Case("", 0)))
    typed = {canonical(SOLUTIONS, name): name for name in CASES}
    return Alike(other, typed.get(case.solution, ""), case.cells, best) if best < APART else Alike(other)
