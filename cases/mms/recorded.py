"""Recorded errors in rms, the tables recorded*.csv that recording.py makes; recorded.csv is of shipped solutions."""

import csv
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import get_args

from mpm_verify.cases.judging.records import Recorded
from mpm_verify.solver.stress_update import Stress

TABLE = Path(__file__).with_name("recorded.csv")
USUAL = "usl"  # order of the step of the reference solver; another code may do otherwise
Row = tuple[int, dict[str, float]]  # cells, and errors by quantity


def recorded(solution: str, method: str, ppc: int, quantity: str, theirs: bool = False) -> tuple[Recorded, ...]:
    """Recorded errors of a refinement, coarse to fine; the range over the orders of the step where it is `theirs`."""
    found: dict[int, list[float]] = {}
    for stress in get_args(Stress) if theirs else (USUAL,):
        for cells, errors in table().get((solution, method, str(ppc), stress), ()):
            found.setdefault(cells, []).append(errors[quantity])
    return tuple(Recorded(1 / cells, min(errors), max(errors)) for cells, errors in sorted(found.items()))


def table() -> Mapping[tuple[str, ...], list[Row]]:
    """Rows of recorded.csv by solution, method, particles per cell and order of the step."""
    return read(TABLE, "solution", "method", "ppc", "stress")


@cache
def read(file: Path, *names: str) -> Mapping[tuple[str, ...], list[Row]]:
    """Rows of a table by what stands in some of its columns."""
    found: dict[tuple[str, ...], list[Row]] = {}
    with file.open(newline="", encoding="utf-8") as text:
        for row in csv.DictReader(text):
            errors = {quantity: float(row[quantity]) for quantity in ("u", "v", "F", "sigma")}
            found.setdefault(tuple(row[name] for name in names), []).append((int(row["cells"]), errors))
    return found


def refinement(rows: Iterable[Row], quantity: str) -> tuple[Recorded, ...]:
    """Recorded errors of rows that are one refinement, as they stand."""
    return tuple(Recorded(1 / cells, errors[quantity], errors[quantity]) for cells, errors in rows)
