"""Solutions of one dimension and axisymmetric ones: fields, closed forms, volumes, sources, answers, refusals."""

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp
from fixtures_command import Call, caller, one_line
from fixtures_export import AROUND, LINE, folder_of
from fixtures_residual import LAW, piola, residual, without_hoop

import mpm_verify as mv
from mpm_verify.cases.mms.external.errors import compare
from mpm_verify.cases.mms.external.hints import hints
from mpm_verify.cases.solvers.answer import Frame, around, framed
from mpm_verify.cases.solvers.components import spread
from mpm_verify.cases.solvers.levels import Levels
from mpm_verify.mms import derive as derivation
from mpm_verify.mms.components import square
from mpm_verify.mms.export.case import Names, export
from mpm_verify.mms.export.checking import Outcome, check
from mpm_verify.mms.export.files import files
from mpm_verify.mms.export.selfcheck import precisely
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.reports.export.case_folder import read, table_of
from mpm_verify.reports.sentences import commands, own_solver
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create, load
from mpm_verify.solver.state import Floats

LINEAR = create(MATERIALS, "linear_elastic")
RNG = np.random.default_rng(4)
RZ = RNG.uniform((0.55, 0.05), (1.45, 0.95), (25, 2))  # radius and height, in the section of bump_rz
ANGLE = RNG.uniform(0, 2 * np.pi, 25)
TIMES = (0.0013, 0.0047, 0.0113)
later = pytest.mark.slow


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


class Given:
    """Solution of a displacement, of radius and height where it is axisymmetric."""

    def __init__(self, d: int, u: Callable[..., list[Any]], around: bool = False) -> None:
        self.lower, self.u, self.axisymmetric = np.zeros(d), u, around

    def displacement(self, X: Any, t: Any) -> Any:
        return sp.Matrix(self.u(*X, t))


@cache
def made(text: str) -> Manufactured:
    """Exact fields of a solution."""
    return manufacture(create(SOLUTIONS, text), LAW, LAW.rho0)


# ---- derivation


def solid(flat: Any) -> Given:
    """Axisymmetric solution in three dimensions, around the axis z."""

    def u(X: Any, Y: Any, Z: Any, t: Any) -> list[Any]:
        r, z = sp.symbols("r z", positive=True)
        radius = sp.sqrt(X**2 + Y**2)
        out, up = (sp.sympify(c).xreplace({r: radius, z: Z}) for c in flat.displacement((r, z), t))
        return [out * X / radius, out * Y / radius, up]

    return Given(3, u)


