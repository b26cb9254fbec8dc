"""A path from a CSV file, as an element test: strains, stresses, both in turns, or a motion.

Rows are corners, and the first is the start: its stresses are those at the start, and strains count from its own. The
header names columns, in any order and case, tension positive:
    exx, eyy, exy (of the tensor) or gxy = 2 exy    strains; `exx [%]` or `exx_pct` is in per cent
    ezz                                             strain out of the plane; without it, and szz, plane strain
    sxx, syy, sxy, szz                              stresses in place of strains, in the unit of E, or [kPa], [MPa]
    Fxx, Fxy, Fyx, Fyy, Fzz                         a motion in place of strains; Fzz is 1 where it is left out
Where a component has both columns, each row gives one of them and leaves the other cell empty. How a file may look
otherwise stands in cases/harness/sheet.py.
"""

from dataclasses import replace
from pathlib import Path as File
from typing import get_args

import numpy as np

from mpm_verify.cases.element.motion import UNIT
from mpm_verify.cases.element.path_columns import (
    COLUMNS,
    COMPONENTS,
    STRESSES,
    Sheet,
    Units,
    check_units,
    number,
    read,
    unused,
    zero,
)
from mpm_verify.cases.element.paths import XX, XY, YY, ElementTest, PathSource
from mpm_verify.solver.state import Floats

PLAUSIBLE, LARGEST = (
    0.5,
    10.0,
)  # of a strain: beyond the first it may be a percentage, beyond the second it is not a strain


def from_file(path: File, units: str = "", motion: str = "none") -> ElementTest:
    """Path of a CSV file, see above; `units`, "percent" or "fraction", is that of all its strains.

    With `motion` = "simple_shear" strains are a motion, F = [[1, gxy], [0, 1]] diag(exp exx, exp eyy). Raises
    ValueError with one line for what cannot be a path.
    """
    if units not in ("", *get_args(Units)):
        raise ValueError(f"--units {units} must be one of {', '.join(get_args(Units))}")
    sheet = read(path)
    check_units(sheet, units)
    if len(sheet.rows) < 2:
        raise ValueError(f"{path} must have two rows of strains at least")
    points, targets = tables(sheet, units)
    given = points[np.isfinite(points)]
    source = PathSource(
        path.name, tuple(map(shown, sheet.used)), unused(sheet), zero(sheet), float(np.abs(given).max(initial=0.0)),
        tuple(line for line, _ in sheet.rows), tuple(name for name in sheet.used if name in COLUMNS["stress"]),
        "F" if sheet.motion else "",
    )  # fmt: skip
    if motion == "simple_shear" and not sheet.motion:
        if source.stresses:
            raise ValueError(f"{path} has stresses; a motion with stresses must have columns Fxx, Fxy, Fyx, Fyy")
        return moving(path, sheared(points), targets, source, "simple_shear")
    if sheet.motion:
        return moving(path, points, targets, source, "F")
    if not source.stresses:
        if not np.ptp(points, axis=0).any():
            raise ValueError(f"{path} must have strains that change")
        return strained(path, points, source)
    points = points - np.where(np.isfinite(points[0]), points[0], 0.0)
    return ElementTest("path", f"Path of {path.name}", (), 1.0, shear=shears(points), axial=points.shape[1] > 3,
                       points=points, targets=targets, source=source)  # fmt: skip


def shown(name: str) -> str:
    """Name of a column as it is written: Fxx."""
    return name.capitalize() if name in COLUMNS["F"] else name


def strained(path: File, points: Floats, source: PathSource) -> ElementTest:
    """Path of strains alone."""
    flat = points.shape[1] == 3
    return ElementTest(
        "path", f"Strain path of {path.name}", (XX, YY, XY) if flat else (), 1.0, shear=shears(points), axial=not flat,
        points=points, source=source,
    )  # fmt: skip


def moving(path: File, points: Floats, targets: Floats, source: PathSource, how: str) -> ElementTest:
    """Path of F; what the first row does not give is undeformed."""
    points, mixed = points.copy(), bool(source.stresses)
    points[0] = np.where(np.isfinite(points[0]), points[0], UNIT)
    for line, F, before in zip(source.lines, points, [points[0], *points], strict=False):
        J = least(before, F)  # not a number where a stress is given in place of one
        if J <= 0:
            raise ValueError(
                f"{path}, line {line}: F has the determinant {J:.3g} there or on its way; it must be above zero"
            )
    if not mixed and not np.ptp(points, axis=0).any():
        raise ValueError(f"{path} must have a motion: F that changes")
    return ElementTest(
        "path", f"Motion of {path.name}", (), 1.0, shear=shears(points), motion=True, points=points,
        targets=targets if mixed else np.zeros((0, 3)), source=replace(source, motion=how),
    )  # fmt: skip


