"""Answer by a map of columns: the frames that it names, found by their numbers, with our columns made of theirs."""

import re
from collections.abc import Sequence
from math import inf, isfinite
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.cases.solvers.answer import Frame, framed
from mpm_verify.cases.solvers.column_map import KEEPS, ColumnMap
from mpm_verify.cases.solvers.components import spread
from mpm_verify.cases.solvers.digits import last_digits
from mpm_verify.cases.solvers.many import Frames, frames, split
from mpm_verify.cases.solvers.matching import matched
from mpm_verify.cases.solvers.readers import Columns, why, word
from mpm_verify.mms.components import AXES
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.state import Floats

ARRAYS = ("v", "F", "sigma")  # names of ours that are no columns
NEAR = 0.1  # steps: how far the time of a frame may be from that of its step; times are written with few digits


def read(out: Path, given: ColumnMap, steps: Sequence[int], dt: float, X: Floats, spacing: float) -> dict[int, Frame]:
    """Read the frames of some steps.

    Parameters
    ----------
    out
        Folder of the answer.
    given
        Files and columns.
    steps, dt
        Numbers of the steps, and the length of one.
    X
        Reference positions (P,d) of the case.
    spacing
        Distance of particles, a length.

    Returns
    -------
    dict
        Frames by step, in the order of X.

    Raises
    ------
    RunFailed
        NO_ANSWER, UNREADABLE, NO_COLUMN, PARTICLES or NOT_FINITE, with the file, and the column or the numbers.
    """
    found, whole = {}, None
    for index, step in enumerate(steps):
        numbers = {"step": step, "time": step * dt, "index": index + given.first}
        name, key = given.files.format(**numbers), given.key.format(**numbers)
        if given.apart:
            here = opened([out / name], given, key, step)
        else:
            here = whole = whole or opened(sorted(out.glob(name)), given, key, step)
        columns = chosen(here, given, numbers, dt, name, step)
        found[step] = translated(columns, given, X, spacing, name, step)
    return found


def opened(paths: Sequence[Path], given: ColumnMap, key: str, step: int) -> list[Any]:
    """Frames of some files, with their numbers. Raises RunFailed."""
    found: list[Any] = []
    for path in paths:
        if not path.is_file():
            raise RunFailed(FailureKind.NO_ANSWER, step, names={"file": path.name})
        try:
            mine: Frames = frames(path, given.format, key)
            if given.frame_column:
                mine = (one for _, load in mine for one in split(load(), given.frame_column))
            found += mine
        except KeyError as error:
            names = {"file": path.name, "column": str(error.args[0])}
            raise RunFailed(FailureKind.NO_COLUMN, step, names=names) from None
        except Exception as error:  # of several libraries, for anything that is not such a file
            raise RunFailed(FailureKind.UNREADABLE, step, names={"file": path.name} | why(path, error)) from None
    return found


def chosen(here: list[Any], given: ColumnMap, numbers: dict[str, Any], dt: float, file: str, step: int) -> Columns:
    """Columns of the frame of a step; the only one of a file of its own. Raises RunFailed."""
    wanted = numbers[given.frames]
    told = [(abs(number - wanted), k) for k, (number, _) in enumerate(here) if number is not None and isfinite(number)]
    alone = given.apart and len(here) == 1 and not given.frame_column
    gap, at = (0.0, 0) if alone else min(told, default=(inf, 0))
    if gap > (NEAR * dt if given.frames == "time" else 0):
        raise RunFailed(FailureKind.NO_ANSWER, step, names={"file": f"{given.frames} {wanted:g} in {file}"})
    try:
        columns: Columns = here[at][1]()
    except Exception:  # of several libraries, for anything that is not such a file
        raise RunFailed(FailureKind.UNREADABLE, step, names={"file": file}) from None
    return columns


def translated(columns: Columns, given: ColumnMap, X: Floats, spacing: float, file: str, step: int) -> Frame:
    """Frame of their columns, in the order of X (P,d). Raises RunFailed."""
    written: dict[str, Any] = {}
    for ours, column in given.columns.items():
        try:
            written |= {
                name: (values, column)
                for name, values in ours_of(ours, column.name, columns, given, X.shape[1]).items()
            }
        except LookupError:
            raise RunFailed(FailureKind.NO_COLUMN, step, names={"file": file, "column": column.name}) from None
        except ValueError:
            what = f"{column.name} with the components of {ours}"
            raise RunFailed(FailureKind.NO_COLUMN, step, names={"file": file, "column": what}) from None
    try:
        last = last_digits({name: values for name, (values, _) in written.items()})
        numbers = {name: column.factor * np.asarray(values, dtype=np.float64)
                   + (0.0 if isinstance(column.add, str) else column.add)
                   for name, (values, column) in written.items()}  # fmt: skip
    except (ValueError, TypeError):
        found = word({name: values for name, (values, _) in written.items()})
        raise RunFailed(FailureKind.UNREADABLE, step, names={"file": file} | found) from None
    last = {name: values * abs(written[name][1].factor) for name, values in last.items()}
    moved = {
        name: X[:, k]
        for k, name in enumerate(AXES[: X.shape[1]])
        if name in written and isinstance(written[name][1].add, str)
    }
    if moved and len({len(values) for values in numbers.values()}) == 1:
        order = matched(numbers, X, spacing, file, step)
        numbers = {name: values[order] + moved.get(name, 0.0) for name, values in numbers.items()}
        last = {name: values[order] for name, values in last.items()}
        numbers["id"] = np.arange(len(X), dtype=np.float64)
    return framed(numbers, X, spacing, file, step, last)


def ours_of(ours: str, theirs: str, columns: Columns, given: ColumnMap, dimension: int) -> dict[str, Any]:
    """Columns of ours, one component each, of a column of theirs. Raises KeyError, IndexError or ValueError."""
    if ours == "id" and theirs == KEEPS and KEEPS not in columns:
        return {ours: np.arange(len(next(iter(columns.values()))))}
    values = picked(theirs, columns)
    flat = values.reshape(len(values), -1)
    if flat.shape[1] == 1 and ours not in ARRAYS:
        return {ours: flat[:, 0]}
    if ours == "sigma" and given.sigma_order:
        return {f"s{part}": flat[:, k] for k, part in zip(range(flat.shape[1]), given.sigma_order, strict=True)}
    if ours == "F" and given.F_order == "column":
        side = round(flat.shape[1] ** 0.5)
        flat = flat.reshape(len(flat), side, side).transpose(0, 2, 1).reshape(len(flat), -1)
    found = spread({ours: flat}, dimension)
    if any(np.ndim(one) != 1 for one in found.values()):
        raise ValueError(ours)
    return found


def picked(name: str, columns: Columns) -> Any:
    """Column of a name, or a component name[k] of an array, which counts from 0. Raises KeyError or IndexError."""
    if name in columns:
        return np.asarray(columns[name])
    array = re.fullmatch(r"(.+)\[(\d+)\]", name)
    if array is None:
        raise KeyError(name)
    values = np.asarray(columns[array[1]])
    return values.reshape(len(values), -1)[:, int(array[2])]
