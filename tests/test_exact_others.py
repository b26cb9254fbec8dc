"""Exactness battery of a solver of somebody else: sound ones hold to round-off, and each planted fault is seen."""

import json
import shlex
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fixtures_command import Call, caller
from fixtures_faults import FAULTS, faulty, toy

import mpm_verify as mv
from mpm_verify.cases.exact.others.judge import Answered, judged
from mpm_verify.cases.exact.others.names import TESTS, Cause, Left
from mpm_verify.cases.exact.others.state import Asked, asked
from mpm_verify.cases.exact.others.tests import CASES
from mpm_verify.cases.solvers.asking import ask
from mpm_verify.cases.solvers.callables import Case, register
from mpm_verify.mms.constitutive.tested import Tested
from mpm_verify.reports.sentences import exact, exact_others
from mpm_verify.solver.boundary import box
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.plugins import MATERIALS, METHODS, TRANSFERS, create
from mpm_verify.solver.state import Grid
from mpm_verify.solver.step import Model, Scheme, advance

NEO = "neo_hookean"
FAR = 1e6  # times its bound: what a planted fault is seen by

# which tests see a fault, of a few that together see all that the whole battery sees
ASKED = ("translate", "throw_growing", "sums", "keep", "affine_strained", "force", "divergence_x", "path_press")
STRAINS = {"affine_strained", "force", "path_press"}
SEEN: dict[str, set[str]] = {
    "none": set(),
    "V as it should be": set(),
    "force never added": {"throw_growing", "sums", "force"},
    "force of the other sign": {"throw_growing", "sums", "force"},
    "components of the force exchanged": {"throw_growing", "sums", "force"},
    "force a fifth too large": {"throw_growing", "sums", "force"},
    "force at x": {"force"},
    "force at (Y, X)": {"force"},
    "force one step late": {"throw_growing"},
    "stress twice as large": {"divergence_x"},
    "FLIP ratio ignored (PIC)": {"keep"},
    "symmetric part of L alone": STRAINS,
    "F advanced by L transposed": STRAINS,
    "factors of F in the other order": STRAINS,
    "F advanced twice": STRAINS,
    "F written by columns": {*STRAINS, "sums", "keep", "divergence_x"},
    "no half-step start": {"throw_growing", "sums", "force", "divergence_x"},
    "dt one per cent too long": set(ASKED) - {"keep"},
    "sigma one step late": {*STRAINS, "sums", "keep"},
    "sigma of the other sign": {*STRAINS, "sums", "keep", "divergence_x"},
    "sigma in other units": {*STRAINS, "sums", "keep", "divergence_x"},
    "plane stress": {*STRAINS, "sums", "keep", "divergence_x"},
    "V never updated": {*STRAINS, "sums", "keep", "divergence_x"},
    "output one step old": set(ASKED) - {"keep"},
    "ids permuted": set(ASKED) - {"sums"},
    "ids of other particles than X": set(ASKED),
    "increments keep what the wall took": set(),  # there is no wall
    "wall one node in": set(),
    "float32 output": set(),  # told, with bounds as wide
}
ENDS = {"half of the particles", "NaN", "an empty file", "crash", "hang"}


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


@cache
def case_of(test: str, material: str = NEO) -> Asked:
    return asked(test, material)


def outcomes(test: str, solver: Callable[[Case], Any], material: str = NEO, flip: bool = True) -> list[Tested]:
    case = case_of(test, material)
    run: Any = SimpleNamespace(solver=register(solver))
    answer = ask(run, case.exported, case.motion.b)
    assert answer.failure is None, answer.failure
    return judged(test, Answered(case, answer.frames, answer.told, flip))


def missed(tested: list[Tested]) -> list[str]:
    return [f"{one.name}: {one.residual:.2g} > {one.bound:.2g}" for one in tested if not one.passed]


