"""Solutions and cases in three dimensions: fields, slices of plane strain, what is refused, answers, the auditor."""

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp
from fixtures_command import Call, caller, one_line
from fixtures_export import PLANE, SOLID, exported, folder_of

from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.mms.case import expectation
from mpm_verify.cases.mms.run import Run
from mpm_verify.mms.components import COMPONENTS
from mpm_verify.mms.derive import derive
from mpm_verify.mms.export.checking import Outcome, check
from mpm_verify.mms.export.files import files
from mpm_verify.mms.export.selfcheck import precisely
from mpm_verify.mms.export.slice import Slice
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.mms.measure import Sampler, boundary
from mpm_verify.reports.export.case_folder import read, table_of
from mpm_verify.solver.layout import per_side, rectangle
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create, load
from mpm_verify.solver.state import Floats


def later(*values: str) -> list[Any]:
    """Values of slow tests."""
    return [pytest.param(value, marks=pytest.mark.slow) for value in values]


EXTRA = ["bump3d:A=0.05", "bump3d:A=0.1,L=2,C=30", "swirl3d:A=-1.2,B=0.25,L=0.7,C=40"]
every = pytest.mark.parametrize(
    "text", ["bump3d", *(pytest.param(one, marks=pytest.mark.slow) for one in [*SOLID[1:], *EXTRA])]
)
COMPLEX_STEP = 1e-30
STENCIL = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))  # sixth order


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


@cache
def made(text: str, material: str = "neo_hookean") -> tuple[Any, Any, Manufactured]:
    """Solution, material and exact fields."""
    solution, law = create(SOLUTIONS, text), create(MATERIALS, material)
    return solution, law, manufacture(solution, law, law.rho0)


def inside(solution: Any, count: int = 40) -> Floats:
    """Reference positions in the body."""
    return np.random.default_rng(5).uniform(0.03, 0.97, (count, 3)) * solution.L


# ---- fields


@every
def test_residual_of_the_momentum_balance(text: str) -> None:
    """rho0 (u'' - b) = Div P, where F and v are complex steps of the displacement, and P is the textbook's."""
    solution, law, exact = made(text)
    symbols, time = sp.symbols("X Y Z"), sp.Symbol("t")
    u: Any = sp.lambdify((*symbols, time), list(solution.displacement(symbols, time)), "numpy")

    def step(X: Floats, t: float, direction: int) -> Floats:
        at = [*X.T.astype(complex), np.full(len(X), t, complex)]
        at[direction] = at[direction] + 1j * COMPLEX_STEP
        return np.stack([np.broadcast_to(c, len(X)) for c in u(*at)], axis=-1).imag / COMPLEX_STEP

    def gradient(X: Floats, t: float) -> Floats:
        return np.eye(3) + np.stack([step(X, t, k) for k in range(3)], axis=-1)

    def stress(X: Floats, t: float) -> Floats:
        F = gradient(X, t)
        inverse = np.linalg.inv(F).transpose(0, 2, 1)
        return law.mu * (F - inverse) + law.lam * np.log(np.linalg.det(F))[:, None, None] * inverse

    X, h, tau = inside(solution), 1e-3 * solution.L, 2e-3 * solution.L / solution.C
    for t in solution.duration * np.array([0.0, 0.13, 0.4, 0.77]):
        acceleration = sum(c * (step(X, t + k * tau, 3) - step(X, t - k * tau, 3)) for k, c in STENCIL) / tau
        divergence = np.zeros_like(X)
        for axis in range(3):
            e = h * np.eye(3)[axis]
            divergence += sum(c * (stress(X + k * e, t) - stress(X - k * e, t))[..., axis] for k, c in STENCIL) / h
        residual = np.abs(acceleration - divergence / law.rho0 - exact.b(X, t)).max(axis=0)
        size = np.abs(acceleration).max() + np.abs(divergence).max() / law.rho0
        assert (residual <= 1e-7 * size).all()
        F, P = gradient(X, t), stress(X, t)
        np.testing.assert_allclose(exact.F(X, t), F, rtol=0, atol=1e-13)
        np.testing.assert_allclose(exact.P(X, t), P, rtol=0, atol=1e-12 * law.E)
        np.testing.assert_allclose(exact.v(X, t), step(X, t, 3), rtol=0, atol=1e-12 * solution.C)
        sigma = P @ F.transpose(0, 2, 1) / np.linalg.det(F)[:, None, None]
        np.testing.assert_allclose(
            exact.sigma(X, t), sigma[:, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]], rtol=0, atol=1e-12 * law.E
        )


