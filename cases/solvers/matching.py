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
            raise others(same, len(X), file, step, **wrong(given, len(X)))
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


def wrong(given: Floats, expected: int) -> dict[str, float]:
    """First of ids (n,) that is there `twice`, and first that no particle has, `other`; each where there is one."""
    ids, counts = np.unique(given[np.isfinite(given)], return_counts=True)
    strange = ids[~np.isin(ids, np.arange(expected))]
    return {name: float(found[0]) for name, found in (("twice", ids[counts > 1]), ("other", strange)) if len(found)}


def others(found: int, expected: int, file: str, step: int, **more: float) -> RunFailed:
    """Error of an answer that does not have the particles that were given."""
    numbers = {"found": float(found), "expected": float(expected)} | more
    return RunFailed(FailureKind.OTHER_PARTICLES, step, numbers=numbers, names={"file": file})