def reference(method: str, transfer: str = "flip", stress: str = "usl") -> Callable[[Case], Any]:
    """The solver of this package as somebody else's."""

    def solve(case: Case) -> Any:
        r, material, basis = case.record, create(MATERIALS, case.record.material.name), create(METHODS, method)
        half = np.stack([np.stack([case.particles[f"r{k}{a}"] for a in "xy"], -1) for k in (1, 2)], 1)
        after = "_before" if stress == "usf" else ""
        x, F = case.array("x"), case.array("F")
        p = basis.populate(Layout(case.array("X"), case.particles["V0"], half), material.rho0, lambda X: moved(X, case))
        order = p.id
        p.x[:], p.F[:], p.v[:] = x[order], case.array("F", after)[order], case.array("v", "_half")[order]
        p.sigma[:] = case.array("s", after)[order]
        grid = Grid(r.dx, np.array(r.grid_lower), np.array(r.grid_upper))
        model = Model(grid, p, basis, material, box(grid, "free"), r.dt, Scheme(create(TRANSFERS, transfer), stress))
        found = {}
        for step in range(1, r.steps + 1):
            advance(model, lambda q, t: np.copyto(q.b, case.body_force(q.X, t)))
            if step in r.frames:
                found[step] = {name: p.in_initial_order(name) for name in ("x", "v", "F", "sigma")}
        assert F.shape == (r.particles, 2, 2)
        return found, {"v_lag": 0.5, "F_lag": float(stress == "usf")}

    return solve


def moved(X: Any, case: Case) -> Any:
    """Positions at the start of reference positions (n,2), by the F of the first particle."""
    at, x, F = case.array("X")[0], case.array("x")[0], case.array("F")[0]
    return x + (X - at) @ F.T


@pytest.mark.parametrize("test", CASES)
def test_the_toy_is_exact(test: str) -> None:
    """A margin: a tenth of what round-off may make. All that is there is judged."""
    tested = outcomes(test, toy("none"))
    assert not missed(tested)
    assert all(one.residual <= 0.1 * one.bound for one in tested)
    assert [one for one in tested if not one.reason]


@pytest.mark.slow
@pytest.mark.parametrize("fault", SEEN)
def test_a_fault_is_seen_by_the_tests_that_can(fault: str) -> None:
    """And by no other; by far."""
    found = {test: [one for one in outcomes(test, toy(fault)) if not one.passed] for test in ASKED}
    assert {test for test, bad in found.items() if bad} == SEEN[fault], found
    assert all(max(one.over for one in bad) > FAR for bad in found.values() if bad)


def test_every_fault_has_its_row() -> None:
    assert set(SEEN) | ENDS == set(FAULTS)


@pytest.mark.slow
@pytest.mark.parametrize("test", CASES)
@pytest.mark.parametrize(
    ("method", "transfer", "stress"),
    [("mpm", "pic", "usl"), ("mpm", "apic", "musl"), ("gimp", "flip", "musl"), ("cpdi", "flip", "usl"),
     ("bspline2", "flip", "usl"), ("bspline3", "apic", "usl"), ("mpm", "flip", "usf"),
     ("cpgimp", "flip", "usl"), ("gimp", "flip", "usl")],
)  # fmt: skip
def test_other_methods_are_exact_too(test: str, method: str, transfer: str, stress: str) -> None:
    tested = outcomes(test, reference(method, transfer, stress), flip=transfer == "flip")
    if method == "cpgimp" and test.startswith("divergence"):  # whose domains differ in width: small, and no round-off
        assert max(one.residual for one in tested) < 1e-4
        return
    assert not missed(tested)


def test_particles_stay_away_from_faces() -> None:
    """Next to a face a node has hardly any mass, and its acceleration is all rounding."""
    for test, case in CASES.items():
        motion = case.motion
        X = motion.layout(motion.dx, 4).X
        for step in range(motion.steps):
            cells = motion.x(X, step * motion.dt, short=True) / motion.dx
            assert test == "sums" or np.abs(cells - np.rint(cells)).min() > 2e-3
        assert (np.abs(np.array(motion.V) + motion.steps * np.array(motion.G)) * motion.steps * 0.3 < 4).all()


def test_what_is_left_of_a_turn_is_of_third_order() -> None:
    """F after the step of the turn against a rotation of F0: the cube of the angle over 6."""
    motion, angle = CASES["turn"].motion, 0.012
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    left = motion.F_at(motion.dt) @ np.linalg.inv(np.array(motion.F)) - R
    assert np.linalg.norm(left, 2) == pytest.approx(angle**3 / 6, rel=0.01)


def without(*names: str) -> Callable[[Case], Any]:
    """The toy without some arrays."""

    def solve(case: Case) -> Any:
        frames, told = toy("none")(case)
        return {step: {k: v for k, v in one.items() if k not in names} for step, one in frames.items()}, told

    return solve


