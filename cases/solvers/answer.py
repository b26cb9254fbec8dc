"""Answer of somebody else's solver: files of frames, matched to the particles of the case.

result_<step>.csv (or .tsv, .npz, .vtu) has a row a particle, in any order: `id`, or the reference position `X`, `Y`;
`x`, `y`; and any of `vx vy`, `Fxx Fxy Fyx Fyy`, `sxx syy szz sxy`. In three dimensions there are `Z`, `z`, `vz`, nine
components of F, and `syz sxz`; in one `X`, `x`, `vx`, `Fxx` and `sxx`; in axisymmetry `Fzz` too. result.json says which
time level a field has.
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.cases.solvers.components import QUANTITIES
from mpm_verify.cases.solvers.digits import last_digits, rounding
from mpm_verify.cases.solvers.matching import matched
from mpm_verify.cases.solvers.precision import single
from mpm_verify.cases.solvers.readers import ENDINGS, table, word
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.state import Floats

HUGE = 1e70  # values whose fourth powers are still finite


@dataclass(frozen=True)
class Frame:
    """Frame: x (P,d) and what else there is of v (P,d), F (P,d*d), sigma (P,4 or 6), X (P,d) and volume V (P,1).

    In axisymmetry F is (P,5), see `around`.

    Rows are in the order of the case. `last` are the values of the last digits of the numbers in the file, as `fields`.
    Where nothing `moves` those of x tell of the start, and not of the digits that are written.
    """

    fields: dict[str, Floats]
    last: dict[str, Floats] = field(default_factory=dict)
    moves: bool = True

    @cached_property
    def resolution(self) -> dict[str, float]:
        """Rounding of the numbers in the file by quantity, standard deviation in their units."""
        told = {name: last for name, last in self.last.items() if name != "x" or self.moves}
        return {name: sqrt(sum(rounding(one) ** 2 for one in last.T)) for name, last in told.items()}


def around(frame: Frame) -> Frame:
    """Frame of an axisymmetric case: F has the hoop stretch as its fifth component, and is not there without it."""
    kept, last = (_with_hoop(columns) for columns in (frame.fields, frame.last))
    return Frame(kept, last, frame.moves)


def _with_hoop(columns: dict[str, Floats]) -> dict[str, Floats]:
    """Columns with F (P,5) of F and Fzz, and without both where one is missing."""
    kept = {name: values for name, values in columns.items() if name not in ("F", "Fzz")}
    if columns.keys() >= {"F", "Fzz"}:
        kept["F"] = np.hstack([columns["F"], columns["Fzz"]])
    return kept


def read(out: Path, step: int, X: Floats, spacing: float) -> Frame:
    """Read the frame of a step.

    Parameters
    ----------
    out
        Folder of the answer.
    step
        Number of the step.
    X
        Reference positions (P,d) of the case.
    spacing
        Distance of particles, a length.

    Returns
    -------
    Frame
        Fields in the order of X.

    Raises
    ------
    RunFailed
        NO_ANSWER, UNREADABLE, NO_COLUMN, PARTICLES or NOT_FINITE, with the file, and the column or the numbers.
    """
    path = next((path for path in (out / f"result_{step}.{ending}" for ending in ENDINGS) if path.exists()), None)
    if path is None:
        raise RunFailed(FailureKind.NO_ANSWER, step, names={"file": f"result_{step}.csv"})
    return framed(table(path, step, X.shape[1]), X, spacing, path.name, step)


def framed(
    columns: dict[str, Any], X: Floats, spacing: float, file: str, step: int, last: dict[str, Floats] | None = None
) -> Frame:
    """Frame of columns, in the order of X (P,d), with these last digits or those that they show. Raises RunFailed."""
    quantities = QUANTITIES[X.shape[1]]
    try:
        numbers = {name: np.asarray(values, dtype=np.float64) for name, values in columns.items()}
        last = last_digits(columns) if last is None else last
    except (ValueError, TypeError):
        raise RunFailed(FailureKind.UNREADABLE, step, names={"file": file} | word(columns)) from None
    if len({len(values) for values in numbers.values()}) > 1 or not numbers:
        raise RunFailed(FailureKind.UNREADABLE, step, names={"file": file})
    for name in quantities["x"]:
        if name not in numbers:
            raise RunFailed(FailureKind.NO_COLUMN, step, names={"file": file, "column": name})
    order = matched(numbers, X, spacing, file, step)
    found, digits = {}, {}
    for quantity, names in quantities.items():
        if not all(name in numbers for name in names):
            continue
        values = np.stack([numbers[name] for name in names], axis=-1)[order]
        if not np.isfinite(values).all():
            particle = int(np.argwhere(~np.isfinite(values).all(axis=1))[0, 0])
            raise RunFailed(FailureKind.NOT_FINITE, step, particle, names={"file": file})
        if (largest := float(np.abs(values).max(initial=0.0))) > HUGE:
            particle = int(np.abs(values).max(axis=1).argmax())
            raise RunFailed(FailureKind.NOT_FINITE, step, particle, numbers={"value": largest}, names={"file": file})
        found[quantity] = values
        told = np.stack([last.get(name, np.zeros(len(order)))[order] for name in names], axis=-1)
        digits[quantity] = np.maximum(told, single(values))
    return Frame(found, digits)