@pytest.mark.slow
def test_stress_of_another_material_follows_from_its_energy() -> None:
    """P = dW/dF by the complex step."""
    solution, law, exact = made("swirl3d", "linear_elastic:E=200,nu=0.1,rho0=2")
    X, t = inside(solution), 0.3 * solution.duration
    F, P = exact.F(X, t), np.empty((len(X), 3, 3))
    for i in range(3):
        for j in range(3):
            moved = F.astype(complex)
            moved[:, i, j] += 1j * COMPLEX_STEP
            energy = law.energy([[moved[:, a, b] for b in range(3)] for a in range(3)], np.log)
            P[:, i, j] = energy.imag / COMPLEX_STEP
    np.testing.assert_allclose(exact.P(X, t), P, rtol=0, atol=1e-12 * law.E)


@every
def test_faces_are_free_and_the_start_is_undeformed(text: str) -> None:
    """u = 0 and F = I on the six faces and at t = 0; P and sigma vanish with F = I."""
    solution, _, exact = made(text)
    fields, L, t = exact.fields, solution.L, 0.3 * solution.duration
    X = inside(solution)
    for axis, at in ((k, at) for k in range(3) for at in (0.0, L)):
        X_face = X.copy()
        X_face[:, axis] = at
        assert np.abs(exact.u(X_face, t)).max() < 1e-14 * L
        assert np.abs(exact.F(X_face, t) - np.eye(3)).max() < 1e-13
    assert (exact.u(X, 0.0) == 0).all()
    assert (exact.F(X, 0.0) == np.eye(3)).all()
    assert np.abs(exact.P(X, t)).max() > 1e-6 * np.abs(exact.F(X, t) - np.eye(3)).max()
    undeformed = dict(zip(list(fields.inner)[:9], np.eye(3).ravel(), strict=True))
    assert [float(sp.sympify(e).xreplace(undeformed)) for e in (*fields.P, *fields.sigma)] == [0] * 15


@pytest.mark.slow
def test_the_swirl_has_all_components_and_turns() -> None:
    solution, _, exact = made("swirl3d")
    X = solution.layout(1 / 12, 8).X
    shift = np.max([np.abs(exact.F(X, t) - np.eye(3)).max(axis=0) for t in np.linspace(0, 0.02, 17)], axis=0)
    assert shift.min() > 0.1
    turned = np.degrees(Sampler(exact)(X, np.linspace(0, 0.02, 17)).turned.max())
    assert turned == pytest.approx(np.degrees(0.6), abs=1.0)  # half-way the middle is turned by A


@pytest.mark.slow
@pytest.mark.parametrize("A", [-1.499, 0.0, 1.499])
@pytest.mark.parametrize("B", [-0.299, 0.299])
def test_the_swirl_stays_invertible_inside_its_bounds(A: float, B: float) -> None:
    solution, _, exact = made(f"swirl3d:A={A},B={B}")
    X = solution.layout(1 / 12, 8).X
    assert min(np.linalg.det(exact.F(X, t)).min() for t in np.linspace(0, 0.02, 17)) > 0.3


@pytest.mark.parametrize(
    "text", ["bump3d:A=0.09", "bump3d:A=-0.2,L=2", "bump3d:L=0", "bump3d:C=-1", "swirl3d:A=1.5", "swirl3d:B=0.3",
             "swirl3d:L=nan"],
)  # fmt: skip
def test_bad_parameters(text: str) -> None:
    with pytest.raises(ValueError, match="must be"):
        create(SOLUTIONS, text)