def least(start: Floats, end: Floats) -> float:
    """Least determinant of F (5,) in the plane on the straight way, or of its zz."""
    d = end - start
    a, b = d[0] * d[1] - d[2] * d[4], start[0] * d[1] + d[0] * start[1] - start[2] * d[4] - d[2] * start[4]
    turn = -b / (2 * a) if a > 0 else 1.0
    at = [start + t * d for t in (0.0, min(max(turn, 0.0), 1.0), 1.0)]
    return float(min(*(F[0] * F[1] - F[2] * F[4] for F in at), start[3], end[3]))


def shears(points: Floats) -> bool:
    """Whether shear goes farther than the other components in the plane, where it is given; of F along x alone."""
    apart = np.ptp(np.where(np.isfinite(points), points, points[0]), axis=0)
    along_x = len(apart) < 5 or not (apart[4] or points[0, 4] or np.nanmin(points[:, :2]) <= 0)
    return bool(along_x and apart[2] > np.nanmax(apart[:2], initial=0.0))


def sheared(strains: Floats) -> Floats:
    """Motion (R,5) of strains (R,3) or (R,4): stretched by exp exx and exp eyy, then sheared by 2 exy along x."""
    xx, yy, xy, zz = np.column_stack([strains, np.zeros((len(strains), 4 - strains.shape[1]))]).T
    motion: Floats = np.column_stack([np.exp(xx), np.exp(yy), 2 * xy * np.exp(yy), np.exp(zz), 0 * xx])
    return motion


def tables(sheet: Sheet, units: str) -> tuple[Floats, Floats]:
    """Strains or F (R,n) and stresses (R,n) of the rows, not a number where a row gives the other one."""
    count = 5 if sheet.motion else (4 if {"ezz", "szz"} & set(sheet.used) else 3)
    points, targets = np.full((2, len(sheet.rows), count), np.nan)
    for name in sheet.used:
        kind = "stress" if name in COLUMNS["stress"] else sheet.kind
        at = COMPONENTS.index(COLUMNS[kind][name])
        (targets if kind == "stress" else points)[:, at] = column(sheet, name, kind, units)
    if sheet.motion and not {"fzz", "szz"} & set(sheet.used):
        points[:, 3] = 1.0
    if count == 4 and not {"ezz", "szz"} & set(sheet.used):
        points[:, 3] = 0.0
    check_rows(sheet, points, targets)
    return points, targets


def check_rows(sheet: Sheet, points: Floats, targets: Floats) -> None:
    """Raise ValueError where a row gives neither or both of a component; the first one may give both, or neither."""
    for row, (line, _) in enumerate(sheet.rows):
        for at in range(points.shape[1]):
            axes = COMPONENTS[at]
            strain, stress = (next((n for n in sheet.used if COLUMNS[kind].get(n) == axes), "")
                              for kind in (sheet.kind, "stress"))  # fmt: skip
            both = np.isfinite([points[row, at], targets[row, at]])
            if row and both.all():
                raise ValueError(f"{sheet.path}, line {line} gives both {strain} and {stress}; leave one of them empty")
            if not both.any() and (row or not (strain and stress)):
                other = f" or in {stress}" if strain and stress else " in each row"
                raise ValueError(f"{sheet.path}, line {line}: {strain or stress} is empty; write a number{other}")


def column(sheet: Sheet, name: str, kind: str, units: str) -> Floats:
    """Values (R,) of a column as fractions, or in the unit of E; not a number in empty cells. Raises ValueError."""
    at = sheet.names.index(name)
    unit = sheet.units[at]
    values = []
    for line, cells in sheet.rows:
        where, cell = f"{sheet.path}, line {line}: {name}", cells[at]
        written = number(cell)
        if cell and (written is None or (kind != "strain" and cell.endswith("%"))):
            raise ValueError(f"{where} = {cell!r} must be a finite number")
        if written is None:
            values.append(np.nan)
        elif kind == "strain":
            values.append(strain(where, cell, written, units or unit) * (0.5 if name == "gxy" else 1.0))
        else:
            values.append(written * (STRESSES[unit.lower()] if kind == "stress" else 1.0))
    return np.array(values)


def strain(where: str, cell: str, written: float, unit: str) -> float:
    """Strain in a cell as a fraction. Raises ValueError for one that may be a percentage, or is none."""
    percent, known = unit == "percent" or cell.endswith("%"), bool(unit) or cell.endswith("%")
    value = written / (100.0 if percent else 1.0)
    if abs(value) > PLAUSIBLE and not known:
        meant = f"if it is meant as it is, --units fraction, up to {LARGEST:g}"
        raise ValueError(f"{where} = {cell} is a large strain: in per cent? Then add --units percent; {meant}")
    if not abs(value) <= LARGEST:
        raise ValueError(f"{where} = {cell} is a strain of {value:g}; write strains up to {LARGEST:g}")
    return value
