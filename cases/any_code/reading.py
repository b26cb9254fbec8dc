"""A table of errors or values from a CSV, TSV or JSON file of any code: which column is what, and its rows.

JSON is a list of objects, one a row, or an object of columns. How a CSV file may look stands in cases/harness/sheet.py.
"""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import inf, isfinite
from pathlib import Path
from typing import Any

from mpm_verify.cases.any_code import sizes
from mpm_verify.cases.harness import sheet
from mpm_verify.cases.harness.sheet import Sheet

NORMS = ("l1", "l2", "linf", "l_inf", "h1", "rms", "rmse", "max")
ERRORS = ("error", "err", "e", *NORMS, *(f"{a}_{b}" for a, b in product(NORMS, ("error", "err", "norm"))),
          *(f"{a}_{b}" for a, b in product(("error", "err", "e"), NORMS)))  # fmt: skip
ROLES = {  # columns that are read: the name of each, and others that it may have
    "h": ("h", "dx", "delta_x", "\u03b4x", "spacing", "cell_size", "mesh_size", "grid_size", "element_size"),
    "cells": ("cells", "n", "nx", "ncells", "n_cells", "num_cells", "elements", "nel", "n_el", "resolution"),
    "error": ERRORS,
    "value": ("value", "val", "f", "phi", "\u03c6", "result"),
    "method": ("method", "scheme", "solver", "code", "basis"),
    "quantity": ("quantity", "variable", "field"),
    "replicate": ("replicate", "rep", "seed", "sample", "realization", "realisation"),
    "half_dt_error": ("half_dt_error", "error_half_dt", "dt_half_error", "half_dt", "dt_half"),
    "half_dt_value": ("half_dt_value", "value_half_dt", "dt_half_value", "half_dt", "dt_half"),
}
UNIT = re.compile(r"\s*(\[.*\]|\(.*\)|<.*>)\s*$")
FRACTION = re.compile(r"\s*(\d+)\s*/\s*(\d+)\s*")
BARE = {sign + word: float(sign + word) for sign in ("", "+", "-") for word in ("nan", "inf", "infinity")}
LEAST, MOST = 1, 5000  # rows
MANY = 1e15  # cells along a side: larger whole numbers have no next one


@dataclass(frozen=True)
class Row:
    """Row of a table: its line, what it is of, one over its cell size, its number, that with half the time step."""

    line: int
    method: str
    quantity: str
    cells: float
    replicate: str
    number: float
    half: float | None = None

    @property
    def h(self) -> float:
        """Cell size."""
        return 1 / self.cells


@dataclass(frozen=True)
class Table:
    """Table as it was read.

    Parameters
    ----------
    path
        The file.
    by
        `cells` or `h`: the column that sizes are in.
    rows
        Its rows in the order of the file.
    taken
        Role of each column that was read, and the column.
    unused
        Columns that were not read.
    word
        What a row is called in a complaint: line or row.
    """

    path: Path
    by: str
    rows: tuple[Row, ...]
    taken: dict[str, str]
    unused: tuple[str, ...]
    word: str = "line"


def read(path: Path, exact: bool = True) -> Table:
    """Read a table.

    Parameters
    ----------
    path
        CSV, TSV or JSON file.
    exact
        Whether its numbers are errors; otherwise they are values of a quantity.

    Returns
    -------
    Table
        Its rows, and which column was read as what.

    Raises
    ------
    ValueError
        One line that says what cannot be read, where, and what to write instead.
    """
    number = "error" if exact else "value"
    columns = f"cells or h, and {number}"
    needs = f"a header with {columns}, and a row for each level below it"
    text = sheet.decoded(path)
    as_json = path.suffix.lower() == ".json" or text.lstrip()[:1] in ("[", "{")
    found = of_json(path, text, columns) if as_json else sheet.columns(path, text, needs)
    taken = roles(found, number)
    if not LEAST <= len(found.rows) <= MOST:
        raise ValueError(f"{path} has {len(found.rows)} rows below its header, and must have 1 to {MOST}")
    word = "row" if as_json else "line"
    cells = Cells(found, taken, word)
    rows = tuple(row(cells, line, texts, number) for line, texts in found.rows)
    check_sizes(cells, found.rows)
    unused = tuple(name for at, name in enumerate(found.header) if at not in taken.values() and name)
    by = "h" if "h" in taken else "cells"
    return Table(path, by, rows, {role: found.header[at] for role, at in taken.items()}, unused, word)


