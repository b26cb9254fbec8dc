"""A strain path from a CSV file, as an element test of which all strains are given."""

import csv
from math import isfinite
from pathlib import Path as File

import numpy as np

from mpm_verify.cases.element.paths import XX, XY, YY, ElementTest

LARGEST = 10.0  # a strain beyond is a slip of the pen, or a percentage


def from_file(path: File) -> ElementTest:
    """The strain path of a CSV file with the columns exx, eyy, exy (of the tensor) or gxy = 2 exy, tension positive.

    The first row is where it starts. Raises ValueError with one line for what cannot be a path.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file, skipinitialspace=True))
            names = tuple(name.strip() for name in (rows[0] if rows else {}) if name)
    except OSError as error:
        raise ValueError(f"{path}: {(error.strerror or str(error)).lower()}") from None
    except (UnicodeDecodeError, csv.Error):
        raise ValueError(f"{path} is no CSV text") from None
    shear = "gxy" if "gxy" in names else "exy"
    if not {"exx", "eyy", shear} <= set(names):
        raise ValueError(f"{path} must have a header with exx, eyy and exy (or gxy = 2 exy), and rows below it")
    points = [
        [number(path, line, row, name) for name in ("exx", "eyy", shear)] for line, row in enumerate(rows, start=2)
    ]
    if len(points) < 2:
        raise ValueError(f"{path} must have two rows of strains at least")
    table = np.array(points) * (1.0, 1.0, 0.5 if shear == "gxy" else 1.0)
    if not np.ptp(table, axis=0).any():
        raise ValueError(f"{path} must have strains that change")
    sheared = bool(np.ptp(table[:, 2]) > np.ptp(table[:, :2], axis=0).max())
    return ElementTest("path", f"strain path of {path.name}", (XX, YY, XY), 1.0, shear=sheared, points=table)


def number(path: File, line: int, row: dict[str, str | None], name: str) -> float:
    """A finite strain of one row."""
    text = {(key or "").strip(): value for key, value in row.items()}.get(name)
    try:
        value = float(text or "")
    except ValueError:
        raise ValueError(f"{path}, line {line}: {name} = {text!r} must be a number") from None
    if not isfinite(value) or abs(value) > LARGEST:
        raise ValueError(f"{path}, line {line}: {name} = {value} must be finite, and no percentage")
    return value