# ---- plane strain, one cell thick


@pytest.mark.parametrize("text", ["clamped_shear", *later("generalised_vortex")])
def test_a_slice_has_the_fields_of_the_plane_solution(text: str) -> None:
    """At 30 digits and in every bit of a double, whatever Z; what is new is zero, or one in Fzz."""
    plane = create(SOLUTIONS, text)
    law = create(MATERIALS, plane.material)
    fields = [derive(one, law, law.rho0, exact=True) for one in (plane, Slice(plane, 0.25))]
    X = plane.layout(0.25, 4).X[:5].tolist()
    for name, size in (("b", 2), ("u", 2), ("v", 2)):
        flat, solid = (precisely(of, getattr(of, name)) for of in fields)
        for at in X:
            values = [float(value) for value in solid(*at, 0.3, 0.0037)]
            assert values == [*(float(value) for value in flat(*at, 0.0037)), 0.0][: size + 1]
    places = {"F": (0, 1, 3, 4), "sigma": (0, 1, 2, 3)}
    for name, kept in places.items():
        flat, solid = (precisely(of, getattr(of, name)) for of in fields)
        rest = {"F": [0, 0, 0, 0, 1], "sigma": [0, 0]}[name]
        for at in X:
            values = [float(value) for value in solid(*at, 0.3, 0.0037)]
            np.testing.assert_allclose(
                [values[k] for k in kept], [float(v) for v in flat(*at, 0.0037)], rtol=1e-15, atol=1e-18 * law.E
            )
            assert [value for k, value in enumerate(values) if k not in kept] == rest


@pytest.mark.parametrize(
    "text",
    ["clamped_shear", *(pytest.param(one, marks=pytest.mark.slow) for one in ("bump", "affine", "expanding_ring"))],
)
def test_the_particles_of_a_slice(text: str) -> None:
    """Layers of the plane particles, each with its part of the thickness; the two faces in z slip."""
    flat, solid = exported(text), exported(text, dim=3)
    record, dx = solid.record, solid.record.dx
    assert (record.dimension, record.layers, record.ppc) == (3, 2, 8)
    assert (flat.record.layers, flat.record.ppc) == (0, 4)
    assert record.particles == 2 * flat.record.particles == len(solid.particles["id"])
    assert (record.lower[2], record.upper[2]) == (0, dx) == (record.grid_lower[2], record.grid_upper[2])
    assert record.grid_lower[:2] == flat.record.grid_lower
    assert record.edges == {**flat.record.edges, "back": "roller", "front": "roller"}
    np.testing.assert_allclose(np.unique(solid.particles["Z"]), dx * np.array([0.25, 0.75]), rtol=1e-14)
    for name, values in flat.particles.items():
        thick = {"V0": dx / 2, "m": dx / 2}.get(name, 1.0)
        if name != "id":
            size = record.material.constants["E"] if name[0] == "s" else np.abs(values).max()
            np.testing.assert_allclose(
                solid.particles[name], np.repeat(thick * values, 2), rtol=0, atol=1e-14 * size, err_msg=name
            )
    assert (solid.particles["z"] == solid.particles["Z"]).all()
    assert (solid.particles["Fzz"] == 1).all()
    still = ("vz", "vz_half", "Fxz", "Fyz", "Fzx", "Fzy", "sxz", "syz", "sxz_before", "Fzx_before")
    assert all((solid.particles[name] == 0).all() for name in still)
    assert {f"s{end}" for end in COMPONENTS[3]} <= set(solid.particles)
    assert json.loads(files(solid)["case.json"])["layers"] == 2
    assert "layers" not in json.loads(files(flat)["case.json"])


