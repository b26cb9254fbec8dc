"""Matching of the rows of an answer with the particles of the case, by number or by reference position."""

from typing import Any

import numpy as np

from mpm_verify.mms.components import AXES
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.state import Floats

NEAR = 1e-3  # spacings: how far a reference position may be from that of its particle


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