def test_what_is_not_there_is_told_and_not_judged() -> None:
    tested = outcomes("throw", without("F", "sigma"))
    assert {one.name: one.reason for one in tested if one.reason} == {
        "throw F": Left.NO_COLUMN, "throw sigma": Left.NO_COLUMN,
    }  # fmt: skip
    assert not missed(tested)


def in_single(case: Case) -> Any:
    """The toy whose numbers are rounded to single precision."""
    frames, told = toy("none")(case)
    return {step: {k: v.astype(np.float32) for k, v in one.items()} for step, one in frames.items()}, told


def test_digits_of_the_files_make_the_bound() -> None:
    tested = outcomes("throw", in_single)
    assert not missed(tested)
    assert all(1e-8 < one.bound < 1e-5 for one in tested)
    assert max(one.residual for one in tested) > 1e-9


def test_a_level_that_is_not_exact_is_not_asked() -> None:
    def verlet(case: Case) -> Any:
        return toy("none")(case)[0], {"v_lag": 0.0, "F_lag": 0.5}

    reasons = {one.name: one.reason for one in outcomes("force", verlet)}
    assert reasons["force v"] == reasons["force F"] == Left.LEVEL
    assert not reasons["force x"]
    assert not reasons["force sigma"]  # of the F beside it
    assert missed(outcomes("throw", verlet)) != []  # v is that of half a step before


@pytest.mark.parametrize(
    ("fault", "code", "said"),
    [
        pytest.param("none", 0, "1.0216", marks=pytest.mark.slow),
        ("factors of F in the other order", 1, "affine_strained F"),
        ("crash", 4, "the wall is missing"),
        pytest.param("NaN", 4, "not finite in result_1.csv", marks=pytest.mark.slow),
        pytest.param("half of the particles", 4, "800 of the 1600 particles", marks=pytest.mark.slow),
        pytest.param("an empty file", 4, "result_1.csv cannot be read", marks=pytest.mark.slow),
        pytest.param("hang", 4, "longer than 5 s", marks=pytest.mark.slow),
    ],
)
def test_an_answer_by_command(fault: str, code: int, said: str, verify: Call, tmp_path: Path) -> None:
    """Sound: 0. With a fault 1; what ends or is not an answer is a failed result with a line, 4."""
    file = tmp_path / "mine.py"
    file.write_text(faulty(fault))
    words = shlex.join([sys.executable, str(file), "{case}", "{out}"])
    asks = ["--solver", words, "--test", "affine_strained", "--time-limit", "5"]
    found, out, err = verify("exact", *asks, "--json", "--junit", str(tmp_path / "j.xml"))
    assert found == code
    assert "Traceback" not in out + err
    assert said in out + (tmp_path / "j.xml").read_text()
    json.loads(out)


def test_a_study_of_a_function(tmp_path: Path) -> None:
    done = mv.study("exact", solver=toy("force one step late"), test=["throw", "throw_growing"], out=tmp_path)
    assert done.exit_code == 1
    failed = {check.name.partition(":")[0] for check in done.record.analysis.checks if check.outcome != "PASS"}
    assert failed == {"throw_growing x", "throw_growing v"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--test", "throw"], "--test is for a solver of your own"),
        (["--solver", "true {case} {out}", "--test", "thro"], "did you mean throw"),
        (["--solver", "true {case} {out}", "--material", "linear_elastic"], "small strains"),
        (["--solver", "true {case}"], "{out}"),
        (["--solver", "true {case} {out}", "--method", "gimp"], "leave it out beside --solver"),
    ],
)
def test_bad_input_is_one_line(words: list[str], said: str, verify: Call) -> None:
    code, _, err = verify("exact", *words)
    assert code == 2
    assert said in err
    assert err.count("\n") == 1


def test_all_have_their_words() -> None:
    assert list(CASES) == list(TESTS)
    assert set(exact_others.HELD) == set(TESTS)
    assert set(exact_others.HEADINGS) == set(TESTS.values())
    assert set(exact_others.PARTS) == set(Cause)
    assert set(exact_others.REASONS) == set(Left)
    assert not set(exact_others.HELD) & set(exact.HELD)
