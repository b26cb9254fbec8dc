"""Table of stored digits, made anew: `python -m mpm_verify.cases.mms.digits.make FILE` runs all references.

Errors have six digits; a reference that cannot go on has the kind of its failure. It takes some ten minutes.
"""

import csv
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from mpm_verify.cases.mms.case import canonical
from mpm_verify.cases.mms.digits.compare import QUANTITIES, errors, rms
from mpm_verify.cases.mms.digits.reference import Scheme, laid_out, reference, run_frames, schemes
from mpm_verify.cases.mms.digits.table import CASES, CELLS, COURANT, FILE, HEAD, PPC, Case
from mpm_verify.cases.mms.exact import manufactured
from mpm_verify.cases.mms.run import Run
from mpm_verify.solver._jit import use_threads

DIGITS = 6


def row(case: Case, scheme: Scheme) -> dict[str, str]:
    """Row of a reference in a case: it is run."""
    named = canonical({"solution": case.solution})
    run = reference(Run(**named, cells=case.cells, ppc=PPC, courant=COURANT), scheme)
    found = {"solution": run.solution, "method": scheme.method, "stress": scheme.stress, "transfer": scheme.transfer,
             "cells": str(case.cells)}  # fmt: skip
    answer = run_frames(run)
    if answer.failure:
        return found | dict.fromkeys(QUANTITIES, "") | {"failed": str(answer.failure.kind)}
    layout, dt = laid_out(run)
    exact = manufactured(run.solution, run.material)
    parts = errors(exact, layout.X, dt, answer.frames, answer.told)
    return found | {q: f"{rms(error, layout.V0):.{DIGITS - 1}e}" for q, error in parts.items()} | {"failed": ""}


def rows(cases: Iterable[Case], chosen: Iterable[Scheme]) -> Iterator[dict[str, str]]:
    """Rows of all schemes in all cases."""
    every = tuple(chosen)
    for case in cases:
        for scheme in every:
            yield row(case, scheme)


def main(file: Path = FILE) -> None:
    """Write the table."""
    use_threads(1)
    cases = [Case(solution, cells) for solution in CASES for cells in CELLS]
    with file.open("w", encoding="utf-8", newline="") as out:
        writer = csv.DictWriter(out, HEAD, lineterminator="\n")
        writer.writeheader()
        for one in rows(cases, schemes()):
            writer.writerow(one)
            out.flush()


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
