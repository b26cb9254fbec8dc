"""Answers of solvers of three dimensions: read in every form, judged, hinted at; single precision; the toy's digits."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fixtures_command import Call, caller

import mpm_verify as mv
from mpm_verify.cases.mms.external.errors import compare
from mpm_verify.cases.mms.external.hints import hints
from mpm_verify.cases.solvers.answer import Frame, read
from mpm_verify.cases.solvers.callables import Case
from mpm_verify.cases.solvers.levels import Levels
from mpm_verify.mms.components import COMPONENTS
from mpm_verify.mms.export.case import Names, export
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create
from mpm_verify.solver.state import Floats

LAW = create(MATERIALS, "neo_hookean")
SOLUTION, PLANE = create(SOLUTIONS, "bump3d:A=0.05"), create(SOLUTIONS, "clamped_shear")
LAYOUT = SOLUTION.layout(0.25, 8)
X, DT, STEPS, USUAL = LAYOUT.X, 2e-4, (10, 35), Levels()
NINE = [f"F{a}{b}" for a in "xyz" for b in "xyz"]
HEAD = ["id", *"XYZ", *"xyz", "vx", "vy", "vz", *NINE, *(f"s{end}" for end in COMPONENTS[3])]
SPACING = 0.125


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


@cache
def exact(d: int = 3) -> Manufactured:
    """Exact fields in three dimensions, or of the plane solution in two."""
    return manufacture(SOLUTION if d == 3 else PLANE, LAW, LAW.rho0)


def rows(step: int) -> Floats:
    """The exact answer at a step, (P,25)."""
    t, e = step * DT, exact()
    F, sigma = e.F(X, t).reshape(-1, 9), e.sigma(X, t)
    return np.column_stack([np.arange(len(X)), X, e.x(X, t), e.v(X, t - DT / 2), F, sigma])


def csv(folder: Path, step: int, table: Floats, form: str = "%.17g") -> None:
    head = ",".join(HEAD)
    np.savetxt(folder / f"result_{step}.csv", table, fmt=form, delimiter=",", header=head, comments="")


def by_position(folder: Path, step: int, table: Floats) -> None:
    shuffled = np.random.default_rng(step).permutation(table)[:, 1:]
    head = ",".join(HEAD[1:])
    np.savetxt(folder / f"result_{step}.csv", shuffled, fmt="%.17g", delimiter=",", header=head, comments="")


def parts(table: Floats) -> dict[str, Floats]:
    """x, v, F (P,3,3) and sigma (P,3,3) of a table."""
    x, v, F, s = np.split(table[:, 4:], (3, 6, 15), axis=1)
    sigma = s[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    return {"x": x, "v": v, "F": F.reshape(-1, 3, 3), "sigma": sigma}


def arrays(folder: Path, step: int, table: Floats) -> None:
    order = np.random.default_rng(step).permutation(len(table))
    np.savez(folder / f"result_{step}.npz", id=order, **parts(table[order]))


def six_of_sigma(folder: Path, step: int, table: Floats) -> None:
    np.savez(folder / f"result_{step}.npz", X=table[:, 1:4], **{**parts(table), "sigma": table[:, 19:]})


def points(folder: Path, step: int, table: Floats) -> None:
    import meshio

    of = parts(table)
    data = {"id": table[:, 0], "v": of["v"], "F": of["F"].reshape(-1, 9), "sigma": table[:, 19:]}
    cells = [("vertex", np.arange(len(table))[:, None])]
    meshio.Mesh(of["x"], cells, point_data=data).write(folder / f"result_{step}.vtu")


@pytest.mark.parametrize("form", [csv, by_position, arrays, six_of_sigma, points])
def test_the_exact_answer_has_no_error(tmp_path: Path, form: Callable[[Path, int, Floats], None]) -> None:
    for step in STEPS:
        form(tmp_path, step, rows(step))
    frames = {step: read(tmp_path, step, X, SPACING) for step in STEPS}
    found = compare(exact(), X, LAYOUT.V0, DT, frames, USUAL).errors
    size = {"u": 1e-15, "v": 1e-12, "F": 1e-14, "sigma": 1e-14 * LAW.E}
    assert set(found) == set(size)
    assert all(norms["max"] < size[quantity] for quantity, norms in found.items()), found


def test_every_component_counts(tmp_path: Path) -> None:
    """Each column moved by the same: so far the error grows, and that of a shear stress counts twice."""
    counted = {"u": ("xyz", 1), "F": (NINE, 1), "sigma": (HEAD[19:22], 1), "shear": (HEAD[22:], 2)}
    for quantity, (names, times) in counted.items():
        for name in names:
            table = rows(10)
            table[:, HEAD.index(name)] += 0.5
            csv(tmp_path, 10, table)
            frames = {10: read(tmp_path, 10, X, SPACING)}
            error = compare(exact(), X, LAYOUT.V0, DT, frames, USUAL).errors
            assert error[quantity.replace("shear", "sigma")]["rms"] == pytest.approx(0.5 * times**0.5), name


@pytest.mark.parametrize("name", ["x", "z"])
def test_a_position_that_is_missing_is_told(tmp_path: Path, name: str) -> None:
    table = np.delete(rows(10), HEAD.index(name), axis=1)
    head = ",".join(one for one in HEAD if one != name)
    np.savetxt(tmp_path / "result_10.csv", table, delimiter=",", header=head, comments="")
    with pytest.raises(RunFailed) as failed:
        read(tmp_path, 10, X, SPACING)
    assert failed.value.failure.kind is FailureKind.NO_COLUMN
    assert failed.value.failure.names["column"] == name


def test_an_answer_of_two_dimensions_is_not_one_of_three(tmp_path: Path) -> None:
    np.savez(tmp_path / "result_10.npz", id=np.arange(len(X)), x=X[:, :2])
    with pytest.raises(RunFailed) as failed:
        read(tmp_path, 10, X, SPACING)
    assert failed.value.failure.kind is FailureKind.NO_COLUMN


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("F_transposed", lambda F: F.transpose(0, 2, 1)),
        ("F_twice", lambda F: F @ F),
        ("sigma_sign", lambda F: F),
        ("", lambda F: F),
    ],
)
def test_a_fault_is_hinted_at(name: str, change: Callable[[Floats], Floats]) -> None:
    """And none where there is none. With F wrong, sigma is told by the answer's own displacements."""
    frames = {}
    for step in STEPS:
        fields = {**parts(rows(step)), "sigma": (-1 if name == "sigma_sign" else 1) * rows(step)[:, 19:]}
        frames[step] = Frame({**fields, "F": change(fields["F"]).reshape(-1, 9)})
    case = export(Names("bump3d:A=0.05", "neo_hookean"), SOLUTION, LAW, 4, 8, checked=False)
    found = hints(exact(), replace(case, record=replace(case.record, dt=DT)), frames, USUAL)
    assert found.keys() == ({name} if name else set())
    assert found.get("sigma_sign", -1.0) == pytest.approx(-1.0, abs=1e-6)


