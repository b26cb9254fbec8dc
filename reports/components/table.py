"""Tables as text, and how they fit: columns that say one thing become a note, the width decides how they are shown."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

from mpm_verify.reports.components.latex import booktabs
from mpm_verify.reports.components.take import File, encoded

Row = tuple[str, ...]
LONG = 24  # characters from which on a cell is broken into lines, see the macro `cell` and `td.long`
BROKEN = 15  # characters that such a cell needs at least
SIZES = {"s": 325.0, "m": 680.0, "l": 950.0}  # pixels that a table of each size needs at most, see stacked.css.j2
SOME = 4  # rows, from which on what all of them say is said once


@dataclass(frozen=True)
class View:
    """Table as it is shown: its columns without those that say one thing, which the note has; rows in blocks.

    `leads` columns name a row; `size` is the least of SIZES into which it fits, `x` for none.
    """

    columns: Row
    leads: int
    blocks: tuple[tuple[str, tuple[Row, ...]], ...]
    note: str
    size: str


@dataclass(frozen=True)
class Table:
    """Table as text. `heads` row-heading columns come first; the others hold numbers, but those named in `texts`.

    Where it is `grouped`, the first column names blocks of rows, one below the other.
    """

    caption: str
    head: Row
    rows: tuple[Row, ...]
    heads: int = 1
    texts: Row = ()
    grouped: bool = False

    @cached_property
    def folded(self) -> View:
        """Table as it is shown."""
        first = int(self.grouped)
        every = [k for k in range(first, len(self.head)) if k < self.heads or any(row[k] for row in self.rows)]
        said = self._alike(every) if self._size(every) != "s" and len(self.rows) >= SOME else []
        kept = [k for k in every if k not in said]
        names = [(self.head[k], self.rows[0][k]) for k in said]
        note = "; ".join(f"{name} {value}" for name, value in names)
        blocks = groupby(self.rows, key=lambda row: row[0] if self.grouped else "")
        return View(
            tuple(self.head[k] for k in kept),
            max(0, self.heads - first),
            tuple((name, tuple(tuple(row[k] for k in kept) for row in rows)) for name, rows in blocks),
            f"In all rows: {note}." if note else "",
            self._size(kept),
        )

    def _alike(self, columns: Sequence[int]) -> list[int]:
        """Columns, not of the heads, that have one text in all rows; not all there are."""
        found = [k for k in columns if k >= self.heads and len({row[k] for row in self.rows}) == 1]
        return found if len(found) < len([k for k in columns if k >= self.heads]) else found[1:]

    def _size(self, columns: Sequence[int]) -> str:
        """Least of SIZES for these columns, by the characters that cannot be broken; `x` where there is none."""
        widths = [max(self._widths(k)) for k in columns]
        needed = {"s": sum(8.2 * w + 11.2 for w in widths)}
        needed |= dict.fromkeys("ml", sum(9.0 * w + 16.0 for w in widths))
        return next((size for size, most in SIZES.items() if needed[size] <= most), "x")

    def _widths(self, column: int) -> Iterator[int]:
        """Characters that the head of a column and each cell need in one line."""
        name = self.head[column]
        yield longest(name)
        wraps = column < self.heads or name in self.texts
        for text in (row[column] for row in self.rows):
            yield (
                longest(text)
                if wraps and len(text) <= LONG
                else min(len(text), BROKEN)
                if len(text) > LONG
                else len(text)
            )

    @property
    def files(self) -> tuple[File, ...]:
        """Table as CSV, and as LaTeX for the package booktabs."""
        name = re.sub(r"[^a-z0-9]+", "_", self.caption.lower()).strip("_")[:40].rstrip("_") or "table"
        return (
            encoded(f"{name}.csv", "CSV", csv(self.head, self.rows).encode()),
            encoded(
                f"{name}.tex", "LaTeX", booktabs(self.caption, self.head, self.rows, self.heads, self.texts).encode()
            ),
        )


def longest(text: str) -> int:
    """Length of the longest word."""
    return max(map(len, text.split()), default=0)


def csv(head: Row, rows: Sequence[Row]) -> str:
    """Lines of a CSV file, as the page writes the numbers."""
    return "".join(",".join(map(quoted, row)) + "\n" for row in (head, *rows))


def quoted(text: str) -> str:
    """Cell of a CSV file."""
    doubled = text.replace('"', '""')
    return f'"{doubled}"' if re.search('[",\n]', text) else text
