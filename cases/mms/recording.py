"""Recording of errors: the table cases/mms/recorded.csv, made anew by `make recorded`.

Each row is one run of the usual scheme (FLIP, a Courant number of 0.4, staggered start) with its errors in rms, or the
same with the stress updated last after a second mapping of velocities (musl), which another code may do.
"""

import csv
import sys
from collections.abc import Iterator
from itertools import product
from pathlib import Path

from mpm_verify.cases.mms.deviations import DEVIATIONS, SMALL_AMPLITUDE
from mpm_verify.cases.mms.expectations import registered
from mpm_verify.cases.mms.recorded import TABLE
from mpm_verify.cases.mms.run import QUANTITIES, Run
from mpm_verify.solver.plugins import MATERIALS, METHODS, SOLUTIONS, available, canonical, create

HEAD = ("solution", "method", "stress", "ppc", "cells", *QUANTITIES)
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


def record(target: Path = TABLE) -> None:
    """Run all and write the table; a run that fails has no row."""
    from mpm_verify.cases.mms.execute import execute

    with target.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(HEAD)
        for run in runs():
            result = execute(run)[0]
            if result.status == "finished":
                errors = (f"{result.errors[quantity]['rms']:.5e}" for quantity in QUANTITIES)
                table.writerow((run.solution, run.method, run.stress, run.ppc, run.cells, *errors))
                file.flush()
            print(run, run.stress, result.status, file=sys.stderr)


if __name__ == "__main__":
    record()