def of_json(path: Path, text: str, needs: str) -> Sheet:
    """Sheet of a JSON text, its rows numbered from 1. Raises ValueError."""
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        where = f"line {error.lineno}: {error.msg}" if isinstance(error, json.JSONDecodeError) else "it nests too deep"
        raise ValueError(f"{path} cannot be read as JSON: {where.lower()}") from None
    if isinstance(data, dict) and data and all(isinstance(value, list) for value in data.values()):
        lengths = {name: len(value) for name, value in data.items()}
        if len(set(lengths.values())) > 1:
            told = ", ".join(f"{name} {length}" for name, length in lengths.items())
            raise ValueError(f"{path}: columns of different lengths ({told}); write one number a level in each")
        data = [dict(zip(data, values, strict=True)) for values in zip(*data.values(), strict=True)]
    if not isinstance(data, list) or not data or not all(isinstance(one, dict) for one in data):
        raise ValueError(f"{path} must be a list of objects, one a row, or an object of columns, with {needs}")
    names = list(dict.fromkeys(name for one in data for name in one))
    rows = [(at, [cell(path, at, name, one.get(name)) for name in names]) for at, one in enumerate(data, start=1)]
    return Sheet(path, tuple(names), rows)


def cell(path: Path, line: int, name: str, value: Any) -> str:
    """Text of a JSON value; empty for null. Raises ValueError for anything but numbers and texts."""
    if isinstance(value, bool | list | dict):
        raise ValueError(f"{path}, row {line}: {name} = {json.dumps(value)[:40]} must be a number or a text")
    return "" if value is None else str(value).strip()


def roles(found: Sheet, number: str) -> dict[str, int]:
    """Index of the column of each role. Raises ValueError where that is not clear."""
    names = [plain(name) for name in found.header]
    twice = next((name for name in names if name and names.count(name) > 1), None)
    if twice:
        raise ValueError(f"{found.path} has two columns {twice}; leave one out, or name it otherwise")
    taken = {}
    for role in ("h", "cells", number, "method", "quantity", "replicate", f"half_dt_{number}"):
        at = [k for k, name in enumerate(names) if name in ROLES[role]]
        at = [k for k in at if names[k] == role] or at
        if len(at) > 1:
            several = " and ".join(found.header[k] for k in at)
            raise ValueError(
                f"{found.path}: {several} could each be the column {role}; name one of them {role}, or "
                "put them below each other with a column quantity"
            )
        if at:
            taken[role] = at[0]
    if "h" in taken:
        taken.pop("cells", None)  # the size itself says more than a count
    left = [k for k, name in enumerate(names) if name and k not in taken.values() and name not in ROLES["cells"]]
    if number == "value" and number not in taken and len(left) == 1 and plain(found.header[left[0]]) not in ERRORS:
        taken[number] = left[0]  # a single column besides is the quantity by its own name
    missing = [role for role, lacks in {"cells or h": not {"h", "cells"} & taken.keys(),
                                        number: number not in taken}.items() if lacks]  # fmt: skip
    if missing:
        raise ValueError(lacking(found, names, missing, number))
    return taken


def lacking(found: Sheet, names: list[str], missing: list[str], number: str) -> str:
    """Line on columns that are missing, with those that are there and the names that are read."""
    there = ", ".join(name or "one without a name" for name in found.header)[:120]
    other = "value" if number == "error" else "error"
    more = ""
    if number in missing and set(names) & set(ROLES[other]):
        more = "; of values, not errors, add --no-exact" if number == "error" else "; of errors, leave --no-exact out"
    known = "; ".join(f"{role}: {', '.join(ROLES[role][:5])}" for role in ("cells", "h", number))
    return f"{found.path} has no column {' and no '.join(missing)}: found {there}; names that are read: {known}{more}"


def plain(header: str) -> str:
    """Name of a column in lower case, without its unit, words joined by _."""
    text = UNIT.sub("", header.strip(sheet.BLANK)).strip(sheet.BLANK).lower()
    return re.sub(r"[\s.:-]+", "_", text).strip("_") or text


