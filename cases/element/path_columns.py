"""Columns of a path's file by their names: strains, stresses and components of F, their units, and what is neither.

Each component, xx, yy, xy and zz, has a column of strain (or F), of stress, or both; zz may have none, which is plane
strain. What looks like a strain or stress and is not taken is refused, unless it is a strain that is zero throughout.
"""

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path as File
from typing import Literal, get_args

from mpm_verify.cases.harness import sheet as written

Units = Literal["percent", "fraction"]
TAKEN = "exx, eyy, and exy or gxy = 2 exy"
MORE = "stresses sxx, syy, sxy, szz in place of strains, ezz, or a motion Fxx, Fxy, Fyx, Fyy, Fzz"
UNITS = {
    **dict.fromkeys(("%", "pct", "percent", "per cent", "per_cent"), "percent"),
    **dict.fromkeys(("-", "1", "m/m", "mm/mm", "fraction"), "fraction"),
    "": "",
}
STRESSES = {"": 1.0, "pa": 1.0, "kpa": 1e3, "mpa": 1e6}  # a bare stress is in the unit of E
UNIT = re.compile(r"(.*?)[\s_]*(?:[\[(<]\s*(.*?)\s*[\])>]|(?:in\s+|/\s*)?(%|pct|percent|per[ _]cent))")
AXES = r"([xyz]{1,2}|[rtz]{2}|[123]{2})"
STRAIN = re.compile(
    rf"(d|log|ln|true|total)?[\s_]*(e|eps|epsilon|\u03b5|\u03f5|g|gam|gamma|\u03b3|strain)[\s_.]*{AXES}"
)
STRESS = re.compile(rf"(s|sig|sigma|\u03c3|tau|\u03c4|stress)[\s_.]*{AXES}")
GRADIENT = re.compile(r"f[\s_.]*([xyz]{2}|[123]{2})")
NO_PLANE = re.compile(r".*(z|3).?")  # the index of a strain that plane strain has not
COMPONENTS = ("xx", "yy", "xy", "zz", "yx")  # as they stand in a state; yx is of F alone
INDICES = {"11": "xx", "22": "yy", "12": "xy", "33": "zz", "21": "yx"}


@dataclass(frozen=True)
class Sheet:
    """Sheet of columns by name and unit (as UNITS has it, or as it is written), and rows with their line."""

    path: File
    names: tuple[str, ...]
    units: tuple[str, ...]
    rows: list[tuple[int, list[str]]]

    @property
    def motion(self) -> bool:
        """Whether it has components of F."""
        return any(name in COLUMNS["F"] for name in self.names)

    @property
    def kind(self) -> str:
        """Key of COLUMNS for what stands where strains do."""
        return "F" if self.motion else "strain"

    @property
    def used(self) -> tuple[str, ...]:
        """Names of the columns that are taken, strains or F first."""
        known = (*COLUMNS[self.kind], *COLUMNS["stress"])
        return tuple(name for name in known if name in self.names and name not in zero(self))

    def empty(self, name: str) -> bool:
        """Whether some cell of a column is empty."""
        at = self.names.index(name)
        return any(not cells[at] for _, cells in self.rows)


COLUMNS = {  # by name, the component
    "strain": {"exx": "xx", "eyy": "yy", "exy": "xy", "gxy": "xy", "ezz": "zz"},
    "stress": {"sxx": "xx", "syy": "yy", "sxy": "xy", "szz": "zz"},
    "F": {f"f{axes}": axes for axes in COMPONENTS},
}


def read(path: File) -> Sheet:
    """Read the file as columns and rows, none of them ragged, with names that are known. Raises ValueError."""
    found = written.read(path, f"a header with {TAKEN}, and rows below it")
    names, units = zip(*map(named, found.header), strict=True)
    sheet = Sheet(path, names, units, found.rows)
    check_names(sheet)
    return sheet


