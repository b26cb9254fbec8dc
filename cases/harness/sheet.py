"""Sheet of cells from a text file of columns, as spreadsheets and codes write them.

Columns stand between semicolons, tabs, commas or spaces, whichever the header has first in this order; a decimal comma
is taken where commas do not separate. `#` begins a comment; where the first row is of numbers, the comment above it is
the header. Byte-order marks, blank lines, line ends of any system and the `sep=` of a spreadsheet are passed over.
"""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

MARKS = ";\t,"
BLANK = " \t,;\"'"
NOT_FINITE = re.compile(r"\b(nan|inf|infinity)\b", re.IGNORECASE)
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([edED][+-]?\d+)?", re.ASCII)


@dataclass(frozen=True)
class Sheet:
    """Sheet as it is written: cells of the header, and rows, each with its line from 1 and as many cells."""

    path: Path
    header: tuple[str, ...]
    rows: list[tuple[int, list[str]]]


def read(path: Path, needs: str) -> Sheet:
    """Read a file of columns.

    Parameters
    ----------
    path
        CSV or TSV in UTF-8.
    needs
        What a file must have, for one that has nothing.

    Returns
    -------
    Sheet
        Header and rows, none of them ragged.

    Raises
    ------
    ValueError
        One line that says what cannot be read, with its line.
    """
    return columns(path, decoded(path), needs)


def columns(path: Path, text: str, needs: str) -> Sheet:
    """Sheet of a text, see `read`."""
    lines = content(text)
    if not lines:
        raise ValueError(f"{path} must have {needs}")
    mark = next((mark for mark in MARKS if mark in lines[0][1]), " ")
    try:
        first, *rows = [(line, split(cells, mark)) for line, cells in lines]
    except csv.Error:
        raise ValueError(f"{path} is not CSV text; save it as CSV in UTF-8") from None
    for line, cells in rows:
        if len(cells) != len(first[1]):
            comma = "; where a comma is the decimal sign, semicolons must separate" if mark == "," else ""
            raise ValueError(f"{path}, line {line}: {len(cells)} cells, and the header has {len(first[1])}{comma}")
    return Sheet(path, tuple(first[1]), rows)


def decoded(path: Path) -> str:
    """Text of the file. Raises ValueError with what to save it as."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ValueError(f"{path}: {(error.strerror or str(error)).lower()}") from None
    if data[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\0" in data[:1000]:
        raise ValueError(f"{path} is UTF-16 text or not text; save it as CSV in UTF-8")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{path} is not CSV text in UTF-8; save it as CSV in UTF-8") from None


def content(text: str) -> list[tuple[int, str]]:
    """Lines that hold something, numbered from 1: the header first, which may be the last comment above numbers."""
    kept, comment = [], (0, "")
    for number, line in enumerate(re.split(r"\r\n|\r|\n", text), start=1):
        bare, _, remark = line.partition("#")
        if bare.strip(BLANK) and not re.fullmatch(r'"?sep=.?"?', bare.strip(" ")):  # what a spreadsheet writes first
            kept.append((number, bare.strip(" ")))
        elif remark and not kept:
            comment = (number, remark.strip(" "))
    numbers = kept and not re.search(r"[a-df-z]", NOT_FINITE.sub("", kept[0][1]), re.IGNORECASE)
    return [comment, *kept] if numbers and comment[1] else kept


def split(line: str, mark: str) -> list[str]:
    """Cells of a line, without the spaces around them."""
    if mark == " ":
        return re.sub(r"\s+(?=[\[(<%])", "", line).split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=mark, skipinitialspace=True))]


def number(cell: str) -> float | None:
    """Finite number in a cell, with a point or a comma, and e or d before the exponent; None where there is none."""
    text = cell.strip().replace("\N{MINUS SIGN}", "-")
    text = text if "." in text else text.replace(",", ".")
    return float(text.lower().replace("d", "e")) if NUMBER.fullmatch(text) else None
