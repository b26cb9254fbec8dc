"""Recorded errors in rms of methods on shipped solutions, the table recorded.csv that recording.py makes."""

import csv
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from mpm_verify.cases.judging.records import Recorded

TABLE = Path(__file__).with_name("recorded.csv")
USUAL = "usl"  # order of the step of the reference solver; another code may do otherwise
Key = tuple[str, str, int]  # solution, method, particles per cell


def recorded(solution: str, method: str, ppc: int, quantity: str, theirs: bool = False) -> tuple[Recorded, ...]:
    """Recorded errors of a refinement, coarse to fine; the range over the orders of the step where it is `theirs`."""
    found: dict[int, list[float]] = {}
    for stress, cells, errors in table().get((solution, method, ppc), ()):
        if theirs or stress == USUAL:
            found.setdefault(cells, []).append(errors[quantity])
    return tuple(Recorded(1 / cells, min(errors), max(errors)) for cells, errors in sorted(found.items()))


@cache
def table() -> Mapping[Key, list[tuple[str, int, dict[str, float]]]]:
    """Rows of the table by refinement: order of the step, cells, and errors by quantity."""
    found: dict[Key, list[tuple[str, int, dict[str, float]]]] = {}
    with TABLE.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            errors = {quantity: float(row[quantity]) for quantity in ("u", "v", "F", "sigma")}
            key = row["solution"], row["method"], int(row["ppc"])
            found.setdefault(key, []).append((row["stress"], int(row["cells"]), errors))
    return found