def named(header: str) -> tuple[str, str]:
    """Name and unit of a column, in lower case; the unit as UNITS has it, or as it is written."""
    text = header.strip(written.BLANK).lower()
    found = UNIT.fullmatch(text)
    unit = "" if found is None else (found[3] if found[2] is None else found[2])
    name = text if found is None else found[1]
    gradient = GRADIENT.fullmatch(name)
    if gradient and INDICES.get(gradient[1], gradient[1]) in COMPONENTS:
        name = f"f{INDICES.get(gradient[1], gradient[1])}"
    return name, UNITS.get(unit, unit)


def number(cell: str) -> float | None:
    """Number in a cell, the sign of per cent left out; None where there is none."""
    return written.number(cell.removesuffix("%"))


def check_names(sheet: Sheet) -> None:
    """Raise ValueError unless each component has its column, once, and no strain or stress is left over."""
    path, names = sheet.path, sheet.names
    if {"exy", "gxy"} <= set(names):
        raise ValueError(f"{path} has both exy and gxy = 2 exy; leave one out")
    strains = [name for name in COLUMNS["strain"] if name in names]
    if sheet.motion and strains:
        raise ValueError(f"{path} has both the strain {strains[0]} and components of F; leave one of them out")
    have = {COLUMNS[kind][name] for kind in (sheet.kind, "stress") for name in names if name in COLUMNS[kind]}
    missing = {*COMPONENTS[:3], *(["yx"] if sheet.motion else [])} - have
    if missing:
        needed = "Fxx, Fxy, Fyx and Fyy" if sheet.motion else TAKEN
        raise ValueError(
            f"{path} must have a header with {needed}, and rows below it, or {MORE}; "
            f"its first line has {', '.join(names)[:60]}"
        )
    twice = [name for name, count in Counter(names).items() if count > 1 and name]
    if twice:
        raise ValueError(f"{path} has two columns {twice[0]}; leave one out")
    check_strange(sheet)


def check_strange(sheet: Sheet) -> None:
    """Raise ValueError for a strain, stress or component of F that would not be used."""
    known = {name for kind in COLUMNS.values() for name in kind}
    for name in sheet.names:
        what = next((word for word, rule in KINDS.items() if rule.fullmatch(name)), "")
        if what and name not in known and name not in zero(sheet):
            raise ValueError(
                f"{sheet.path}: the {what} {name} would not be used: taken are {TAKEN}, or {MORE}; no shear out of the "
                f"plane; leave the column out, or rename it if it is not a {what}"
            )


KINDS = {"strain": STRAIN, "stress": STRESS, "component": GRADIENT}


def check_units(sheet: Sheet, units: str) -> None:
    """Raise ValueError for a unit that is not known, that contradicts --units, or that only some strains have."""
    pairs = list(zip(sheet.names, sheet.units, strict=True))
    for name, unit in pairs:
        if name in COLUMNS["stress"] and unit.lower() not in STRESSES:
            raise ValueError(f"{sheet.path}: {name} is in {unit}; stresses are taken in [Pa], [kPa] or [MPa]")
        if name in COLUMNS["F"] and unit not in ("", "fraction"):
            raise ValueError(f"{sheet.path}: {name} is in {unit}; components of F have no unit")
    said = {name: unit for name, unit in pairs if name in COLUMNS["strain"]}
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
    """Strains out of the plane that are zero in every row: they say what plane strain says, where no szz is given."""
    out = []
    for at, name in enumerate(sheet.names):
        found = STRAIN.fullmatch(name)
        flat = found and NO_PLANE.fullmatch(found[3]) and all(number(cells[at]) == 0 for _, cells in sheet.rows)
        if flat and not (name == "ezz" and "szz" in sheet.names):
            out.append(name)
    return tuple(out)


def unused(sheet: Sheet) -> tuple[str, ...]:
    """Columns that are not taken, by name or number; one without name and content is nobody's."""
    kept, known = [], {name for kind in COLUMNS.values() for name in kind}
    for at, name in enumerate(sheet.names):
        if name not in known and not STRAIN.fullmatch(name):
            if name:
                kept.append(name)
            elif any(cells[at] for _, cells in sheet.rows):
                kept.append(f"column {at + 1} without a name")
    return tuple(kept)
