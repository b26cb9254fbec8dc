"""Answers in the formats of other codes, read by a map of their columns, give the same frames as files of ours."""

import json
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fixtures_command import Call, caller, one_line

import mpm_verify as mv
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.mms.external.errors import compare
from mpm_verify.cases.solvers import column_map
from mpm_verify.cases.solvers.answer import Frame
from mpm_verify.cases.solvers.answer import read as read_usual
from mpm_verify.cases.solvers.levels import Levels
from mpm_verify.cases.solvers.mapped import read
from mpm_verify.mms.manufacture import manufacture
from mpm_verify.reports.sentences import failures
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create
from mpm_verify.solver.state import Floats

SOLUTION, MODEL = create(SOLUTIONS, "clamped_shear"), create(MATERIALS, "neo_hookean")
EXACT = manufacture(SOLUTION, MODEL, MODEL.rho0)
LAYOUT = SOLUTION.layout(0.25, 4)
X, STEPS, DT, SPACING = LAYOUT.X, (3, 7, 12), 1e-3, 0.125
NAMES = ["x", "y", "vx", "vy", "Fxx", "Fxy", "Fyx", "Fyy", "sxx", "syy", "szz", "sxy"]
PLAIN = "\n".join(["[columns]", 'id = "id"', *(f'{name} = "{name}"' for name in NAMES)])
needs_hdf5 = pytest.mark.skipif(find_spec("tables") is None, reason="the package tables is not there")


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def fields(step: int) -> dict[str, Floats]:
    """The exact fields of a step, by our names of arrays."""
    t = step * DT
    return {"x": EXACT.x(X, t), "v": EXACT.v(X, t - DT / 2), "F": EXACT.F(X, t), "sigma": EXACT.sigma(X, t)}


def columns(step: int) -> dict[str, Floats]:
    """The same, a column each, in another order of the particles."""
    exact = fields(step)
    table = np.column_stack([exact["x"], exact["v"], exact["F"].reshape(-1, 4), exact["sigma"]])
    order = np.random.default_rng(step).permutation(len(X))
    return {"id": order.astype(float), **dict(zip(NAMES, table[order].T, strict=True))}


def written(path: Path, table: dict[str, Floats], mark: str = ",", form: str = "%.17g") -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, np.column_stack(list(table.values())), form, mark, header=mark.join(table), comments="")


def mapped(folder: Path, text: str) -> column_map.ColumnMap:
    (folder / "map.toml").write_text(text)
    return column_map.parsed(column_map.read(str(folder / "map.toml")))


def frames(folder: Path, text: str) -> dict[int, Frame]:
    return read(folder, mapped(folder, text), STEPS, DT, X, SPACING)


# ---- formats


def one_file_a_step(out: Path) -> str:
    for step in STEPS:
        written(out / "state" / f"p_{step:06d}.csv", columns(step))
    return 'files = "state/p_{step:06d}.csv"\n' + PLAIN


def spaces_by_output(out: Path) -> str:
    for index, step in enumerate(STEPS, 1):
        written(out / f"p{index:02d}.dat", columns(step), " ")
    return 'files = "p{index:02d}.dat"\nfirst = 1\n' + PLAIN


def named_by_time(out: Path) -> str:
    for step in STEPS:
        written(out / f"p-{step * DT:.4f}.tsv", columns(step), "\t")
    return 'files = "p-{time:.4f}.tsv"\n' + PLAIN


def one_table(out: Path) -> str:
    """A row is a particle at a step, frames that nobody asked for among them."""
    tables = [{"frame": np.full(len(X), float(step)), **columns(step)} for step in (0, *STEPS, 20)]
    written(out / "all.csv", {name: np.concatenate([t[name] for t in tables]) for name in tables[0]})
    return 'files = "all.csv"\nframe_column = "frame"\n' + PLAIN


