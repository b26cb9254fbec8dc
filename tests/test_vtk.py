"""Snapshots for ParaView: read back by an independent reader, they are what was written."""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest

from mpm_verify.cases.harness.store import StoreError
from mpm_verify.reports.export.vtk import write_series

COUNT = 5


def snapshot(seed: int) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    x = rng.uniform(0, 1, (COUNT, 2)).astype(np.float32)
    around = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], np.float32) / 16
    return {
        "x": x, "corners": x[:, None] + around, "v": rng.normal(size=(COUNT, 2)).astype(np.float32),
        "F": rng.normal(size=(COUNT, 2, 2)).astype(np.float32), "sigma": rng.normal(size=(COUNT, 4)).astype(np.float32),
        "gamma_p": rng.uniform(size=COUNT).astype(np.float32),
    }  # fmt: skip


def test_particles_and_domains_come_back(tmp_path: Path) -> None:
    shots = [snapshot(1), snapshot(2)]
    paths = write_series(tmp_path, "run", [0.0, 0.5], shots)
    assert sorted(path.name for path in paths) == [
        "run.pvd", "run_0000.vtu", "run_0001.vtu", "run_points.pvd", "run_points_0000.vtu", "run_points_0001.vtu",
    ]  # fmt: skip
    for number, shot in enumerate(shots):
        domains = meshio.read(tmp_path / f"run_{number:04d}.vtu")
        points = meshio.read(tmp_path / f"run_points_{number:04d}.vtu")
        (quads,), (dots,) = domains.cells, points.cells
        assert (quads.type, dots.type) == ("quad", "vertex")
        np.testing.assert_array_equal(domains.points[quads.data][:, :, :2], shot["corners"])
        np.testing.assert_array_equal(points.points[dots.data][:, 0, :2], shot["x"])
        for mesh in (domains, points):
            read = {name: values[0] for name, values in mesh.cell_data.items()}
            np.testing.assert_array_equal(read["gamma_p"], shot["gamma_p"])
            np.testing.assert_array_equal(read["v"], np.pad(shot["v"], ((0, 0), (0, 1))))
            F = read["F"].reshape(COUNT, 3, 3)
            np.testing.assert_array_equal(F[:, :2, :2], shot["F"])
            assert (F[:, 2] == [0, 0, 1]).all()
            np.testing.assert_array_equal(read["sigma"][:, :4], shot["sigma"])  # xx yy zz xy yz xz
            assert (read["sigma"][:, 4:] == 0).all()


def test_the_collection_says_which_file_is_when(tmp_path: Path) -> None:
    write_series(tmp_path, "run", [0.25, 0.5], [snapshot(1), snapshot(2)])
    root = ElementTree.parse(tmp_path / "run_points.pvd").getroot()
    assert (root.tag, root.get("type")) == ("VTKFile", "Collection")
    found = [(float(one.get("timestep", "")), one.get("file")) for one in root.iter("DataSet")]
    assert found == [(0.25, "run_points_0000.vtu"), (0.5, "run_points_0001.vtu")]
    assert all((tmp_path / str(name)).exists() for _, name in found)


def test_points_alone_where_there_are_no_domains(tmp_path: Path) -> None:
    shot = snapshot(1)
    del shot["corners"]
    assert [path.name for path in write_series(tmp_path, "run", [0.0], [shot])] == [
        "run_points_0000.vtu",
        "run_points.pvd",
    ]


def test_the_same_bytes_again(tmp_path: Path) -> None:
    first = [path.read_bytes() for path in write_series(tmp_path, "run", [0.0], [snapshot(3)])]
    assert [path.read_bytes() for path in write_series(tmp_path, "run", [0.0], [snapshot(3)])] == first


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"corners": np.zeros((COUNT, 3, 2))}, "corners"),
        ({"x": np.zeros((0, 2))}, "one particle or more"),
        ({"v": np.zeros((COUNT, 3))}, "field v of 5 particles must have shape"),
        ({"gamma_p": np.zeros(COUNT + 1)}, "field gamma_p of 5 particles"),
        ({"a<b": np.zeros(COUNT)}, "must be made of letters"),
    ],
)
def test_refusals(tmp_path: Path, change: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        write_series(tmp_path, "run", [0.0], [{**snapshot(1), **change}])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("times", [[0.5, 0.5], [0.5], [0.0, float("nan")]])
def test_times_rise(tmp_path: Path, times: list[float]) -> None:
    with pytest.raises(ValueError, match="times must rise"):
        write_series(tmp_path, "run", times, [snapshot(1), snapshot(2)])


def test_a_folder_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="cannot write"):
        write_series(tmp_path / "none", "run", [0.0], [snapshot(1)])
