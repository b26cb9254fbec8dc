"""Defects and placebos as data: the tables of cases/detect/defects, one TOML file a part of the package.

A defect is a text of a file that is replaced by another. `kind` is a class after Salari & Knupp 2000 (SAND2000-1444,
doi:10.2172/759450): `order` changes the order of accuracy or a number of the solution, `robustness` what happens to
input or states that are not usual, `judge` what judges and reports, `efficiency` and `formal` no number at all.
"""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).with_name("defects")
KINDS = ("order", "robustness", "judge", "placebo")
MAKERS = ("port", "formula", "index", "refactoring", "constant", "time", "physics")
NONE = "none"  # the sound package
BASES = "solver/basis/"
HIDDEN = ("_cpdi_limited.py", "_gimp.py", "_parallelogram.py", "_splines.py")


@dataclass(frozen=True)
class Defect:
    """One change of one file.

    Parameters
    ----------
    name
        Unique, of lower-case words with hyphens.
    file
        Path below the package, such as `solver/step.py`.
    old, new
        Text of the file, and what it is replaced by, once; `at` counts where it stands before.
    kind
        One of KINDS.
    by
        Who would make it: one of MAKERS, none of which is a kind, as rates have the names of both.
    listed
        Whether it stands in a list that was there before the checks were chosen.
    methods
        Methods that it is in; any where empty.
    equivalent
        Reason why no check can see it, as it changes nothing that matters; empty of a defect.
    """

    name: str
    file: str = ""
    old: str = ""
    new: str = ""
    kind: str = "order"
    by: str = ""
    listed: bool = False
    methods: tuple[str, ...] = ()
    at: int = 0
    equivalent: str = ""


@cache
def defects() -> Mapping[str, Defect]:
    """All of the tables, by name. Raises ValueError for a table that is broken."""
    found = {NONE: Defect(NONE, kind="placebo")}
    for table in sorted(FOLDER.glob("*.toml")):
        for row in tomllib.loads(table.read_text(encoding="utf-8"))["defect"]:
            one = Defect(**{**row, "methods": tuple(row.get("methods", ()))})
            known = one.kind in KINDS and one.by in MAKERS
            if one.name in found or not known or one.old == one.new:
                raise ValueError(
                    f"{table.name}: {one.name} stands there twice, has no such kind or maker, or changes nothing"
                )
            found[one.name] = one
    return found


def replaced(text: str, one: Defect) -> str:
    """Text of a file with the defect in it. Raises ValueError where the old text does not stand there."""
    starts = [found.start() for found in re.finditer(f"(?={re.escape(one.old)})", text)]
    if len(starts) <= one.at:
        raise ValueError(f"{one.name}: {one.file} does not hold its old text {one.at + 1} times")
    start = starts[one.at]
    return text[:start] + one.new + text[start + len(one.old) :]