def one_table_by_time(out: Path) -> str:
    """Times with six digits, as most codes write them."""
    tables = [{"t": np.full(len(X), float(f"{step * DT * (1 + 2e-6):.6g}")), **columns(step)} for step in STEPS]
    written(out / "all.csv", {name: np.concatenate([t[name] for t in tables]) for name in tables[0]})
    return 'files = "all.csv"\nframes = "time"\nframe_column = "t"\n' + PLAIN


def arrays_with_names_of_theirs(out: Path) -> str:
    """Displacements, F by columns, stress of the other sign in an order of their own, ids from 1."""
    for step in STEPS:
        exact = fields(step)
        sigma = exact["sigma"]
        np.savez(
            out / f"frame{step}.npz", number=np.arange(len(X)) + 1, displacement=exact["x"] - X, velocity=exact["v"],
            defgrad=exact["F"].transpose(0, 2, 1), pressure_like=-sigma[:, (0, 1, 3, 2)] / 1e3,
        )  # fmt: skip
    return """
        files = "frame{step}.npz"
        F_order = "column"
        sigma_order = ["xx", "yy", "xy", "zz"]
        [columns]
        id = {from = "number", add = -1}
        x = {from = "displacement", add = "X"}
        v = "velocity"
        F = "defgrad"
        sigma = {from = "pressure_like", factor = -1e3}
    """


def components_of_arrays(out: Path) -> str:
    """Three-dimensional ones, in the order of the case."""
    for step in STEPS:
        exact = fields(step)
        zero = np.zeros((len(X), 1))
        full = np.zeros((len(X), 3, 3))
        full[:, :2, :2], full[:, 2, 2] = exact["F"], 1.0
        s = exact["sigma"]
        stress = np.zeros((len(X), 3, 3))
        stress[:, 0, 0], stress[:, 1, 1], stress[:, 2, 2], stress[:, 0, 1] = s.T
        np.savez(out / f"frame{step}.npz", u=np.hstack([exact["x"] - X, zero]), v=np.hstack([exact["v"], zero]),
                 F=full, stress=stress)  # fmt: skip
    return """
        files = "frame{step}.npz"
        [columns]
        id = "row"
        x = {from = "u[0]", add = "X"}
        y = {from = "u[1]", add = "Y"}
        vx = "v[0]"
        vy = "v[1]"
        F = "F"
        sigma = "stress"
    """


def points(path: Path, exact: dict[str, Floats], rows: slice, of_cells: bool = False) -> None:
    import meshio

    count = len(X[rows])
    data = {"id": np.arange(len(X))[rows], "vel": exact["v"][rows], "defgrad": exact["F"].reshape(-1, 4)[rows],
            "stress": exact["sigma"][rows]}  # fmt: skip
    order = np.random.default_rng(1).permutation(count)
    told = {"cell_data": {key: [values[order]] for key, values in data.items()}} if of_cells else {"point_data": data}
    cells = [("vertex", (order if of_cells else np.arange(count))[:, None])]
    meshio.Mesh(np.column_stack([exact["x"][rows], np.zeros(count)]), cells, **told).write(path)


OF_POINTS = """
    [columns]
    id = "id"
    x = "points"
    v = "vel"
    F = "defgrad"
    sigma = "stress"
"""


def points_a_step(out: Path) -> str:
    for step in STEPS:
        points(out / f"p_{step}.vtu", fields(step), slice(None))
    return 'files = "p_{step}.vtu"' + OF_POINTS


def data_of_vertex_cells(out: Path) -> str:
    for step in STEPS:
        points(out / f"p_{step}.vtu", fields(step), slice(None), of_cells=True)
    return 'files = "p_{step}.vtu"' + OF_POINTS