def test_the_readme_of_a_slice_says_so(tmp_path: Path) -> None:
    from mpm_verify.reports.export.case_folder import write

    write(tmp_path / "case", exported("clamped_shear", dim=3))
    text = (tmp_path / "case" / "README.md").read_text()
    assert "one cell thick, with 2 layers" in text
    assert "back: roller" in text
    assert "Plane strain, per unit" not in text
    assert "\n\n\n" not in text


@pytest.mark.parametrize("language", ["c", "python"])
@pytest.mark.parametrize("text", ["clamped_shear", *later("expanding_ring")])
def test_the_sources_of_a_slice_agree(text: str, language: str, tmp_path: Path) -> None:
    from mpm_verify.reports.export.case_folder import write

    write(tmp_path / "case", exported(text, dim=3))
    record = read(tmp_path / "case")
    found = check(tmp_path / "case", language, record.dimension, table_of(tmp_path / "case", record))
    assert found.outcome is Outcome.AGREES, found
    assert 0 < found.worst < 1


@pytest.mark.slow
@pytest.mark.parametrize(("old", "new"), [("dFzy_dX = ", "dFzy_dX = -1.0*"), ("aZ = ", "aZ = 1.00000000001*")])
def test_an_altered_source_is_caught(old: str, new: str, tmp_path: Path) -> None:
    folder = folder_of("swirl3d", tmp_path)
    file = folder / "body_force.h"
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))
    record = read(folder)
    found = check(folder, "c", 3, table_of(folder, record))
    assert found.outcome is Outcome.DISAGREES, found
    assert found.column[0] == "b"


# ---- two dimensions are what they were

SAME = {  # files of axis_aligned on 4 cells, as without three dimensions, all that SymPy 1.14 alone decides
    "README.md": "dba3c70ca735bff2",
    "body_force.cuh": "6dfd3b62dbf08ee4",
    "body_force.f90": "31933e2b5b6e1dac",
    "body_force.h": "3d5188cb80864dd1",
    "body_force.hpp": "9349025cf838596b",
    "body_force.jl": "3675286edf84ff0c",
    "body_force.py": "1e93d701a3ca08ce",
    "body_force_infix.txt": "949ba1fadfe18e0c",
    "case.json": "84f4b3b4f97fab57",
    "case.txt": "04c20a301a734b95",
    "octave/body_force.m": "df00f5139f038aac",
    "octave/body_force_at.m": "4deb4efa76be0f4d",
    "octave/deformation.m": "fb4eeca16faae8ce",
    "octave/displacement.m": "4de45e0eb77cddcb",
    "octave/newton_step.m": "c8853000ff96f6a3",
    "octave/reference_position.m": "4e4b647f0fd3747d",
    "octave/stress.m": "bc233838e432602f",
    "octave/velocity.m": "7cfdf3b52fe9f491",
}


def test_a_plane_case_is_what_it_was(tmp_path: Path) -> None:
    """Byte for byte; tables depend on the machine's sine in their last digit."""
    if not sp.__version__.startswith("1.14"):
        pytest.skip("another SymPy orders terms in its own way")
    folder = folder_of("axis_aligned", tmp_path)
    found = {name: hashlib.sha256((folder / name).read_bytes()).hexdigest()[:16] for name in SAME}
    assert found == SAME
    here = {str(file.relative_to(folder)) for file in folder.rglob("*") if file.is_file()}
    assert {name for name in here if not name.endswith((".csv", ".vtu"))} == set(SAME)


# ---- layouts


def test_a_block_is_filled() -> None:
    layout = rectangle(np.zeros(3), np.array([1.0, 0.5, 0.25]), 0.25, 8)
    assert len(layout) == 4 * 2 * 1 * 8
    assert layout.V0.sum() == pytest.approx(0.125, rel=1e-14)
    np.testing.assert_array_equal(layout.r0, np.broadcast_to(np.eye(3) / 16, (64, 3, 3)))
    X, normal = boundary(layout)
    assert len(X) == 2 * (8 * 4 + 8 * 2 + 4 * 2)
    assert (np.abs(normal).sum(axis=1) == 1).all()
    np.testing.assert_allclose((X * normal).sum(axis=1).max(), 1.0)


