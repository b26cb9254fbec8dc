"""Answer of somebody else's solver: files of frames, matched to the particles of the case.

result_<step>.csv (or .tsv, .npz, .vtu) has a row a particle, in any order: `id`, or the reference position `X`, `Y`;
`x`, `y`; and any of `vx vy`, `Fxx Fxy Fyx Fyy`, `sxx syy szz sxy`. In three dimensions there are `Z`, `z`, `vz`, nine
components of F, and `syz sxz`. result.json says which time level a field has.
"""

import json
from dataclasses import dataclass, field
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.cases.mms.external.components import NAMES, QUANTITIES, UPPER
from mpm_verify.cases.mms.external.precision import single
from mpm_verify.mms.components import AXES
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.state import Floats

ENDINGS = ("csv", "tsv", "txt", "npz", "vtu")
NEAR = 1e-3  # spacings: how far a reference position may be from that of its particle
LEVELS = {"v_lag": 0.5, "F_lag": 0.0}  # steps that v and F with sigma are behind x, where result.json does not say
SAMPLE = 200  # numbers that the digits of a file are told from


@dataclass(frozen=True)
class Frame:
    """Frame: x (P,d) and what else there is of v (P,d), F (P,d*d) and sigma (P,4 or 6), in the order of the case.

    `resolution` is the rounding of the numbers in the file by quantity, standard deviation in their units.
    """

    fields: dict[str, Floats]
    resolution: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Levels:
    """Time levels of an answer: steps that v, and F with sigma, are behind x; and what it calls its version."""

    v_lag: float = LEVELS["v_lag"]
    F_lag: float = LEVELS["F_lag"]
    version: str = ""


def levels(out: Path) -> Levels:
    """Time levels that result.json tells; the usual ones where there is no such file. Raises RunFailed."""
    path = out / "result.json"
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return Levels()
    except (OSError, ValueError, RecursionError):
        raise RunFailed(FailureKind.UNREADABLE, -1, names={"file": path.name}) from None
    return stated(data, path.name)


def stated(data: Any, file: str) -> Levels:
    """Time levels of a mapping. Raises RunFailed for what is none."""
    try:
        told = {key: float(data[key]) for key in LEVELS if key in data}
        if not all(abs(lag) <= 2 for lag in told.values()):
            raise ValueError
        return Levels(**told, version=str(data.get("version", ""))[:80])
    except (ValueError, TypeError, AttributeError):
        raise RunFailed(FailureKind.UNREADABLE, -1, names={"file": file}) from None


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
    return framed(table(path, step), X, spacing, path.name, step)


def framed(columns: dict[str, Any], X: Floats, spacing: float, file: str, step: int) -> Frame:
    """Frame of columns as they were written, in the order of X (P,d). Raises RunFailed."""
    quantities = QUANTITIES[X.shape[1]]
    try:
        numbers = {name: np.asarray(values, dtype=np.float64) for name, values in columns.items()}
        resolution = rounding(columns)
    except (ValueError, TypeError):
        raise RunFailed(FailureKind.UNREADABLE, step, names={"file": file}) from None
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
        found[quantity] = values
        told = float(np.sqrt(sum(resolution.get(name, 0.0) ** 2 for name in names)))
        digits[quantity] = max(told, single(values))
    return Frame(found, digits)


def table(path: Path, step: int) -> dict[str, Any]:
    """Columns of a file by name, as they are written. Raises RunFailed."""
    try:
        return {".npz": arrays, ".vtu": mesh}.get(path.suffix, text)(path)
    except Exception:  # of three libraries, for anything that is not such a file
        raise RunFailed(FailureKind.UNREADABLE, step, names={"file": path.name}) from None


def text(path: Path) -> dict[str, Any]:
    """Columns of a CSV or TSV file, as they are written."""
    import pandas as pd

    head = next((line for line in path.read_text(encoding="utf-8-sig").splitlines() if line.strip()), "")
    mark = next((mark for mark in ";\t," if mark in head), r"\s+")
    frame = pd.read_csv(path, sep=mark, dtype=str, encoding="utf-8-sig", skipinitialspace=True, index_col=False)
    return {str(name).strip().lstrip("# "): frame[name].fillna("nan").to_numpy(dtype=str) for name in frame.columns}


def arrays(path: Path) -> dict[str, Any]:
    """Columns of a .npz file: one array a column, or arrays X, x, v, F, sigma of several."""
    with np.load(path, allow_pickle=False) as stored:
        return spread({name: stored[name] for name in stored.files})


def mesh(path: Path) -> dict[str, Any]:
    """Columns of a .vtu file: its points are x, its point data the rest."""
    import meshio

    read_ = meshio.read(path)
    data = {name: np.asarray(values) for name, values in read_.point_data.items()}
    return spread({"x": np.asarray(read_.points), **data})


def spread(stored: dict[str, Any]) -> dict[str, Any]:
    """Columns of arrays by name; X, x, v, F and sigma may hold all their components."""
    found: dict[str, Any] = {}
    for name, values in stored.items():
        if values.ndim == 1 or name not in {one for one, _ in NAMES}:
            found[name] = values
            continue
        flat = values.reshape(len(values), -1)
        if name == "sigma" and flat.shape[1] == 9:
            flat = flat[:, UPPER]
        if (name, flat.shape[1]) not in NAMES:
            raise ValueError(name)
        parts = NAMES[name, flat.shape[1]]
        found |= {part: flat[:, k] for k, part in enumerate(parts)}
    return found


def matched(columns: dict[str, Floats], X: Floats, spacing: float, file: str, step: int) -> Any:
    """Row of each particle of the case, (P,). Raises RunFailed where rows are missing, too many or others."""
    rows = len(columns["x"])
    if rows != len(X):
        raise RunFailed(
            FailureKind.OTHER_PARTICLES, step, numbers={"found": rows, "expected": len(X)}, names={"file": file}
        )
    if "id" in columns:
        given = columns["id"]
        order = np.argsort(given, kind="stable")
        if not np.array_equal(given[order], np.arange(len(X))):
            same = len(np.unique(given[np.isin(given, np.arange(len(X)))]))
            raise others(same, len(X), file, step)
        return order
    axes = AXES[: X.shape[1]].upper()
    if not set(axes) <= columns.keys():
        raise RunFailed(FailureKind.NO_COLUMN, step, names={"file": file, "column": "id"})
    from scipy.spatial import cKDTree

    given = np.stack([columns[axis] for axis in axes], axis=-1)
    if not np.isfinite(given).all():
        raise RunFailed(FailureKind.NOT_FINITE, step, names={"file": file})
    distance, order = cKDTree(given).query(X)
    near = distance < NEAR * spacing
    same = len(np.unique(order[near]))
    if same != len(X):
        raise RunFailed(
            FailureKind.OTHER_PARTICLES, step, numbers={"found": same, "expected": len(X)}, names={"file": file}
        )
    return order


def others(found: int, expected: int, file: str, step: int) -> RunFailed:
    """Error of an answer that does not have the particles that were given."""
    numbers = {"found": float(found), "expected": float(expected)}
    return RunFailed(FailureKind.OTHER_PARTICLES, step, numbers=numbers, names={"file": file})


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
        if number.is_finite() and number != 0:
            found.append((number, "e" in word.lower() or "d" in word.lower()))
    return found
