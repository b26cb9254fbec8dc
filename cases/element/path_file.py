"""A strain path from a CSV file, as an element test of which all strains are given.

The header names the columns exx, eyy, and exy (of the tensor) or gxy = 2 exy, in any order and case, tension positive;
`exx [%]` or `exx_pct` is in per cent. How a file may look otherwise stands in cases/harness/sheet.py.
"""

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path as File
from typing import Literal, get_args

import numpy as np

from mpm_verify.cases.element.paths import XX, XY, YY, ElementTest, PathSource
from mpm_verify.cases.harness import sheet as written
from mpm_verify.solver.state import Floats

Units = Literal["percent", "fraction"]
TAKEN = "exx, eyy, and exy or gxy = 2 exy"
PLAUSIBLE, LARGEST = (
    0.5,
    10.0,
)  # of a strain: beyond the first it may be a percentage, beyond the second it is not a strain
UNITS = {
    **dict.fromkeys(("%", "pct", "percent", "per cent", "per_cent"), "percent"),
    **dict.fromkeys(("-", "1", "m/m", "mm/mm", "fraction"), "fraction"),
    "": "",
}
UNIT = re.compile(r"(.*?)[\s_]*(?:[\[(<]\s*(.*?)\s*[\])>]|(?:in\s+|/\s*)?(%|pct|percent|per[ _]cent))")
AXES = r"([xyz]{1,2}|[rtz]{2}|[123]{2})"
STRAIN = re.compile(
    rf"(d|log|ln|true|total)?[\s_]*(e|eps|epsilon|\u03b5|\u03f5|g|gam|gamma|\u03b3|strain)[\s_.]*{AXES}"
)
NO_PLANE = re.compile(r".*(z|3).?")  # the index of a strain that plane strain has not


@dataclass(frozen=True)
class Sheet:
    """Sheet of columns by name and unit ("percent", "fraction", "" where none is said), and rows with their line."""

    path: File
    names: tuple[str, ...]
    units: tuple[str, ...]
    rows: list[tuple[int, list[str]]]

    def column(self, name: str, units: str) -> Floats:
        """Strains (rows,) as fractions. Raises ValueError."""
        at = self.names.index(name)
        percent = (units or self.units[at]) == "percent"
        known = bool(units or self.units[at])
        return np.array([self.strain(line, name, cells[at], percent, known) for line, cells in self.rows])

    def strain(self, line: int, name: str, cell: str, percent: bool, known: bool) -> float:
        """Strain in a cell as a fraction; `known` says that its unit is stated. Raises ValueError for anything else."""
        where = f"{self.path}, line {line}: {name}"
        written = number(cell)
        if not cell:
            raise ValueError(f"{where} is empty; write a number in each row")
        if written is None:
            raise ValueError(f"{where} = {cell!r} must be a finite number")
        percent, known = percent or cell.endswith("%"), known or cell.endswith("%")
        value = written / (100.0 if percent else 1.0)
        if abs(value) > PLAUSIBLE and not known:
            meant = f"if it is meant as it is, --units fraction, up to {LARGEST:g}"
            raise ValueError(f"{where} = {cell} is a large strain: in per cent? Then add --units percent; {meant}")
        if not abs(value) <= LARGEST:
            raise ValueError(f"{where} = {cell} is a strain of {value:g}; write strains up to {LARGEST:g}")
        return value


def from_file(path: File, units: str = "") -> ElementTest:
    """Strain path of a CSV file, see above; `units`, "percent" or "fraction", is that of all its strains.

    The first row is where it starts. Raises ValueError with one line for what cannot be a path.
    """
    if units not in ("", *get_args(Units)):
        raise ValueError(f"--units {units} must be one of {', '.join(get_args(Units))}")
    sheet = read(path)
    shear = check_names(sheet)
    check_units(sheet, ("exx", "eyy", shear), units)
    if len(sheet.rows) < 2:
        raise ValueError(f"{path} must have two rows of strains at least")
    table = np.stack([sheet.column(name, units) for name in ("exx", "eyy", shear)], axis=1)
    table *= (1.0, 1.0, 0.5 if shear == "gxy" else 1.0)
    if not np.ptp(table, axis=0).any():
        raise ValueError(f"{path} must have strains that change")
    sheared = bool(np.ptp(table[:, 2]) > np.ptp(table[:, :2], axis=0).max())
    source = PathSource(path.name, ("exx", "eyy", shear), unused(sheet), zero(sheet), float(np.abs(table).max()))
    return ElementTest(
        "path", f"Strain path of {path.name}", (XX, YY, XY), 1.0, shear=sheared, points=table, source=source
    )


