"""Readers of the files of an answer, by their ending: columns by name, as they are written."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.cases.solvers.components import spread
from mpm_verify.solver.failure import FailureKind, RunFailed

ENDINGS = ("csv", "tsv", "txt", "npz", "vtu")
Columns = Mapping[str, Any]  # arrays (P,...) by name: texts or numbers, as they stand in the file


def table(path: Path, step: int, dimension: int = 2) -> dict[str, Any]:
    """Columns of a file by name, each of one component, of a case of a dimension. Raises RunFailed."""
    try:
        stored = dict({".npz": arrays, ".vtu": mesh}.get(path.suffix, text)(path))
        points = {"x": stored.pop("points")} if path.suffix == ".vtu" else {}
        return spread({**points, **stored}, dimension)
    except Exception as error:  # of three libraries, for anything that is not such a file
        raise RunFailed(FailureKind.UNREADABLE, step, names={"file": path.name} | why(path, error)) from None


def why(path: Path, error: Exception) -> dict[str, str]:
    """Code of the reason why a file cannot be read, empty, no_text or ragged, by `why`; nothing where it is another."""
    if path.is_file() and not path.read_bytes().strip():
        return {"why": "empty"}
    known = {"UnicodeDecodeError": "no_text", "ParserError": "ragged"}.get(type(error).__name__)
    return {"why": known} if known else {}


def word(columns: Columns) -> dict[str, str]:
    """First value that is not a number, by `word`, with its `column`; nothing where there is none."""
    for name, values in columns.items():
        for value in np.ravel(values):
            try:
                float(value)
            except (ValueError, TypeError):
                return {"why": "word", "word": ascii(str(value))[:40], "column": name}
    return {}


def text(path: Path) -> Columns:
    """Columns of a CSV or TSV file, or of one with spaces, as they are written."""
    import pandas as pd

    head = next((line for line in path.read_text(encoding="utf-8-sig").splitlines() if line.strip()), "")
    mark = next((mark for mark in ";\t," if mark in head), r"\s+")
    frame = pd.read_csv(path, sep=mark, dtype=str, encoding="utf-8-sig", skipinitialspace=True, index_col=False)
    names = [name.strip() for name in (head.split(mark) if mark != r"\s+" else head.split())]
    if len(set(names)) < len(names):
        raise ValueError("a column twice")
    return {str(name).strip().lstrip("# "): frame[name].fillna("nan").to_numpy(dtype=str) for name in frame.columns}


def arrays(path: Path) -> Columns:
    """Arrays of a .npz file."""
    with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
        found = {name: stored[name] for name in stored.files}
    if any(values.dtype.kind == "c" for values in found.values()):
        raise ValueError("complex numbers")
    return found


def mesh(path: Path) -> Columns:
    """Points of a .vtu or .vtk file, with the data of points, and of cells that are one point each."""
    import meshio

    read = (meshio.vtk if path.suffix == ".vtk" else meshio.vtu).read(str(path))  # meshio.read ends the process
    data = {name: np.asarray(values) for name, values in read.point_data.items()}
    corners = [np.asarray(block.data) for block in read.cells]
    if corners and all(points.ndim == 2 and points.shape[1] == 1 for points in corners):
        order = np.argsort(np.concatenate(corners)[:, 0])
        if len(order) == len(read.points):
            data = {name: np.concatenate(blocks)[order] for name, blocks in read.cell_data.items()} | data
    return {"points": np.asarray(read.points), **data}
