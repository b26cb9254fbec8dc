"""Recording of errors: the tables recorded*.csv of this folder, made anew by `make recorded`.

Each row of the first is one run of the usual scheme (FLIP, a Courant number of 0.4, staggered start) with its errors in
rms, or the same with the stress updated last after a second mapping of velocities (musl), which another code may do.
Each row of recorded_axes.csv is one of CPDI in which an axis is not as usual, see variants.py; of recorded_rates.csv
one of a Hencky solid, see rates.py.
"""

import csv
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

from mpm_verify.cases.mms import rates
from mpm_verify.cases.mms.deviations import DEVIATIONS, SMALL_AMPLITUDE
from mpm_verify.cases.mms.expectations import registered
from mpm_verify.cases.mms.recorded import TABLE
from mpm_verify.cases.mms.run import QUANTITIES, Run
from mpm_verify.cases.mms.variants import AXES
from mpm_verify.cases.mms.variants import SOLUTIONS as VARIED
from mpm_verify.cases.mms.variants import TABLE as VARIANTS_TABLE
from mpm_verify.solver.plugins import MATERIALS, METHODS, SOLUTIONS, available, canonical, create

HEAD = ("solution", "method", "stress", "ppc", "cells")
VARIANTS_HEAD = ("solution", "method", "ppc", *AXES, "cells")
VARIANTS: tuple[dict[str, Any], ...] = (
    {"damping": 0.05},
    {"damping": 0.01},
    {"damping": 0.05, "manufacture": "damping"},
    *({"smoothing": f"{part}:of=stress{where}"} for part in ("volumetric", "deviatoric", "full")
      for where in ("", ",where=node")),
    {"periods": 0.125},
    {"periods": 2.0},
)  # fmt: skip
SMALL = ("axis_aligned:A=1e-06", "clamped_shear:G=1e-06")  # of a regime of its own
CELLS = (8, 12, 16, 24, 32, 48, 64, 96, 128)
MOST = {("usl", 4): 64, ("usl", 9): 32, ("musl", 4): 32}  # cells, by order of the step and particles per cell
FINE = ("axis_aligned", "cpdi")  # the paper's own, on all grids


def runs() -> Iterator[Run]:
    """Runs of the table: methods for which an order or a stall of u is registered."""
    for solution, method, stress, ppc in product((*DEVIATIONS, *SMALL), available(METHODS), ("usl", "musl"), (4, 9)):
        regime = SMALL_AMPLITUDE if solution in SMALL else solution
        if solution == SMALL_AMPLITUDE or (stress, ppc) not in MOST:
            continue
        expectation = registered(regime, method, "u")
        if not expectation or expectation.failed or expectation.kind == "diverges":
            continue
        name = canonical(SOLUTIONS, solution)
        material = canonical(MATERIALS, create(SOLUTIONS, name).material)
        most = CELLS[-1] if (solution, method) == FINE else MOST[stress, ppc]
        yield from (Run(method, name, material, n, ppc, stress=stress) for n in CELLS if n <= most)


def variants() -> Iterator[Run]:
    """Runs of the table of variants.py: CPDI with 4 per cell, one axis not as usual."""
    for solution in VARIED:
        name = canonical(SOLUTIONS, solution)
        material = canonical(MATERIALS, create(SOLUTIONS, name).material)
        for beside, n in product(VARIANTS, CELLS):
            if n <= MOST["usl", 4]:
                yield replace(Run("cpdi", name, material, n, 4), **beside)


def record(target: Path, of: Sequence[str], made: Iterable[Run]) -> None:
    """Run all and write a table, with the fields of a run that a row is of; a run that fails has no row."""
    from mpm_verify.cases.mms.execute import execute

    with target.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow((*of, *QUANTITIES))
        for run in made:
            result = execute(run)[0]
            if result.status == "finished":
                errors = (f"{result.errors[quantity]['rms']:.5e}" for quantity in QUANTITIES)
                table.writerow((*(getattr(run, name) for name in of), *errors))
                file.flush()
            print(run, result.status, file=sys.stderr)


if __name__ == "__main__":
    record(TABLE, HEAD, runs())
    record(VARIANTS_TABLE, VARIANTS_HEAD, variants())
    record(rates.TABLE, rates.HEAD, rates.runs())
