"""Folder of an exported case: written for another solver, and read back.

case.json and case.txt say what is to be run, particles.csv and .vtu hold the particles at the start, body_force.* and
octave/ the force and the exact fields in other languages, selfcheck.csv and selfcheck_fields.csv values to check those
with, each with its tolerance, and README.md says all of it in words.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from mpm_verify.cases.benchmark.exported import FORMAT as BENCHMARK
from mpm_verify.cases.harness.store import Store
from mpm_verify.mms.components import AXES
from mpm_verify.mms.export.case import Exported
from mpm_verify.mms.export.expected import Table, needed, table
from mpm_verify.mms.export.files import CASE, FIELDS, FORCE, files
from mpm_verify.mms.export.record import CaseRecord
from mpm_verify.reports.export import folder as folders
from mpm_verify.reports.export.folder import README, rendered
from mpm_verify.reports.export.vtk import particles_file
from mpm_verify.solver.state import Floats

VTU = "particles.vtu"


def schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of case.json."""
    found = TypeAdapter(CaseRecord).json_schema(mode="serialization")
    for definition in (found, *found["$defs"].values()):
        definition["additionalProperties"] = False
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **found, "title": "mpm-verify case folder"}


def usable(folder: Path) -> None:
    """Raise ValueError unless a case can be written there: nothing is there yet, or a folder that holds a case."""
    folders.usable(folder, read, "case")


def write(folder: Path, case: Exported) -> list[Path]:
    """Write the files of a case; what another case of the same folder left is written over.

    Parameters
    ----------
    folder
        Folder, which is made where it is missing.
    case
        Content.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    ValueError
        If something else is there.
    StoreError
        If a file cannot be written.
    """
    usable(folder)
    texts = files(case) | {README: words(case.record)}
    for parent in {Path(name).parent for name in texts}:
        (folder / parent).mkdir(parents=True, exist_ok=True)
    particles_file(folder / VTU, case.particles, case.record.dimension)
    for name, text in texts.items():
        Store.write(folder / name, text.encode())
    return [folder / VTU, *(folder / name for name in texts)]


def words(record: CaseRecord) -> str:
    """Text of README.md."""
    axes = AXES[: record.dimension]
    sides = ("r1x the", "r1x, r1y and r2x, r2y the two", "r1x, r1y, r1z to r3z the three")[record.dimension - 1]

    def named(letter: str, after: str) -> str:
        return ", ".join(f"{letter}{axis}{after}" for axis in axes)

    def said(letters: str) -> str:
        return " and ".join(filter(None, [", ".join(letters[:-1]), letters[-1]]))

    return rendered("case_folder.md.j2", case=record, axes=axes, columns=named, said=said, sides=sides)


def read(folder: Path) -> CaseRecord:
    """Record of a case. Raises ValueError with one line where the folder holds none, or a damaged one."""
    if not folder.is_dir():
        raise ValueError(f"{folder} is no folder; make one with `verify export SOLUTION --to {folder}`")
    try:
        text = (folder / CASE).read_bytes()
    except OSError as error:
        raise ValueError(f"{folder} holds no exported case: {CASE}: {error.strerror}") from None
    if BENCHMARK.encode() in text:
        raise ValueError(f"{folder} holds a benchmark, which has no body-force sources to check")
    try:
        found = TypeAdapter(CaseRecord).validate_json(text)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "all of it"
        raise ValueError(f"{folder / CASE} is damaged: {where}: {first['msg']}; export the case again") from None
    if json.loads(text)["dimension"] is True:  # which counts as 1
        raise ValueError(f"{folder / CASE} is damaged: dimension: true is not a number; export the case again")
    return found


def table_of(folder: Path, record: CaseRecord) -> Table:
    """Rows and right values that the sources of a folder are checked with. Raises ValueError with one line."""
    force, fields = (
        columns(folder / name, needed_columns)
        for name, needed_columns in zip((FORCE, FIELDS), needed(record.dimension, record.axisymmetric), strict=True)
    )
    try:
        return table(record.dimension, force, fields, record.axisymmetric)
    except ValueError as error:
        raise ValueError(f"{folder}: {error}") from None


def columns(path: Path, needed: tuple[str, ...]) -> dict[str, Floats]:
    """Columns of a table that was written here.

    Parameters
    ----------
    path
        File.
    needed
        Names of the columns that it must have.

    Returns
    -------
    dict
        Columns (n,) by name.

    Raises
    ------
    ValueError
        With one line, for a file that cannot be read, lacks a column, or holds something that is not a finite number.
    """
    try:
        header, *lines = path.read_text(encoding="utf-8").splitlines() or [""]
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{path} cannot be read: {getattr(error, 'strerror', None) or 'it is no text'}") from None
    names = header.split(",")
    missing = [name for name in needed if name not in names]
    if missing or len(set(names)) < len(names):
        raise ValueError(f"{path} is damaged: its first line has no column {(missing or ['of each name once'])[0]}")
    if not lines:
        raise ValueError(f"{path} is damaged: it has no rows")
    try:
        rows = np.array([[float(value) for value in line.split(",")] for line in lines])
    except ValueError:
        raise ValueError(f"{path} is damaged: a row is not made of {len(names)} numbers") from None
    if rows.ndim != 2 or rows.shape[1] != len(names) or not np.isfinite(rows).all():
        raise ValueError(f"{path} is damaged: a row is not made of {len(names)} finite numbers")
    return dict(zip(names, rows.T, strict=True))