@later
@pytest.mark.parametrize("text", ["bump_rz:A=0.04", "cylinder_rz"])
def test_axisymmetric_fields_are_those_of_three_dimensions(text: str) -> None:
    """Points around the axis: the existing derivation of three dimensions, turned back, to round-off."""
    flat, whole = made(text), manufacture(solid(create(SOLUTIONS, text)), LAW, LAW.rho0)
    at = RZ if text.startswith("bump") else RZ - (0.5, 0.0)
    c, s, zero, one = np.cos(ANGLE), np.sin(ANGLE), np.zeros(25), np.ones(25)
    Q = np.stack([np.stack([c, s, zero], 1), np.stack([zero, zero, one], 1), np.stack([-s, c, zero], 1)], axis=1)
    X = np.stack([at[:, 0] * c, at[:, 0] * s, at[:, 1]], axis=1)
    for t in TIMES:
        for name in ("u", "v", "b"):
            mine, turned = getattr(flat, name)(at, t), np.einsum("pij,pj->pi", Q, getattr(whole, name)(X, t))
            np.testing.assert_allclose(turned, np.column_stack([mine, zero]), rtol=0, atol=4e-15 * np.abs(mine).max())
        for name in ("F", "P"):
            mine, turned = square(getattr(flat, name)(at, t)), Q @ getattr(whole, name)(X, t) @ Q.transpose(0, 2, 1)
            np.testing.assert_allclose(turned, mine, rtol=0, atol=4e-15 * max(np.abs(mine).max(), LAW.E))
        full = whole.sigma(X, t)[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
        sigma = (Q @ full @ Q.transpose(0, 2, 1))[:, [0, 1, 2, 0], [0, 1, 2, 1]]
        np.testing.assert_allclose(flat.sigma(at, t), sigma, rtol=0, atol=4e-15 * LAW.E)


def ring(X: Any, t: Any) -> Any:
    """Radial displacement of expanding_ring at a radius."""
    plane = create(SOLUTIONS, "expanding_ring")
    c1, c2, c3 = plane.coefficients()
    return plane.A * sp.sin(plane.C * sp.pi * t / (plane.inner + plane.outer)) * (c3 * X**3 + c2 * X**2 + c1 * X)


def test_a_ring_is_the_one_in_plane_strain() -> None:
    """The problem of Wallstedt & Guilkey, of which the plane derivation knows x and y alone."""
    law = create(MATERIALS, "neo_hookean:nu=0.3")
    flat = manufacture(Given(2, lambda X, Y, t: [ring(X, t), 0], True), law, law.rho0)
    plane = manufacture(create(SOLUTIONS, "expanding_ring"), law, law.rho0)
    radius = np.linspace(0.42, 0.58, 9)
    X = radius[:, None] * np.column_stack([np.cos(ANGLE[:9]), np.sin(ANGLE[:9])])
    at = np.column_stack([radius, np.zeros(9)])
    for t in TIMES:
        b = plane.b(X, t)
        radial = (b * X).sum(axis=1) / radius
        np.testing.assert_allclose(flat.b(at, t), np.column_stack([radial, 0 * radius]), atol=1e-14 * np.abs(b).max())


STATIC = {  # displacements that a linear solid is in equilibrium with, without a force
    "thick cylinder (Lame)": lambda X, Y, t: [0.01 * X + 0.003 / X, 0.02 * Y],
    "thick sphere (Lame)": lambda X, Y, t: [
        0.01 * X + 0.003 * X / (X**2 + Y**2) ** sp.Rational(3, 2),
        0.01 * Y + 0.003 * Y / (X**2 + Y**2) ** sp.Rational(3, 2),
    ],
    "uniform expansion": lambda X, Y, t: [0.01 * X, -0.03 * Y],
}


@pytest.mark.parametrize("name", STATIC)
def test_closed_forms_need_no_force(name: str) -> None:
    """b = 0 to round-off of the terms that cancel; the stress of the cylinder is Lame's."""
    exact = manufacture(Given(2, STATIC[name], True), LINEAR, LINEAR.rho0)
    P, b = exact.P(RZ, 0.0), exact.b(RZ, 0.0)
    terms = np.abs(P[:, 4] / RZ[:, 0]).max() / LINEAR.rho0
    assert np.abs(b).max() < 4e-15 * terms
    if name.startswith("thick cylinder"):
        lam, mu, R = LINEAR.lam, LINEAR.mu, RZ[:, 0]
        trace = lam * (2 * 0.01 + 0.02)
        np.testing.assert_allclose(P[:, 0], trace + 2 * mu * (0.01 - 0.003 / R**2), rtol=1e-13)
        np.testing.assert_allclose(P[:, 4], trace + 2 * mu * (0.01 + 0.003 / R**2), rtol=1e-13)


@pytest.mark.parametrize(
    ("fault", "blind"),
    [
        (lambda P: [0, 0], {"uniform expansion"}),  # no hoop terms at all: P_xX is P_zz where it is uniform
        (lambda P: [P[0] * derivation.PER_RADIUS, P[2] * derivation.PER_RADIUS], set()),  # no hoop stress
        (lambda P: [(P[0] + P[4]) * derivation.PER_RADIUS, P[2] * derivation.PER_RADIUS], set()),  # of the other sign
        (lambda P: [(P[0] - P[4]) * derivation.PER_RADIUS, 0], {"uniform expansion", "thick cylinder (Lame)"}),
    ],
)
def test_a_hoop_term_that_is_missing_is_seen(fault: Any, blind: set[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """A closed form needs a force then, where the term is not zero."""
    monkeypatch.setattr(derivation, "hoop_terms", fault)
    for name, u in STATIC.items():
        exact = manufacture(Given(2, u, True), LINEAR, LINEAR.rho0)
        terms = np.abs(exact.P(RZ, 0.0)[:, 4] / RZ[:, 0]).max() / LINEAR.rho0
        assert (np.abs(exact.b(RZ, 0.0)).max() < 1e-3 * terms) == (name in blind), name


@pytest.mark.parametrize(
    "text", ["bar1d", "bar1d:n=2,A=0.05,phase=0.4", "bump1d:A=0.05", "cylinder_rz", "bump_rz:A=0.05"]
)
def test_residual_of_the_momentum_balance(text: str) -> None:
    assert residual(create(SOLUTIONS, text), made(text), piola) < 1e-7


@pytest.mark.parametrize("text", ["cylinder_rz", "bump_rz:A=0.05"])
def test_the_residual_sees_a_missing_hoop_stress(text: str) -> None:
    assert residual(create(SOLUTIONS, text), made(text), without_hoop) > 1e-2


def test_a_bar_is_the_one_on_a_square() -> None:
    line, plane = made("bar1d:A=0.05,n=2,phase=0.3"), made("bar:A=0.05,n=2,phase=0.3")
    X = np.linspace(0.02, 0.98, 17)
    at, flat = X[:, None], np.column_stack([X, 0 * X + 0.4])
    for t in TIMES:
        for name, part in (("u", (0,)), ("v", (0,)), ("b", (0,)), ("F", (0, 0)), ("P", (0, 0)), ("sigma", (0,))):
            mine, other = getattr(line, name)(at, t), getattr(plane, name)(flat, t)
            assert mine.shape == (17, *(1 for _ in part))
            np.testing.assert_allclose(
                mine.ravel(), other[(slice(None), *part)], rtol=0, atol=1e-14 * np.abs(other).max()
            )


# ---- solutions


def test_every_solution_says_what_it_is() -> None:
    assert (LINE, AROUND) == (["bar1d", "bump1d"], ["bump_rz", "cylinder_rz"])
    assert [load(SOLUTIONS, name).coordinates for name in (*LINE, *AROUND)] == [1, 1, 2, 2]


def test_the_cylinder_slides_along_its_walls_and_its_axis() -> None:
    """u.n = 0 and no shear on all four edges; on the axis the hoop stretch is the radial one."""
    exact, along = made("cylinder_rz"), np.linspace(0.0, 1.0, 11)
    edges = ((0, 0.0), (0, 1.0), (1, 0.0), (1, 1.0))
    for t in TIMES:
        for axis, value in edges:
            X = np.column_stack([along, along])
            X[:, axis] = value
            u, P, F = exact.u(X, t), exact.P(X, t), exact.F(X, t)
            assert np.abs(u[:, axis]).max() < 1e-16
            assert np.abs(P[:, 1:3]).max() < 1e-11 * LAW.E
            if (axis, value) == (0, 0.0):
                np.testing.assert_array_equal(F[:, 4], F[:, 0])
        assert np.abs(exact.P(RZ - (0.5, 0.0), t)[:, 1:3]).max() > 1e-2 * LAW.E


def test_the_bump_is_free_at_its_edges() -> None:
    exact, X = made("bump_rz:A=0.05"), np.array([[0.5, 0.3], [1.5, 0.6], [0.9, 0.0], [1.1, 1.0]])
    assert np.abs(exact.P(X, 0.004)).max() < 1e-12 * LAW.E
    line, ends = made("bump1d:A=0.05"), np.array([[0.0], [1.0]])
    assert np.abs(line.P(ends, 0.004)).max() < 1e-12 * LAW.E


def test_beside_the_axis_the_force_is_the_one_on_it() -> None:
    """A millionth of the width beside it, in double precision: within 1e-5 of the limit, at 30 digits."""
    exact = made("cylinder_rz")
    precise = precisely(exact.fields, exact.fields.b)
    for z, t in ((0.2, 0.003), (0.7, 0.012)):
        limit = [float(value) for value in precise(sp.Rational(1, 10**12), z, t)]
        size = np.abs(exact.b(RZ - (0.5, 0.0), t)).max()
        assert np.abs(exact.b(np.array([[1e-6, z]]), t)[0] - limit).max() < 1e-5 * size
    with np.errstate(all="ignore"):
        assert not np.isfinite(exact.b(np.array([[0.0, 0.3]]), 0.003)).all()


@pytest.mark.parametrize("text", ["cylinder_rz", "bump_rz", "bump_rz:bore=3,L=0.5"])
def test_volumes_are_per_radian(text: str) -> None:
    """2 pi times their sum is the volume of the body; a domain has its area times the radius of its middle."""
    solution = create(SOLUTIONS, text)
    layout = solution.layout(solution.L / 6, 9)
    (inner, below), (outer, above) = solution.lower, solution.upper
    whole = np.pi * (outer**2 - inner**2) * (above - below)
    assert 2 * np.pi * layout.V0.sum() == pytest.approx(whole, rel=1e-13)
    np.testing.assert_allclose(layout.V0, 4 * layout.r0[:, 0, 0] * layout.r0[:, 1, 1] * layout.X[:, 0], rtol=1e-14)


@pytest.mark.parametrize(
    "text", ["bar1d:A=0.5", "bar1d:n=0", "bump1d:A=0.2", "cylinder_rz:A=0.4", "cylinder_rz:B=0.2", "bump_rz:A=0.1",
             "bump_rz:bore=0.4", "bump_rz:bore=nan"],
)  # fmt: skip
def test_bad_parameters(text: str) -> None:
    with pytest.raises(ValueError, match="must be"):
        create(SOLUTIONS, text)


@later
@pytest.mark.parametrize(
    "text", ["bar1d:A=0.3", "bump1d:A=0.12", "cylinder_rz:A=0.3,B=0.15", "cylinder_rz:A=-0.3,B=0.15", "bump_rz:A=0.06"]
)
def test_the_body_never_turns_inside_out(text: str) -> None:
    """Near the bounds of the parameters det F > 0 everywhere and always."""
    solution, exact = create(SOLUTIONS, text), made(text)
    X = solution.layout(solution.L / 20, 2 ** len(solution.lower)).X
    J = [np.linalg.det(square(exact.F(X, t).reshape(len(X), -1))).min() for t in np.linspace(0, solution.duration, 33)]
    assert min(J) > 0.01


# ---- the folder


def test_a_folder_says_what_it_is(tmp_path: Path) -> None:
    from mpm_verify.reports.export.case_folder import write

    flat, line, plane = (json.loads(files(unchecked(name))["case.json"]) for name in ("cylinder_rz", "bar1d", "bump"))
    assert (flat["dimension"], flat["axisymmetric"], flat["body"]) == (2, True, "rectangle")
    assert (line["dimension"], line["body"], line["edges"]) == (1, "bar", {"left": "fixed", "right": "fixed"})
    assert "axisymmetric" not in plane
    assert "axisymmetric" not in line
    columns = unchecked("cylinder_rz").particles
    assert [name for name in columns if name[0] == "F"][:5] == ["Fxx", "Fxy", "Fyx", "Fyy", "Fzz"]
    assert [*unchecked("bar1d").particles][:6] == ["id", "X", "x", "vx", "Fxx", "sxx"]
    np.testing.assert_allclose(columns["m"], LAW.rho0 * columns["V0"], rtol=1e-15)
    for name, says in (("cylinder_rz", "2 pi times"), ("bar1d", "Uniaxial strain: F = diag(Fxx, 1, 1)")):
        write(tmp_path / name, unchecked(name))
        text = (tmp_path / name / "README.md").read_text()
        assert says in text
        assert "Plane strain" not in text
        assert "\n\n\n" not in text


@pytest.mark.parametrize(
    ("text", "language"),
    [
        ("cylinder_rz", "python"), ("bar1d", "python"),
        *(pytest.param(text, language, marks=later) for text in ("cylinder_rz", "bar1d")
          for language in ("c", "cpp", "fortran", "octave")),
        *(pytest.param(text, "fortran", marks=later) for text in ("bump_rz", "bump1d")),
    ],
)  # fmt: skip
def test_sources_agree(text: str, language: str, tmp_path: Path) -> None:
    folder = folder_of(text, tmp_path)
    record = read(folder)
    found = check(folder, language, record.dimension, table_of(folder, record))
    if found.outcome is Outcome.NO_COMPILER:
        pytest.skip(f"there is no {language}")
    assert found.outcome is Outcome.AGREES, found
    assert 0 < found.worst < 1
    assert found.rows == 40


@pytest.mark.parametrize(("old", "new"), [("per_X = 1", "per_X = -1"), ("per_X = 1", "per_X = 1.00000000001*1")])
def test_an_altered_hoop_term_is_caught(old: str, new: str, tmp_path: Path) -> None:
    folder = folder_of("cylinder_rz", tmp_path)
    file = folder / "body_force.py"
    assert old in file.read_text()
    file.write_text(file.read_text().replace(old, new))
    found = check(folder, "python", 2, table_of(folder, read(folder)))
    assert (found.outcome, found.column[0]) == (Outcome.DISAGREES, "b")


# ---- answers

DT, STEPS = 2e-4, (10, 20, 35)
EVERY = ["bar1d", "cylinder_rz"]


@cache
def unchecked(text: str, cells: int = 6) -> Any:
    """Case without values to check its sources with."""
    solution = create(SOLUTIONS, text)
    return export(Names(text, "neo_hookean"), solution, LAW, cells, 2 ** len(solution.lower), checked=False)


def answer(text: str, cells: int = 6) -> tuple[Any, Floats, dict[int, Frame]]:
    """Case, positions, and frames that are exact, v half a step before x."""
    case, exact = unchecked(text, cells), made(text)
    X = np.column_stack([case.particles[axis] for axis in "XY"[: case.record.dimension]])
    fields = {
        step: {"x": exact.x(X, step * DT), "v": exact.v(X, (step - 0.5) * DT), "sigma": exact.sigma(X, step * DT),
               "F": exact.F(X, step * DT).reshape(len(X), -1)}
        for step in STEPS
    }  # fmt: skip
    case = replace(case, record=replace(case.record, dt=DT))
    return (
        case,
        X,
        {
            step: Frame(parts, {name: np.full_like(part, 1e-15) for name, part in parts.items()})
            for step, parts in fields.items()
        },
    )


@pytest.mark.parametrize("text", EVERY)
def test_an_exact_answer_has_no_errors_and_no_hints(text: str) -> None:
    case, X, frames = answer(text)
    found = compare(made(text), X, case.particles["V0"], DT, frames, Levels())
    assert set(found.errors) == {"u", "v", "F", "sigma"}
    assert all(norms["max"] <= 1e-13 * max(found.scale[q], 1) for q, norms in found.errors.items())
    assert hints(made(text), case, frames, Levels()) == {}


@pytest.mark.parametrize("text", EVERY)
def test_wrong_answers_are_hinted_at(text: str) -> None:
    """Stress of the other sign, F of a step before, motion of three steps before; nonsense crashes nothing."""
    case, X, frames = answer(text)
    exact = made(text)

    def changed(**more: Callable[[int, Frame], Floats]) -> dict[str, float]:
        other = {
            step: Frame(frame.fields | {q: f(step, frame) for q, f in more.items()}, frame.last)
            for step, frame in frames.items()
        }
        return hints(exact, case, other, Levels())

    assert changed(sigma=lambda step, frame: -frame.fields["sigma"])["sigma_sign"] == pytest.approx(-1)
    late = changed(F=lambda step, frame: exact.F(X, (step - 1) * DT).reshape(len(X), -1))
    assert late.get("F_lag") == 1.0
    assert changed(x=lambda step, frame: exact.x(X, (step - 3) * DT))["shift"] == 3.0
    for size in (1e-6, 1e-2, 1.0):
        rng = np.random.default_rng(1)
        other = {step: Frame({q: values + size * rng.normal(size=values.shape) for q, values in frame.fields.items()})
                 for step, frame in frames.items()}  # fmt: skip
        assert all(np.isfinite(value) for value in hints(exact, case, other, Levels()).values())


@pytest.mark.parametrize(("scale", "told"), [(1.01, True), (1.001, False)])
def test_a_wave_that_the_grid_slows_is_not_a_rounded_step(scale: float, told: bool) -> None:
    """Lumped hats with 2 particles in a cell slow it by 0.11 (pi dx / L)^2, on 32 cells a thousandth."""
    case, X, frames = answer("bar1d:A=1e-6", 32)
    exact = made("bar1d:A=1e-6")
    late = {step: Frame({"x": exact.x(X, scale * step * DT)}) for step in frames}
    found = hints(exact, case, late, Levels())
    assert ("time_scale" in found) == told
    if told:
        assert found["time_scale"] == pytest.approx(scale, abs=2e-4)
        assert "is dt rounded" in own_solver.hint("time_scale", found["time_scale"])


def test_f_is_read_with_its_hoop_stretch() -> None:
    """As five columns, an array of five or of 3 x 3; without Fzz there is no F."""
    case, X, frames = answer("cylinder_rz")
    good, count = frames[10].fields, len(X)
    full = square(good["F"])
    for given in ({"F": good["F"]}, {"F": full}, {f"F{end}": good["F"][:, k] for k, end in enumerate(
        ("xx", "xy", "yx", "yy", "zz"))}, {"F": good["F"][:, :4], "Fzz": good["F"][:, 4]}):  # fmt: skip
        columns = spread({"id": np.arange(count), "x": good["x"], "sigma": good["sigma"], **given})
        frame = around(framed(columns, X, case.record.dx / 2, "frame", 10))
        np.testing.assert_array_equal(frame.fields["F"], good["F"])
        np.testing.assert_array_equal(frame.fields["sigma"], good["sigma"])
    columns = spread({"id": np.arange(count), "x": good["x"], "F": good["F"][:, :4]})
    assert "F" not in around(framed(columns, X, case.record.dx / 2, "frame", 10)).fields


def perfect(case: Any) -> Any:
    """Solver that knows the exact solution and is off by h^2."""
    exact = made({1: "bar1d", 2: "cylinder_rz"}[case.record.dimension])
    X, dt, off = case.array("X"), case.record.dt, 1 + case.record.dx**2 / 10
    assert case.array("F").shape == (len(X), *((1, 1) if X.shape[1] == 1 else (5,)))
    assert case.body_force(X, 0.0).shape == X.shape
    return {
        step: {"x": X + off * exact.u(X, step * dt), "v": off * exact.v(X, (step - 0.5) * dt),
               "F": exact.F(X, step * dt) * off, "sigma": exact.sigma(X, step * dt) * off}
        for step in case.record.frames
    }  # fmt: skip


@later
@pytest.mark.parametrize(("text", "cells"), [("bar1d", [8, 16, 32]), ("cylinder_rz", [4, 8, 16])])
def test_a_python_function_is_judged(text: str, cells: list[int], tmp_path: Path) -> None:
    done = mv.study("mms", solver=perfect, solution=text, cells=cells, order=2, courant=0.4, out=tmp_path / "study")
    errors = done.frames()["errors"].query("courant == 0.4")
    assert done.exit_code in (0, 3)  # three levels may be too few to be sure
    for quantity in ("u", "v", "F", "sigma"):
        values = errors[errors["quantity"] == quantity].sort_values("cells")["rms"].to_numpy()
        assert np.log2(values[-2] / values[-1]) == pytest.approx(2, abs=0.1), quantity


def test_a_body_without_walls_has_the_same_dimensions() -> None:
    assert [commands.FREE[commands.kind(one)] for one in ("swirl", "bar1d:n=2", "cylinder_rz", "swirl3d")] == [
        "bump", "bump1d", "bump_rz", "bump3d"
    ]  # fmt: skip


# ---- what is refused

OURS = "true {case} {out}"
REFUSED = {
    "the reference solver, one": (["mms", "--solution", "bar1d"], "has one dimension and is for a solver of your own"),
    "the reference solver, around": (["mms", "--solution", "bump_rz"], "is in plane strain: verify mms --solver"),
    "graded": (["graded", "--solution", "cylinder_rz"], "solver of your own"),
    "one in two": (["export", "bar1d", "--dim", "2", "--to", "case"], "has one dimension, dim = 2 cannot be"),
    "one in three": (["export", "bar1d", "--dim", "3", "--to", "case"], "has one dimension, dim = 3 cannot be"),
    "around in three": (["export", "bump_rz", "--dim", "3", "--to", "case"], "is axisymmetric, dim = 3 cannot be"),
    "around in one": (["export", "bump_rz", "--dim", "1", "--to", "case"], "take bar1d or bump1d"),
    "no square": (["export", "bump_rz", "--ppc", "2", "--to", "case"], "not a square number"),
    "none": (["export", "bar1d", "--ppc", "0", "--to", "case"], "not a whole number"),
    "digits of one": (["compare", "--solver", OURS, "--solution", "bar1d"], "has one dimension, and the reference two"),
    "digits around": (["compare", "--solver", OURS, "--solution", "bump_rz"], "and the reference is in plane strain"),
    "expectations": (["expectations", "--solution", "bump_rz"], "is axisymmetric, and nothing of its own"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(verify: Call, name: str, tmp_path: Path) -> None:
    words, says = REFUSED[name]
    assert says in one_line(verify(*words))
    assert list(tmp_path.iterdir()) == []


def test_dim_may_be_typed(verify: Call) -> None:
    code, out, _ = verify("export", "bump1d", "--dim", "1", "--cells", "6", "--ppc", "3", "--to", "case")
    assert (code, "18 particles" in out) == (0, True)


@later
def test_hencky_has_an_energy_around_an_axis() -> None:
    """A sphere under uniform strain: the same stress in all directions, and no force."""
    law = create(MATERIALS, "hencky")
    exact = manufacture(Given(2, lambda X, Y, t: [0.1 * X, 0.1 * Y], True), law, law.rho0)
    pressure = (3 * law.lam + 2 * law.mu) * np.log(1.1) / 1.1**3
    np.testing.assert_allclose(exact.sigma(RZ, 0.0), np.tile([pressure] * 3 + [0], (25, 1)), rtol=0, atol=1e-12 * law.E)
    assert np.abs(exact.b(RZ, 0.0)).max() < 1e-14 * pressure / RZ[:, 0].min()
