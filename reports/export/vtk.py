"""Snapshots of a run as files that ParaView opens: particles as points, their domains as quadrilaterals.

A series NAME of snapshots gives

    NAME_0000.vtu, ...         one quadrilateral a particle, its domain; only of snapshots that have `corners`
    NAME_points_0000.vtu, ...  one vertex a particle, at `x`
    NAME.pvd, NAME_points.pvd  which file belongs to which time: the files to open

Fields are cell data in both, so that a field is one number a particle in either picture. Numbers are float32, and the
same snapshots give the same bytes. Formats: VTK XML unstructured grid and ParaView's collection of files.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree

import meshio
import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.harness.store import Store, StoreError

Array = NDArray[Any]
Singles = NDArray[np.float32]
SHAPES = "(P,), (P,2), (P,2,2), or (P,4) for sigma"


def write_series(
    folder: Path, name: str, times: Sequence[float], snapshots: Sequence[Mapping[str, Array]]
) -> list[Path]:
    """Write the files of a series into a folder that exists; their paths, collections last.

    A snapshot has `x` (P,2), and `corners` (P,4,2), counter-clockwise, where particles have domains. All else in it is
    a field: a scalar (P,), a vector (P,2), a tensor (P,2,2) with zz = 1 for the deformation gradient F and 0 for
    others, or sigma (P,4): xx, yy, zz, xy. What a plane state leaves out is zero.

    Raises ValueError if times do not rise or are not one a snapshot, or if a field has another shape or number of rows;
    StoreError if a file cannot be written. A file of an older and longer series stays, but no collection names it.
    """
    if len(times) != len(snapshots) or not np.isfinite(times).all() or not (np.diff(times) > 0).all():
        raise ValueError(f"times must rise and be one a snapshot: {len(times)} times for {len(snapshots)} snapshots")
    fields = [_fields(snapshot) for snapshot in snapshots]  # all of them, before the first file
    domains, points = {}, {}
    for number, (time, snapshot) in enumerate(zip(times, snapshots, strict=True)):
        if "corners" in snapshot:
            domains[folder / f"{name}_{number:04d}.vtu"] = time
            _grid(list(domains)[-1], "quad", snapshot["corners"], fields[number])
        points[folder / f"{name}_points_{number:04d}.vtu"] = time
        _grid(list(points)[-1], "vertex", snapshot["x"][:, None], fields[number])
    series = {folder / f"{name}.pvd": domains, folder / f"{name}_points.pvd": points}
    series = {path: files for path, files in series.items() if files}
    for path, files in series.items():
        _collection(path, files)
    return [*domains, *points, *series]


def particles_file(path: Path, columns: Mapping[str, Array], dimension: int) -> None:
    """Write particles as points of one file, in double precision: their columns (P,) are its point data.

    Parameters
    ----------
    path
        File, whose name ends in .vtu.
    columns
        Columns by name; x, y (and z) are the positions of the points.
    dimension
        Number of coordinates.

    Raises
    ------
    StoreError
        If the file cannot be written.
    """
    points = np.zeros((len(columns["x"]), 3))
    points[:, :dimension] = np.column_stack([columns[axis] for axis in "xyz"[:dimension]])
    cells = np.arange(len(points), dtype=np.int64)[:, None]
    _write(path, meshio.Mesh(points, [("vertex", cells)], point_data=dict(columns)))


def _fields(snapshot: Mapping[str, Array]) -> dict[str, Singles]:
    """Fields with the components that VTK expects; ValueError where the snapshot is not what it must be."""
    count = len(snapshot["x"]) if "x" in snapshot else 0
    for key, shape in (("x", (count, 2)), ("corners", (count, 4, 2))):
        if count == 0 or (key in snapshot and snapshot[key].shape != shape):
            raise ValueError(
                f"a snapshot must have x (P,2) of one particle or more, and corners (P,4,2) or none: {key}"
            )
    return {key: _components(key, array, count) for key, array in snapshot.items() if key not in ("x", "corners")}


def _components(key: str, array: Array, count: int) -> Singles:
    """Components, a row each: 1 number, 3 of a vector, 9 of a tensor, 6 of a symmetric one (xx yy zz xy yz xz)."""
    if not (key.isascii() and key.isidentifier()):  # meshio does not escape what XML reserves
        raise ValueError(f"the name of a field must be made of letters, digits and _, and {key!r} is not")
    if array.shape == (count,):
        return _single(array)
    if array.shape == (count, 2):
        return _single(np.pad(array, ((0, 0), (0, 1))))
    if array.shape == (count, 4) and key.startswith("sigma"):
        return _single(np.pad(array, ((0, 0), (0, 2))))
    if array.shape == (count, 2, 2):
        tensor = np.pad(array, ((0, 0), (0, 1), (0, 1)))
        tensor[:, 2, 2] = key == "F"
        return _single(tensor.reshape(count, 9))
    raise ValueError(f"field {key} of {count} particles must have shape {SHAPES}, and has {array.shape}")


def _single(array: Array) -> Singles:
    with np.errstate(over="ignore"):  # what a failed run leaves becomes infinite
        return array.astype(np.float32)


def _grid(path: Path, kind: str, corners: Array, fields: Mapping[str, Singles]) -> None:
    """Write one cell of that kind a particle, with corners of its own (P,C,2): domains of CPDI may part."""
    count, each, _ = corners.shape
    points = _single(np.pad(corners.reshape(-1, 2), ((0, 0), (0, 1))))
    cells = np.arange(count * each, dtype=np.int64).reshape(count, each)
    _write(path, meshio.Mesh(points, [(kind, cells)], cell_data={key: [array] for key, array in fields.items()}))


def _write(path: Path, mesh: meshio.Mesh) -> None:
    """Write a mesh, whole or not at all."""
    try:
        with TemporaryDirectory(dir=path.parent, prefix=".vtk") as scratch:  # meshio writes to nothing but a path
            mesh.write(Path(scratch) / path.name)
            Store.write(path, (Path(scratch) / path.name).read_bytes())
    except OSError as error:
        raise StoreError(f"cannot write {path}: {error.strerror}; results stored before are kept") from error


def _collection(path: Path, files: Mapping[Path, float]) -> None:
    """Write ParaView's list of files and their times, next to the files."""
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    collection = ElementTree.SubElement(root, "Collection")
    for file, time in files.items():
        ElementTree.SubElement(collection, "DataSet", timestep=repr(float(time)), part="0", file=file.name)
    ElementTree.indent(root)
    Store.write(path, ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))