@dataclass(frozen=True)
class Cells:
    """Cells of a sheet by role."""

    sheet: Sheet
    taken: dict[str, int]
    word: str

    def text(self, role: str, texts: list[str]) -> str:
        """Text in the cell, empty where there is no such column."""
        return texts[self.taken[role]].strip() if role in self.taken else ""

    def complaint(self, line: int, role: str, texts: list[str], must: str) -> ValueError:
        """Error of a cell: the line, the column, what stands there, and what must."""
        name, text = self.sheet.header[self.taken[role]], self.text(role, texts)
        there = f"= {text[:40]!r}" if text else "is empty;"
        return ValueError(f"{self.sheet.path}, {self.word} {line}: {name} {there} {must}")


def row(cells: Cells, line: int, texts: list[str], number: str) -> Row:
    """One row. Raises ValueError."""
    names = {role: cells.text(role, texts) for role in ("method", "quantity", "replicate")}
    for role in names.keys() & cells.taken.keys():
        if not names[role]:
            raise cells.complaint(line, role, texts, f"write the {role} in each row")
    found = measured(cells, line, texts, number)
    if found is None:
        raise cells.complaint(line, number, texts, "write a number, or nan for a run that failed")
    half = measured(cells, line, texts, f"half_dt_{number}")
    usual = UNIT.sub("", cells.sheet.header[cells.taken[number]]).strip(sheet.BLANK)
    size = level(cells, line, texts)
    return Row(line, names["method"] or "code", names["quantity"] or usual, size, names["replicate"], found, half)


def level(cells: Cells, line: int, texts: list[str]) -> float:
    """One over the cell size of a row. Raises ValueError unless the size is above zero, and cells are whole numbers."""
    role: str = "h" if "h" in cells.taken else "cells"
    text = cells.text(role, texts)
    if role == "cells":
        found = sheet.number(text)
        if found is None or "," in text or not 1 <= found <= MANY or found != int(found):
            must = "must be a whole number from 1 on, such as 16; sizes go into a column h"
            raise cells.complaint(line, role, texts, must)
        return found
    over = FRACTION.fullmatch(text)
    size = int(over[1]) / int(over[2]) if over and int(over[2]) else sheet.number(text)
    if size is None or not 0 < size < inf or not isfinite(1 / size):
        raise cells.complaint(line, role, texts, "must be a cell size above zero, such as 0.0625 or 1/16")
    return 1 / size


def check_sizes(cells: Cells, rows: Sequence[tuple[int, list[str]]]) -> None:
    """Raise ValueError where a column of cells, which is not read beside h, says another size than h does."""
    names = [plain(name) for name in cells.sheet.header]
    at = next((k for k, name in enumerate(names) if name in sizes.CELLS), None)
    if at is None or "h" not in cells.taken:
        return
    refined: dict[tuple[str, str], list[tuple[int, list[str], float]]] = {}
    for line, texts in rows:
        count = sheet.number(texts[at])
        if count and 0 < count < inf:
            key = cells.text("method", texts), cells.text("quantity", texts)
            refined.setdefault(key, []).append((line, texts, count))
    for known in refined.values():
        if found := sizes.apart([(1 / level(cells, line, texts), count) for line, texts, count in known]):
            line, texts, _ = known[found[0]]
            name, of = cells.sheet.header[at], ("h", "h^2", "h^3")[found[1] - 1]
            usual = f"{of} times {name} is {found[2]:.3g} elsewhere; mend one, or leave a column out"
            raise cells.complaint(line, "h", texts, f"and {name} = {texts[at].strip()} contradict each other: {usual}")


def measured(cells: Cells, line: int, texts: list[str], role: str) -> float | None:
    """Number in a cell, that of nan and inf too; None where it is empty. Raises ValueError for a text or a sign."""
    text = cells.text(role, texts)
    if not text:
        return None
    found = BARE.get(text.lower().removesuffix("(ind)"), sheet.number(text))  # nan(ind): a C library has it so
    if found is None:
        raise cells.complaint(line, role, texts, "must be a number, or nan for a run that failed")
    if role.endswith("error") and found < 0:
        raise cells.complaint(line, role, texts, "must not be negative: an error is a norm; write its absolute value")
    return found
