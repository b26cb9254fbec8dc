"""Readers of the files of an answer, by their ending: columns by name, as they are written."""

from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.cases.mms.external.components import spread
from mpm_verify.solver.failure import FailureKind, RunFailed

ENDINGS = ("csv", "tsv", "txt", "npz", "vtu")


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
    return spread({"x": np.asarray(read_.points)[:, :2], **data})