def paraview_collection(out: Path) -> str:
    """Two parts each time, numbered as nobody would guess."""
    lines = []
    (out / "vtk").mkdir()
    for number, step in enumerate((0, *STEPS)):
        for part, rows in enumerate((slice(0, 20), slice(20, None))):
            name = f"vtk/part{part}_{7 * number}.vtu"
            points(out / name, fields(step), rows)
            lines.append(f'<DataSet timestep="{step * DT:.6g}" group="" part="{part}" file="{name}"/>')
    text = f'<VTKFile type="Collection" version="0.1"><Collection>{"".join(lines)}</Collection></VTKFile>'
    (out / "run.pvd").write_text(text)
    return 'files = "run.pvd"' + OF_POINTS


def dump(step: int, table: dict[str, Floats], form: str = "%.17g") -> str:
    rows = "\n".join(" ".join(form % value for value in row) for row in np.column_stack(list(table.values())))
    box = "ITEM: BOX BOUNDS pp pp pp\n" + "0 1\n" * 3
    return f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(X)}\n{box}ITEM: ATOMS {' '.join(table)}\n{rows}\n"


def of_lammps(step: int) -> dict[str, Floats]:
    """Columns with the names that a dump has: id from 1, and brackets that are part of a name."""
    names = {"sxx": "c_stress[1]", "syy": "c_stress[2]", "szz": "c_stress[3]", "sxy": "c_stress[4]"}
    return {names.get(name, name): values + (name == "id") for name, values in columns(step).items()}


OF_DUMP = PLAIN.replace('id = "id"', 'id = {from = "id", add = -1}')
for k, name in enumerate(("sxx", "syy", "szz", "sxy"), 1):
    OF_DUMP = OF_DUMP.replace(f'"{name}"', f'"c_stress[{k}]"')


def lammps_in_one_file(out: Path) -> str:
    (out / "dump.lammpstrj").write_text("".join(dump(step, of_lammps(step)) for step in (0, *STEPS, 15)))
    return 'files = "dump.lammpstrj"\n' + OF_DUMP


def lammps_a_file_each(out: Path) -> str:
    for step in (0, *STEPS):
        (out / f"dump.{step}.lammps").write_text(dump(step, of_lammps(step)))
    return 'files = "dump.*.lammps"\n' + OF_DUMP


def lammps_by_name(out: Path) -> str:
    for step in STEPS:
        (out / f"dump.{step}").write_text(dump(999, of_lammps(step)))
    return 'files = "dump.{step}"\nformat = "lammps"\n' + OF_DUMP


def hdf5_a_key_a_step(out: Path) -> str:
    import pandas as pd

    for step in STEPS:
        pd.DataFrame(columns(step)).to_hdf(out / "all.h5", key=f"state/s{step:04d}")
    return 'files = "all.h5"\nkey = "state/s{step:04d}"\n' + PLAIN


def hdf5_a_file_a_step(out: Path) -> str:
    """A table of the HDF5 library itself, as a C++ code writes it."""
    import tables

    for step in STEPS:
        table = columns(step)
        rows = np.zeros(len(X), dtype=[(name, "f8") for name in table])
        for name, values in table.items():
            rows[name] = values
        with tables.open_file(str(out / f"particles_{step:06d}.h5"), "w") as file:
            file.create_table("/", "table", rows)
    return 'files = "particles_{step:06d}.h5"\nkey = "table"\n' + PLAIN


def hdf5_one_frame(out: Path) -> str:
    import pandas as pd

    tables = [pd.DataFrame({"output": k, **columns(step)}) for k, step in enumerate(STEPS)]
    pd.concat(tables).to_hdf(out / "all.h5", key="particles", format="table")
    return 'files = "all.h5"\nframes = "index"\nframe_column = "output"\n' + PLAIN


