"""Case folders: written, read back to the last bit, held against their schema, refused where they cannot be used."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from fixtures_command import Call, caller, one_line
from fixtures_export import PLANE, SOLID, exported, folder_of
from jsonschema import Draft202012Validator, ValidationError

from mpm_verify.cases.mms.execute import setup
from mpm_verify.cases.mms.run import Run
from mpm_verify.mms.discretisation import output_steps
from mpm_verify.mms.export.files import CASE, FIELDS, FORCE, PARTICLES
from mpm_verify.reports.export.case_folder import VTU, columns, read, schema, write
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create

TOP = Path(__file__).resolve().parent.parent
each = pytest.mark.parametrize("solution", [*PLANE, *(pytest.param(name, marks=pytest.mark.slow) for name in SOLID)])


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


# ---- what is written


@each
def test_particles_are_read_back_bit_by_bit(solution: str, tmp_path: Path) -> None:
    case = exported(solution)
    folder = folder_of(solution, tmp_path)
    read_back = columns(folder / PARTICLES, ())
    assert list(read_back) == list(case.particles)
    for name, values in case.particles.items():
        assert read_back[name].tobytes() == np.asarray(values, dtype=np.float64).tobytes(), name
    points = meshio.read(folder / VTU)
    for name, values in case.particles.items():
        assert np.asarray(points.point_data[name]).tobytes() == np.ascontiguousarray(values).tobytes(), name
    positions = np.column_stack([case.particles[axis] for axis in "xyz" if axis in case.particles])
    np.testing.assert_array_equal(points.points[:, : positions.shape[1]], positions)
    for file, values in ((FORCE, case.force), (FIELDS, case.fields)):
        again = columns(folder / file, tuple(values))
        assert all(again[name].tobytes() == np.ascontiguousarray(values[name]).tobytes() for name in values)


@pytest.mark.slow
@pytest.mark.parametrize("solution", PLANE)
def test_particles_are_those_of_a_run(solution: str) -> None:
    """Positions, velocities at -dt/2, F, sigma, volumes and masses of the reference solver at its start; its grid."""
    case = exported(solution, cells=8)
    plugin = create(SOLUTIONS, solution)
    model, comparison, steps = setup(Run("mpm", solution, plugin.material, 8, 4))
    found, p, record = case.particles, model.particles, case.record
    order = np.argsort(p.id)
    here = {
        ("X", "Y"): p.X, ("x", "y"): p.x, ("vx_half", "vy_half"): p.v, ("Fxx", "Fxy", "Fyx", "Fyy"): p.F.reshape(-1, 4),
        ("sxx", "syy", "szz", "sxy"): p.sigma, ("V0",): p.V0[:, None], ("m",): p.m[:, None],
    }  # fmt: skip
    for names, values in here.items():
        np.testing.assert_array_equal(np.column_stack([found[name] for name in names]), values[order], err_msg=names[0])
    assert (record.steps, record.dt, record.dx, record.particles) == (steps, model.dt, model.grid.dx, len(p))
    assert record.grid_lower == tuple(model.grid.lower)
    assert record.grid_upper == tuple(model.grid.upper)
    layout = plugin.layout(record.dx, 4)
    sides = np.column_stack([found[f"r{k}{axis}"] for k in (1, 2) for axis in "xy"])
    np.testing.assert_array_equal(sides, layout.r0.reshape(-1, 4))
    exact, X, dt = comparison.exact, layout.X, record.dt
    np.testing.assert_array_equal(np.column_stack([found["vx"], found["vy"]]), exact.v(X, 0.0))
    before = [f"{name}_before" for name in ("Fxx", "Fxy", "Fyx", "Fyy", "sxx", "syy", "szz", "sxy")]
    expected = np.hstack([exact.F(X, -dt).reshape(-1, 4), exact.sigma(X, -dt)])
    np.testing.assert_array_equal(np.column_stack([found[name] for name in before]), expected)
    assert (record.t_half, record.t_before) == (-dt / 2, -dt)


EDGES = {
    "bump": ["free"] * 4, "clamped_shear": ["fixed"] * 4, "axis_aligned": ["roller"] * 4, "affine": ["prescribed"] * 4,
    "expanding_ring": ["free"] * 2,
}  # fmt: skip


@pytest.mark.parametrize("solution", EDGES)
def test_edges(solution: str, tmp_path: Path) -> None:
    record = exported(solution).record
    assert list(record.edges.values()) == EDGES[solution]
    assert record.body == ("ring" if "ring" in solution else "rectangle")
    text = (folder_of(solution, tmp_path) / "README.md").read_text()
    assert all(f"- {edge}: {kind}," in text for edge, kind in record.edges.items())


def test_output_steps() -> None:
    assert output_steps(80, 16) == tuple(range(5, 81, 5))
    assert output_steps(5, 16) == (1, 2, 3, 4, 5)
    for steps in (1, 7, 23, 100):
        frames = output_steps(steps, 6)
        assert frames[-1] == steps
        assert len(frames) == min(6, steps)
        assert all(1 <= frame <= steps for frame in frames)


@each
def test_the_record_is_that_of_the_schema(solution: str, tmp_path: Path) -> None:
    folder = folder_of(solution, tmp_path)
    content = json.loads((folder / CASE).read_text())
    Draft202012Validator(schema()).validate(content)
    assert read(folder) == exported(solution).record


def test_the_schema_is_that_of_the_repository(verify: Call) -> None:
    stored = json.loads((TOP / "docs" / "case.schema.json").read_text())
    code, out, err = verify("schema", "case-folder")
    assert (code, err) == (0, "")
    assert json.loads(out) == schema() == stored
    Draft202012Validator.check_schema(stored)


@pytest.mark.parametrize(
    "changes", [{"dimension": 4}, {"steps": "ten"}, {"edges": {"left": "wall"}}, {"more": 1}, {"frames": [1.5]},
                {"format": "mpm-verify-case-2"}, {"material": None}],
)  # fmt: skip
def test_the_schema_can_be_broken(changes: dict[str, Any], tmp_path: Path) -> None:
    content = json.loads((folder_of("bump", tmp_path) / CASE).read_text())
    with pytest.raises(ValidationError):
        Draft202012Validator(schema()).validate(content | changes)


def test_the_flat_text_says_the_same(tmp_path: Path) -> None:
    """A name and a word in each line, as C and Fortran read them; numbers with all their digits."""
    folder = folder_of("clamped_shear", tmp_path)
    lines = [line.split(" ") for line in (folder / "case.txt").read_text().splitlines()]
    assert all(len(line) == 2 for line in lines)
    flat = dict(lines)
    assert len(flat) == len(lines)
    record = read(folder)
    assert float(flat["dt"]) == record.dt
    assert float(flat["material_lam"]) == record.material.constants["lam"]
    assert (float(flat["upper_x"]), float(flat["grid_lower_y"])) == (record.upper[0], record.grid_lower[1])
    assert flat["edges_left"] == "fixed"
    assert [int(flat[f"frames_{k + 1}"]) for k in range(int(flat["frames"]))] == list(record.frames)


def test_readme_says_first_what_costs_the_time(tmp_path: Path) -> None:
    text = (folder_of("bump", tmp_path) / "README.md").read_text()
    heads = [line for line in text.splitlines() if line.startswith(("## ", "**"))]
    assert heads[0] == "## What costs the time, first"
    assert [word in head for word, head in zip(("time level", "force can be put", "walls"), heads[1:4], strict=True)]
    assert all(f"`{file}`" in text or file == "octave" for file in ("case.json", "particles.csv", "body_force.f90"))
    assert "{{" not in text
    assert "\n\n\n" not in text


def test_materials_of_ones_own_are_exported(tmp_path: Path) -> None:
    """Constants and the formula of the stress."""
    record = exported("bump", material="linear_elastic:E=200,nu=0.1").record
    assert record.material.name == "linear_elastic:E=200,nu=0.1"
    assert record.material.constants["E"] == 200
    assert record.material.constants["mu"] == pytest.approx(200 / 2.2)
    for name in ("neo_hookean", "linear_elastic"):
        assert create(MATERIALS, name).formula


# ---- the command


def test_export_and_check(verify: Call, tmp_path: Path) -> None:
    code, out, err = verify("export", "bump", "--cells", "4", "--to", "case")
    assert (code, err) == (0, "")
    assert "64 particles, 20 steps" in out
    code, out, err = verify("check-force", "case", "--lang", "c,python")
    assert (code, err) == (0, "")
    assert out.count("agrees in 40 rows") == 2
    code, out, _ = verify("check-force", "case", "--lang", "python", "--json")
    document = json.loads(out)
    assert (code, document["exit_code"]) == (0, 0)
    assert document["languages"][0]["outcome"] == "agrees"
    source = tmp_path / "case" / "body_force.py"
    source.write_text(source.read_text().replace("r0 = ", "r0 = -1.0*", 1))
    code, out, err = verify("check-force", "case", "--lang", "python,c")
    assert (code, err) == (1, "")
    assert "DISAGREES in" in out
    assert "agrees in 40 rows" in out


def test_nothing_to_check_is_3(verify: Call, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    folder_of("bump", tmp_path / "case")
    monkeypatch.setenv("PATH", str(tmp_path))
    code, out, err = verify("check-force", "case", "--lang", "julia,fortran")
    assert (code, err) == (3, "")
    assert out.count("not checked: there is no") == 2


def test_a_case_is_written_over(verify: Call, tmp_path: Path) -> None:
    """By another one, with what the reader put beside it left alone."""
    folder_of("bump", tmp_path / "case")
    (tmp_path / "case" / "result_80.csv").write_text("mine")
    assert verify("export", "swirl", "--cells", "4", "--to", "case")[0] == 0
    assert read(tmp_path / "case").solution == "swirl"
    assert (tmp_path / "case" / "result_80.csv").read_text() == "mine"


def test_own_solution_is_exported(verify: Call, tmp_path: Path) -> None:
    """It is told by the name of its file, not by its path."""
    own = str(TOP / "tests" / "own_solution.py")
    assert verify("export", own, "--cells", "4", "--to", "case")[0] == 0
    assert read(tmp_path / "case").solution == "own_solution"
    assert str(TOP) not in (tmp_path / "case" / CASE).read_text()
    assert verify("check-force", "case", "--lang", "c,python")[0] == 0


REFUSED = {
    "a solution": (["swirll", "--to", "case"], "swirl"),
    "a parameter": (["bump:B=1", "--to", "case"], "no parameter 'B'"),
    "a material": (["bump", "--material", "steel", "--to", "case"], "no material"),
    "no energy": (["bump", "--material", "mohr_coulomb", "--to", "case"], "no energy"),
    "cells": (["bump", "--cells", "1", "--to", "case"], "cells = 1"),
    "too many": (["bump", "--cells", "4096", "--to", "case"], "particles are too many"),
    "no square": (["bump", "--ppc", "5", "--to", "case"], "square number"),
    "courant": (["bump", "--courant", "0", "--to", "case"], "courant = 0"),
    "unstable": (["bump", "--courant", "1.5", "--to", "case"], "stability limit"),
    "frames": (["bump", "--frames", "0", "--to", "case"], "--frames"),
    "no folder": (["bump"], "--to"),
    "no number": (["bump", "--cells", "x", "--to", "case"], "cells"),
    "rows that do not fill": (["{own}", "--cells", "5", "--to", "case"], "do not fill"),
    "a file": (["bump", "--to", "a_file"], "a_file is a file"),
    "below a file": (["bump", "--to", "a_file/case"], "a_file"),
    "something else": (["bump", "--to", "else"], "holds something that is not an exported case"),
    "this folder": (["bump", "--to", "."], "holds something that is not an exported case"),
    "a link": (["bump", "--to", "link"], "leads nowhere"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_exported(verify: Call, name: str, tmp_path: Path) -> None:
    (tmp_path / "a_file").write_text("mine")
    (tmp_path / "else").mkdir()
    (tmp_path / "else" / "notes.txt").write_text("mine")
    (tmp_path / "link").symlink_to("nowhere")
    own = tmp_path / "own.py"
    text = (TOP / "tests" / "own_solution.py").read_text()
    own.write_text(text.replace('"upper": (1, 1)', '"upper": (1, 0.5)').replace("sp.pi * y", "2 * sp.pi * y"))
    arguments, said = REFUSED[name]
    before = sorted(map(str, tmp_path.rglob("*")))
    assert said in one_line(verify("export", *(word.replace("{own}", str(own)) for word in arguments)))
    after = sorted(str(path) for path in tmp_path.rglob("*") if "__pycache__" not in str(path))
    assert after == before


# ---- damaged folders


def edited(name: str, change: Callable[[str], str]) -> Callable[[Path], None]:
    """Damage that changes the text of a file."""

    def damage(folder: Path) -> None:
        text = (folder / name).read_text()
        new = change(text)
        assert new != text
        (folder / name).write_text(new)

    return damage


def without(name: str) -> Callable[[Path], None]:
    return lambda folder: (folder / name).unlink()


def binary(name: str) -> Callable[[Path], Any]:
    return lambda folder: (folder / name).write_bytes(os.urandom(1) + b"\xff\xfe\x00\x01" * 50)


def changed_record(**changes: Any) -> Callable[[Path], None]:
    return edited(CASE, lambda text: json.dumps(json.loads(text) | changes))


def lacking(key: str) -> Callable[[Path], None]:
    return edited(CASE, lambda text: json.dumps({k: v for k, v in json.loads(text).items() if k != key}))


DAMAGES: dict[str, Callable[[Path], Any]] = {
    "no record": without(CASE), "a binary record": binary(CASE), "an empty record": edited(CASE, lambda text: ""),
    "half a record": edited(CASE, lambda text: text[: len(text) // 2]),
    "a list": edited(CASE, lambda text: "[1, 2]"), "null": edited(CASE, lambda text: "null"),
    "a word for a number": changed_record(steps="many"), "another format": changed_record(format="other"),
    "another dimension": changed_record(dimension=7), "another edge": changed_record(edges={"left": "glass"}),
    **{f"no {key}": lacking(key) for key in ("dimension", "dt", "frames", "material", "edges", "format")},
    **{f"{file} {name}": damage for file in (FORCE, FIELDS) for name, damage in {
        "is gone": without(file), "is binary": binary(file), "is empty": edited(file, lambda text: ""),
        "has no rows": edited(file, lambda text: text.splitlines()[0] + "\n"),
        "has no header": edited(file, lambda text: text.partition("\n")[2]),
        "has a short row": edited(file, lambda text: text.rstrip().rpartition(",")[0] + "\n"),
        "has a long row": edited(file, lambda text: text.rstrip() + ",1\n"),
        "has a word": edited(file, lambda text: text.rstrip().rpartition(",")[0] + ",many\n"),
        "has nan": edited(file, lambda text: text.rstrip().rpartition(",")[0] + ",nan\n"),
        "has inf": edited(file, lambda text: text.rstrip().rpartition(",")[0] + ",inf\n"),
        "has another column": edited(file, lambda text: text.replace("tolerance_", "width_", 1)),
        "has a column twice": edited(file, lambda text: text.replace("Y", "X", 1)),
        "has fewer rows": edited(file, lambda text: "\n".join(text.splitlines()[:-3]) + "\n"),
        "has another time": edited(file, lambda text: text.replace("\n0", "\n1", 1).replace("\n-", "\n", 1)),
        "is cut": edited(file, lambda text: text[: len(text) // 2].rpartition(",")[0]),
    }.items()},
}  # fmt: skip


@pytest.mark.parametrize("name", DAMAGES)
def test_a_damaged_folder_is_one_line(verify: Call, name: str, tmp_path: Path) -> None:
    folder = folder_of("bump", tmp_path / "case")
    DAMAGES[name](folder)
    line = one_line(verify("check-force", "case", "--lang", "python"))
    assert "case" in line


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["nowhere"], "nowhere is no folder"),
        (["case", "--lang", "pyton"], "did you mean python?"),
        (["case", "--lang", "infix"], "no language 'infix'"),
        (["case", "--lang", "c,"], "no language ''"),
        (["case", "--lang", "fortran"], "has no source in it"),
        (["empty"], "holds no exported case"),
    ],
)
def test_what_cannot_be_checked(verify: Call, arguments: list[str], said: str, tmp_path: Path) -> None:
    folder_of("bump", tmp_path / "case")
    (tmp_path / "case" / "body_force.f90").unlink()
    (tmp_path / "empty").mkdir()
    assert said in one_line(verify("check-force", *arguments))


def test_a_folder_that_cannot_be_written(verify: Call, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def full(*arguments: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    assert "No space left" in one_line(verify("export", "bump", "--cells", "4", "--to", "case"))


def test_writing_again_gives_the_same_bytes(tmp_path: Path) -> None:
    one, two = (folder_of("generalised_vortex", tmp_path / name) for name in "ab")
    for file in (file for file in one.rglob("*") if file.is_file()):
        assert file.read_bytes() == (two / file.relative_to(one)).read_bytes(), file.name
    assert write(one, exported("generalised_vortex"))