def read(path: File) -> Sheet:
    """Read the file as columns and rows, none of them ragged. Raises ValueError."""
    found = written.read(path, f"a header with {TAKEN}, and rows below it")
    names, units = zip(*map(named, found.header), strict=True)
    return Sheet(path, names, units, found.rows)


def named(header: str) -> tuple[str, str]:
    """Name and unit of a column, in lower case; the unit as UNITS has it, or as it is written."""
    text = header.strip(written.BLANK).lower()
    found = UNIT.fullmatch(text)
    unit = "" if found is None else (found[3] if found[2] is None else found[2])
    return text if found is None else found[1], UNITS.get(unit, unit)


def number(cell: str) -> float | None:
    """Number in a cell, the sign of per cent left out; None where there is none."""
    return written.number(cell.removesuffix("%"))


def check_names(sheet: Sheet) -> str:
    """Name of the shear column, exy or gxy. Raises ValueError unless the strains are there, once, and no others."""
    path, names = sheet.path, sheet.names
    if {"exy", "gxy"} <= set(names):
        raise ValueError(f"{path} has both exy and gxy = 2 exy; leave one out")
    shear = "gxy" if "gxy" in names else "exy"
    if not {"exx", "eyy", shear} <= set(names):
        raise ValueError(
            f"{path} must have a header with {TAKEN}, and rows below it; its first line has {', '.join(names)[:60]}"
        )
    twice = [name for name, count in Counter(names).items() if count > 1 and name]
    if twice:
        raise ValueError(f"{path} has two columns {twice[0]}; leave one out")
    strange = [name for name in names if STRAIN.fullmatch(name) and name not in ("exx", "eyy", shear)]
    for name in strange:
        if name not in zero(sheet):
            raise ValueError(
                f"{path}: the strain {name} would not be used: taken are {TAKEN}; plane strain has ezz = 0, and no "
                f"strain out of the plane; leave the column out, or rename it if it is not a strain"
            )
    return shear


def check_units(sheet: Sheet, used: tuple[str, ...], units: str) -> None:
    """Raise ValueError for a unit that is not known, that contradicts --units, or that only some strains have."""
    said = {name: unit for name, unit in zip(sheet.names, sheet.units, strict=True) if name in used}
    for name, unit in said.items():
        if unit not in ("", *get_args(Units)):
            raise ValueError(f"{sheet.path}: {name} is in {unit}; strains are taken in [%] or as fractions [-]")
        if units and unit not in ("", units):
            raise ValueError(f"{sheet.path}: {name} is in {unit} by its header, not in {units}; leave --units out")
    if "percent" in said.values() and "" in said.values() and not units:
        bare = next(name for name, unit in said.items() if not unit)
        raise ValueError(
            f"{sheet.path}: other strains are in per cent, and {bare} has no unit; write {bare} [%] or [-]"
        )


def zero(sheet: Sheet) -> tuple[str, ...]:
    """Strains out of the plane that are zero in every row: they say what plane strain says."""
    out = []
    for at, name in enumerate(sheet.names):
        found = STRAIN.fullmatch(name)
        if found and NO_PLANE.fullmatch(found[3]) and all(number(cells[at]) == 0 for _, cells in sheet.rows):
            out.append(name)
    return tuple(out)


def unused(sheet: Sheet) -> tuple[str, ...]:
    """Columns that are not strains, by name or number; one without name and content is nobody's."""
    kept = []
    for at, name in enumerate(sheet.names):
        if name not in ("exx", "eyy", "exy", "gxy") and not STRAIN.fullmatch(name):
            if name:
                kept.append(name)
            elif any(cells[at] for _, cells in sheet.rows):
                kept.append(f"column {at + 1} without a name")
    return tuple(kept)