FORMS: list[Any] = [
    one_file_a_step, spaces_by_output, named_by_time, one_table, one_table_by_time, arrays_with_names_of_theirs,
    components_of_arrays, points_a_step, data_of_vertex_cells, paraview_collection, lammps_in_one_file,
    lammps_a_file_each, lammps_by_name,
    *(pytest.param(form, marks=needs_hdf5) for form in (hdf5_a_key_a_step, hdf5_a_file_a_step, hdf5_one_frame)),
]  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_the_exact_answer_has_no_error(tmp_path: Path, form: Callable[[Path], str]) -> None:
    """In all quantities, and only where each field is read at its step, in its order, with its sign."""
    found = compare(EXACT, X, LAYOUT.V0, DT, frames(tmp_path, form(tmp_path)), Levels())
    size = {"u": 1e-15, "v": 1e-12, "F": 1e-14, "sigma": 1e-14 * MODEL.E}
    assert set(found.errors) == set(size)
    assert all(norms["max"] < size[quantity] for quantity, norms in found.errors.items()), found.errors


@pytest.mark.parametrize(
    ("change", "quantity"),
    [
        (("factor = -1e3", "factor = 1e3"), "sigma"),
        (('F_order = "column"', 'F_order = "row"'), "F"),
        (('"xx", "yy", "xy", "zz"', '"yy", "xx", "xy", "zz"'), "sigma"),
    ],
)
def test_a_map_that_is_wrong_is_seen(tmp_path: Path, change: tuple[str, str], quantity: str) -> None:
    """In that quantity and in no other."""
    text = arrays_with_names_of_theirs(tmp_path).replace(*change)
    found = compare(EXACT, X, LAYOUT.V0, DT, frames(tmp_path, text), Levels())
    wrong = {q for q, norms in found.errors.items() if norms["rms"] > 1e-3 * found.scale[q]}
    assert wrong == {quantity}


def test_displacements_with_six_digits_have_a_lower_floor_than_positions(tmp_path: Path) -> None:
    """The digits are those of what is written, times its factor; X is known to all digits."""
    for step in STEPS:
        exact = fields(step)
        u = exact["x"] - X
        table = {"id": np.arange(len(X)), "x": exact["x"][:, 0], "y": exact["x"][:, 1], "u": u[:, 0], "w": u[:, 1]}
        written(tmp_path / f"p{step}.csv", table, form="%.6e")
    found = {}
    for kind, text in {
        "x": 'x = "x"\ny = "y"',
        "u": 'x = {from = "u", add = "X"}\ny = {from = "w", add = "Y"}',
        "mm": 'x = {from = "x", factor = 1e-3}\ny = {from = "y", factor = 1e-3}',
    }.items():
        got = frames(tmp_path, f'files = "p{{step}}.csv"\n[columns]\nid = "id"\n{text}\n')
        found[kind] = compare(EXACT, X, LAYOUT.V0, DT, got, Levels())
    assert found["u"].floor["u"] < 0.2 * found["x"].floor["u"]
    assert found["u"].errors["u"]["rms"] < 3 * found["u"].floor["u"]
    assert found["mm"].floor["u"] == pytest.approx(1e-3 * found["x"].floor["u"])


def test_levels_of_a_map_hold_where_result_json_says_nothing(tmp_path: Path) -> None:
    from mpm_verify.cases.solvers.levels import levels

    usual = mapped(tmp_path, f'files = "p{{step}}.csv"\nv_lag = 0.0\nF_lag = 1.0\n{PLAIN}').levels
    assert levels(tmp_path, usual) == Levels(0.0, 1.0)
    (tmp_path / "result.json").write_text('{"v_lag": 0.5, "version": "3", "b": "end"}')
    assert levels(tmp_path, usual) == Levels(0.5, 1.0, "3", "end")
    assert mapped(tmp_path, f'files = "p{{step}}.csv"\n{PLAIN}').levels == Levels()
    (tmp_path / "result.json").write_text('{"b": "middle"}')
    with pytest.raises(RunFailed, match="unreadable"):
        levels(tmp_path)


# ---- what cannot be read