def test_particles_of_a_cell() -> None:
    assert [per_side(count, 3) for count in (1, 8, 27, 64, 125, 1000)] == [1, 2, 3, 4, 5, 10]
    for wrong in (0, -8, 4, 9, 26):
        with pytest.raises(ValueError, match="not a cube number"):
            per_side(wrong, 3)


# ---- what is refused, and what is taken

OURS = "true {case} {out}"
REFUSED = {
    "the reference solver": (["mms", "--solution", "bump3d"], "--solver './mine {case} {out}' --solution bump3d"),
    "among others": (["mms", "--solution", "bump,swirl3d"], "--solution swirl3d"),
    "a slice": (["mms", "--dim", "3"], "--solution axis_aligned --dim 3"),
    "graded": (["graded", "--solution", "swirl3d"], "solver of your own"),
    "two dimensions of three": (["mms", "--solution", "bump3d", "--dim", "2", "--solver", OURS], "three dimensions"),
    "four dimensions": (["mms", "--dim", "4", "--solver", OURS], "dim = 4 must be 2"),
    "no cube": (["mms", "--solution", "bump3d", "--ppc", "4", "--solver", OURS], "not a cube number"),
    "no square": (["mms", "--dim", "3", "--ppc", "8", "--solver", OURS], "not a square number"),
    "export no cube": (["export", "bump3d", "--ppc", "9", "--to", "case"], "not a cube number"),
    "export in two": (["export", "swirl3d", "--dim", "2", "--to", "case"], "three dimensions"),
    "export in one": (["export", "bump", "--dim", "1", "--to", "case"], "dim = 1 cannot be; take bar1d or bump1d"),
    "too many": (["export", "bump3d", "--cells", "128", "--to", "case"], "particles are too many"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(verify: Call, name: str, tmp_path: Path) -> None:
    words, says = REFUSED[name]
    assert says in one_line(verify(*words))
    assert list(tmp_path.iterdir()) == []


def test_usual_cells_are_those_of_three_dimensions() -> None:
    study = build(Asked("mms", {"solver": [OURS], "solution": ["bump3d", "bump"], "order": [2.0]}), "verify mms")
    usual = {run.solution: [] for run in study.runs}
    for run in study.runs:
        if run.courant == 0.4:
            usual[run.solution].append((run.cells, run.ppc, run.dim))
    assert usual["bump3d"] == [(n, 8, 3) for n in (4, 6, 8, 12, 16)]
    assert usual["bump"] == [(n, 4, 2) for n in (8, 16, 32, 64)]


def test_sizes_of_runs() -> None:
    solid = Run(method="true", solution="bump3d", dim=3, cells=6, ppc=8, solver=OURS)
    thick = Run(method="true", solution="bump", dim=3, cells=6, ppc=4, solver=OURS)
    assert (solid.particles, solid.nodes, str(solid)) == (6**3 * 8, 7**3, "true 6³ cells, 8 per cell")
    assert (thick.particles, thick.nodes) == (6**2 * 8, 2 * 7**2)
    assert str(thick) == "true 6² cells, 4 per cell, one cell thick"


def test_what_is_expected() -> None:
    """Order 2 of a method at small amplitude, with 8 or 27 particles in a cell; nothing of a large one."""
    run = Run("mpm", "bump3d", "neo_hookean", 8, 8, dim=3, solver=OURS)
    found = expectation(run, "u", "rms")
    assert found
    assert found.order == 2
    assert expectation(Run("mpm", "swirl3d", "neo_hookean", 8, 8, dim=3, solver=OURS), "u", "rms") is None


def test_every_solution_says_its_dimension() -> None:
    """The number of coordinates of its class is that of its box; a run knows it without making one."""
    assert SOLID == ["bump3d", "swirl3d"]
    for name in [*PLANE, *SOLID]:
        kind: Any = load(SOLUTIONS, name)
        assert getattr(kind, "coordinates", 2) == len(kind().lower)