# ---- single precision

EPS = float(np.finfo(np.float32).eps)


def plane_answer(step: int) -> dict[str, Floats]:
    """Answer of the plane solution: x, v, F."""
    at, t = PLANE.layout(0.125, 4).X, step * DT
    return {"x": exact(2).x(at, t), "v": exact(2).v(at, t - DT / 2), "F": exact(2).F(at, t)}


def written(folder: Path, fields: dict[str, Any], form: str) -> None:
    """Fields as columns in text."""
    count, d = fields["x"].shape
    axes = "xyz"[:d]
    names = [*axes, *(f"v{a}" for a in axes), *(f"F{a}{b}" for a in axes for b in axes)]
    table = np.column_stack([np.arange(count), *(fields[key].reshape(count, -1) for key in ("x", "v", "F"))])
    head = ",".join(["id", *names])
    np.savetxt(
        folder / "result_10.csv", table, fmt=["%d", *[form] * len(names)], delimiter=",", header=head, comments=""
    )


@pytest.mark.parametrize("form", ["npz", "%.17g", "%.9g"])
@pytest.mark.parametrize("d", [2, 3])
def test_single_precision_is_the_floor(tmp_path: Path, d: int, form: str) -> None:
    """As arrays of its type, printed in 17 digits, or in 9, which tell its numbers apart: the error is that floor."""
    layout = PLANE.layout(0.125, 4) if d == 2 else LAYOUT
    of = plane_answer(10) if d == 2 else {key: parts(rows(10))[key] for key in ("x", "v", "F")}
    short = {key: values.astype(np.float32) for key, values in of.items()}
    if form == "npz":
        np.savez(tmp_path / "result_10.npz", id=np.arange(len(layout.X)), **short)
    else:
        written(tmp_path, {key: values.astype(float) for key, values in short.items()}, form)
    frame = read(tmp_path, 10, layout.X, SPACING)
    found = compare(exact(d), layout.X, layout.V0, DT, {10: frame}, USUAL)
    for quantity, key in (("u", "x"), ("v", "v"), ("F", "F")):
        size = float(np.sqrt(np.mean(np.square(of[key])) * of[key][0].size))
        floor, error = found.floor[quantity], found.errors[quantity]["rms"]
        if form != "%.9g":
            assert floor == pytest.approx(EPS * size / np.sqrt(12), rel=0.01)
            assert floor / 3 < error < floor * 1.5
        assert 1e-10 * size < floor


def test_double_precision_is_no_single(tmp_path: Path) -> None:
    """Nor where one axis does not move, and its positions are round: those of the other tell."""
    of = parts(rows(10))
    of["x"][:, 2] = X[:, 2]
    written(tmp_path, of, "%.17g")
    frame = read(tmp_path, 10, X, SPACING)
    assert max(frame.resolution.values()) < 1e-12
    np.savez(tmp_path / "result_10.npz", id=np.arange(len(X)), **of)
    (tmp_path / "result_10.csv").unlink()
    assert max(read(tmp_path, 10, X, SPACING).resolution.values()) < 1e-12


# ---- a function, and the toy


def by_the_book(case: Case) -> Any:
    """The exact answer, with an error of dx^2."""
    at, error = case.array("X"), case.record.dx**2
    assert (at.shape[1], case.array("F").shape[1:], case.array("s").shape[1]) == (3, (3, 3), 6)
    assert case.body_force(at, 0.0).shape == at.shape == case.array("v", "_half").shape
    found = {}
    for step in case.record.frames:
        t = step * case.record.dt
        d = 3 if case.record.solution == "bump3d:A=0.05" else 2
        shift = exact(d).u(at[:, :d], t)
        found[step] = {"x": at + (1 + error) * np.pad(shift, ((0, 0), (0, 3 - shift.shape[1])))}
    return found, {"version": "1"}


@pytest.mark.slow
@pytest.mark.parametrize(("solution", "more"), [("bump3d:A=0.05", {}), ("clamped_shear", {"dim": 3})])
def test_a_function_is_judged(tmp_path: Path, solution: str, more: dict[str, Any]) -> None:
    axes = {"cells": [4, 6, 8, 12], "courant": [0.4, 0.2], "order": 2.0, "solution": solution, **more}
    done = mv.study("mms", solver=by_the_book, out=tmp_path / "study", **axes)
    done.check()
    assert set(done.frames()["runs"]["dim"]) == {3}