OK = 'files = "p{step}.csv"\n[columns]\nid = "id"\nx = "x"\ny = "y"\n'
MISTAKES = {
    "no TOML": ("files = ", "cannot be read as TOML"),
    "empty": ("", 'it needs files = "out_{step}.csv" and a table [columns]'),
    "no columns": ('files = "p{step}.csv"', "a table [columns]"),
    "a key that is none": ("zone = 1\n" + OK, "the map has 'zone', and may have files, format"),
    "a near one": ('f_order = "row"\n' + OK, "did you mean F_order?"),
    "a column that is none": (OK + 'vw = "vw"', "[columns] has 'vw'"),
    "no x": ('files = "p{step}.csv"\n[columns]\nid = "id"\ny = "y"', "[columns] has no x"),
    "no id": ('files = "p{step}.csv"\n[columns]\nx = "x"\ny = "y"', 'id = "row" where rows keep the order'),
    "a factor in words": (OK + 'vx = {from = "v", factor = "two"}', "columns.vx.factor = 'two'"),
    "a key of a column": (OK + 'vx = {from = "v", scale = 2.0}', "columns.vx has 'scale', and may have from, factor"),
    "a column without a name": (OK + "vx = {factor = 2.0}", "columns.vx.from"),
    "a list": (OK + "vx = [1, 2]", "columns.vx"),
    "the other reference position": (OK + 'vx = {from = "v", add = "X"}', "columns.vx: add = 'X' is for x"),
    "an order of F": ('F_order = "diagonal"\n' + OK, "F_order = 'diagonal'"),
    "an order of sigma": ('sigma_order = ["xx", "yx"]\n' + OK, "sigma_order"),
    "frames": ('frames = "seconds"\n' + OK, "frames = 'seconds'"),
    "first": ("first = 2\n" + OK, "first = 2"),
    "a level": ("v_lag = 5.0\n" + OK, "v_lag = 5.0: choose steps from -2 to 2"),
    "no ending": (OK.replace("p{step}.csv", "p{step}.out"), "has no known ending; add format, one of text, npz"),
    "a format": ('format = "xml"\n' + OK, "format = 'xml'"),
    "no frame": (OK.replace("p{step}.csv", "all.csv"), "does not say which frame is which; add {step}"),
    "another number": (OK.replace("{step}", "{number}"), "has {number}, and may have {step}, {time} or {index}"),
    "a form of the number": (OK.replace("{step}", "{time:06d}"), "cannot be filled in"),
    "half a brace": (OK.replace("{step}", "{step"), "cannot be filled in"),
    "a file elsewhere": (OK.replace("p{step}", "../p{step}"), "must be below {out}"),
    "a whole path": (OK.replace("p{step}", "/tmp/p{step}"), "must be below {out}"),
    "star and number": (OK.replace("p{step}", "p*{step}"), "has * and a number"),
    "a key beside CSV": ('key = "a"\n' + OK, "key is for HDF5"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_a_map_with_a_mistake_is_one_line(verify: Call, tmp_path: Path, name: str) -> None:
    text, says = MISTAKES[name]
    (tmp_path / "map.toml").write_text(text)
    typed = f"{sys.executable} {{case}} {{out}}"
    line = one_line(verify("mms", "--quick", "--solver", typed, "--columns", "map.toml", "--solution", "bump"))
    assert says in line
    assert "--columns: map.toml" in line


def test_a_map_that_is_not_there(verify: Call) -> None:
    typed = f"{sys.executable} {{case}} {{out}}"
    assert "no such file" in one_line(verify("mms", "--solver", typed, "--columns", "map.toml"))
    assert "cannot be read as TOML" in one_line(verify("mms", "--solver", typed, "--columns", "{x"))
    Path("map.toml").write_text(OK)
    assert "give --solver too" in one_line(verify("mms", "--quick", "--columns", "map.toml"))


def test_hdf5_without_its_package(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(column_map, "find_spec", lambda name: None)
    with pytest.raises(ValueError, match="install it: pip install tables"):
        mapped(tmp_path, OK.replace(".csv", ".h5"))


FAILS: dict[str, tuple[Callable[[Path], str], Callable[[Path], Any], FailureKind, str]] = {
    "a file is missing": (
        one_file_a_step, lambda out: (out / "state/p_000007.csv").unlink(), FailureKind.NO_ANSWER,
        "has not written p_000007.csv",
    ),
    "no file at all": (
        lammps_a_file_each, lambda out: [path.unlink() for path in out.glob("dump.*")], FailureKind.NO_ANSWER,
        "has not written step 3 in dump.*.lammps",
    ),
    "a frame is missing": (
        lammps_a_file_each, lambda out: (out / "dump.7.lammps").unlink(), FailureKind.NO_ANSWER,
        "has not written step 7 in dump.*.lammps",
    ),
    "a time is missing": (
        paraview_collection, lambda out: edit(out / "run.pvd", '"0.007"', '"0.0072"'), FailureKind.NO_ANSWER,
        "has not written time 0.007 in run.pvd",
    ),
    "a time that is no number": (
        paraview_collection, lambda out: edit(out / "run.pvd", '"0.007"', '"nan"'), FailureKind.NO_ANSWER,
        "has not written time 0.007",
    ),
    "half a dump": (
        lammps_in_one_file, lambda out: cut(out / "dump.lammpstrj"), FailureKind.OTHER_PARTICLES, "of the 64 particles",
    ),
    "a file of a collection": (
        paraview_collection, lambda out: (out / "vtk/part0_14.vtu").write_text("<"), FailureKind.UNREADABLE, "run.pvd",
    ),
    "no table": (one_table, lambda out: (out / "all.csv").write_text(""), FailureKind.UNREADABLE, "all.csv cannot be"),
    "no column of frames": (
        one_table, lambda out: edit(out / "all.csv", "frame,", "number,"), FailureKind.NO_COLUMN,
        "all.csv has no column frame",
    ),
    "another name": (
        one_file_a_step, lambda out: edit(out / "state/p_000003.csv", "vx", "ux"), FailureKind.NO_COLUMN,
        "p_000003.csv has no column vx",
    ),
    "words": (
        one_file_a_step, lambda out: edit(out / "state/p_000003.csv", "0.", "o."), FailureKind.UNREADABLE, "cannot be",
    ),
}  # fmt: skip


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def cut(path: Path) -> None:
    """End in the middle of the last frame that is asked for."""
    text = path.read_text()
    path.write_text(text[: text.index("ITEM: TIMESTEP\n15")].rsplit("\n", 30)[0] + "\n")


@pytest.mark.parametrize("name", FAILS)
def test_an_answer_that_cannot_be_used_is_a_failure(tmp_path: Path, name: str) -> None:
    form, spoil, kind, says = FAILS[name]
    text = form(tmp_path)
    spoil(tmp_path)
    with pytest.raises(RunFailed) as caught:
        frames(tmp_path, text)
    assert caught.value.failure.kind is kind
    assert says in failures.failure(caught.value.failure)


@pytest.mark.parametrize(
    ("column", "says"),
    [
        ('F = "v"', "no column v with the components of F"),
        ('v = "id"', "no column id with the components of v"),
        ('vx = "v"', "no column v with the components of vx"),
        ('vx = "v[2]"', "no column v[2]"),
        ('vx = "w[0]"', "no column w[0]"),
    ],
)
def test_an_array_of_other_components(tmp_path: Path, column: str, says: str) -> None:
    for step in STEPS:
        np.savez(tmp_path / f"p{step}.npz", id=np.arange(len(X)), x=X, v=np.zeros((len(X), 2)))
    with pytest.raises(RunFailed) as caught:
        frames(tmp_path, f'files = "p{{step}}.npz"\n[columns]\nid = "id"\nx = "x"\n{column}\n')
    assert says in failures.failure(caught.value.failure)


def test_a_broken_vtu_is_a_failure_and_ends_nothing(tmp_path: Path) -> None:
    """Of the usual files too: what reads meshes would end the process."""
    (tmp_path / "result_3.vtu").write_text("<VTKFile>")
    with pytest.raises(RunFailed, match="unreadable"):
        read_usual(tmp_path, 3, X, SPACING)


@needs_hdf5
def test_a_key_that_is_not_there(tmp_path: Path) -> None:
    text = hdf5_a_key_a_step(tmp_path).replace("state/s", "state/r")
    with pytest.raises(RunFailed) as caught:
        frames(tmp_path, text)
    assert "all.h5 has no column state/r0003" in failures.failure(caught.value.failure)


# ---- in a study


def test_a_map_is_part_of_the_name_of_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By what it says: another file with the same content, and comments, make no other run."""
    monkeypatch.chdir(tmp_path)

    def digests(name: str, text: str) -> list[str]:
        Path(name).write_text(text)
        values = {"solver": [f"{sys.executable} {{case}} {{out}}"], "solution": ["bump"], "columns": [name]}
        return [run.digest for run in build(Asked("mms", values), "verify mms").runs]

    first = digests("map.toml", OK)
    assert digests("other.toml", "# the same\n" + OK) == first
    text = column_map.read("map.toml")
    assert column_map.read(text) == text  # as a command has it that repeats a study
    assert not set(digests("map.toml", OK.replace('"y"', '"z"'))) & set(first)


PROGRAM = """
import importlib.util, json, pathlib, sys
import numpy as np
case, out = map(pathlib.Path, sys.argv[1:])
record = json.loads((case / "case.json").read_text())
spec = importlib.util.spec_from_file_location("exact", case / "body_force.py")
exact = importlib.util.module_from_spec(spec)
spec.loader.exec_module(exact)
table = np.genfromtxt(case / "particles.csv", delimiter=",", names=True)
X = np.stack([table["X"], table["Y"]], axis=1)
with open(out / "dump.lammpstrj", "w") as file:
    for step in record["frames"]:
        u = exact.displacement(X, step * record["dt"]) * (1 + record["dx"] ** 2)
        rows = np.column_stack([table["id"] + 1, 1e3 * u])
        file.write(f"ITEM: TIMESTEP\\n{step}\\nITEM: NUMBER OF ATOMS\\n{len(X)}\\nITEM: ATOMS id ux uy\\n")
        np.savetxt(file, rows, "%.15g")
"""
MAP = """
files = "dump.lammpstrj"
[columns]
id = {from = "id", add = -1}
x = {from = "ux", factor = 1e-3, add = "X"}
y = {from = "uy", factor = 1e-3, add = "Y"}
"""


@pytest.mark.slow
def test_a_program_that_writes_a_dump_is_judged(verify: Call, tmp_path: Path) -> None:
    """Errors of dx^2 by construction; without the map there is no answer."""
    (tmp_path / "mine.py").write_text(PROGRAM)
    (tmp_path / "map.toml").write_text(MAP)
    typed = f"{sys.executable} {tmp_path / 'mine.py'} {{case}} {{out}}"
    words = ["mms", "--solver", typed, "--order", "2", "--json", "--out", "study"]
    code, out, _ = verify(*words, "--cells", "8")
    assert (code, json.loads(out)["runs"][0]["reason"]) == (4, "the solver has not written result_2.csv at step 2")
    code, out, _ = verify(*words, "--cells", "8,12,16,24", "--columns", "map.toml")
    (verdict,) = (v for v in json.loads(out)["verdicts"] if v["quantity"] == "u")
    assert (code, verdict["verdict"]) == (0, "PASS")
    assert verdict["observed"] == pytest.approx(2.0, abs=0.05)


def test_a_function_takes_no_map(tmp_path: Path) -> None:
    (tmp_path / "map.toml").write_text(OK)
    with pytest.raises(ValueError, match="--columns is for files"):
        mv.study("mms", solver=lambda case: {}, solution="bump", cells=[4], columns=str(tmp_path / "map.toml"))
