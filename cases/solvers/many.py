"""Readers of files with several frames: each gives numbers, None where there is none, and what reads the columns."""

from collections.abc import Callable, Iterator
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from mpm_verify.cases.solvers.readers import Columns, arrays, mesh, text

Frames = Iterator[tuple[float | None, Callable[[], Columns]]]
ITEM = "ITEM: "


def lammps(path: Path) -> Frames:
    """Frames of a LAMMPS dump: ITEM: TIMESTEP, ITEM: NUMBER OF ATOMS, ITEM: ATOMS with the names of its columns."""
    lines = path.read_text(encoding="utf-8").splitlines()
    heads = [k for k, line in enumerate(lines) if line.startswith(ITEM)]
    number, rows = None, 0
    for head in heads:
        item, _, names = lines[head].removeprefix(ITEM).partition("ATOMS ")
        if item == "TIMESTEP":
            number = float(lines[head + 1])
        elif item == "NUMBER OF ATOMS":
            rows = int(lines[head + 1])
        elif names:
            yield number, partial(atoms, names.split(), lines[head + 1 : head + 1 + rows])


def atoms(names: list[str], lines: list[str]) -> Columns:
    """Columns of the rows of a frame, as they are written."""
    table = np.array([line.split() for line in lines], dtype=str).reshape(len(lines), len(names))
    return dict(zip(names, table.T, strict=True))


def collection(path: Path) -> Frames:
    """Frames of a ParaView collection: the .vtu files of each time; several of one time are parts of it."""
    found = [
        (float(one.get("timestep", "nan")), str(one.get("file"))) for one in ElementTree.parse(path).iter("DataSet")
    ]
    for time, files in groupby(sorted(found), key=lambda pair: pair[0]):
        yield time, partial(joined, [path.parent / file for _, file in files])


def joined(paths: list[Path]) -> Columns:
    """Columns of all points of some files."""
    parts = [mesh(path) for path in paths]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def store(path: Path, key: str) -> Frames:
    """Frame of a key of an HDF5 file that pandas, or the table interface of HDF5, has written. Raises KeyError."""
    import pandas as pd

    try:
        frame = pd.read_hdf(path, key or None)
    except KeyError:
        raise KeyError(key) from None
    columns = {str(name): column.to_numpy() for name, column in frame.items()}
    yield None, lambda: columns


def frames(path: Path, kind: str, key: str) -> Frames:
    """Frames of a file of some format."""
    if kind == "hdf5":
        return store(path, key)
    if kind in ("lammps", "pvd"):
        return {"lammps": lammps, "pvd": collection}[kind](path)
    one: dict[str, Callable[[Path], Columns]] = {"text": text, "npz": arrays, "mesh": mesh}
    return iter([(None, partial(one[kind], path))])


def split(columns: Columns, name: str) -> Frames:
    """Frames of a table whose column of that name says which frame a row is of. Raises KeyError."""
    numbers = np.asarray(columns[name], dtype=np.float64)
    for number in np.unique(numbers):
        rows = numbers == number
        yield float(number), partial(part, columns, rows)


def part(columns: Columns, rows: Any) -> Columns:
    """Some rows of a table."""
    return {name: np.asarray(values)[rows] for name, values in columns.items()}
