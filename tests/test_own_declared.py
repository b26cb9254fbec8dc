"""Declarations of an adapter: precision, the path of its time step, its time levels, in a command or a study file."""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fixtures_command import Call, caller, one_line

import mpm_verify as mv
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.study_file import study_of
from mpm_verify.cases.mms.case import canonical
from mpm_verify.cases.mms.execute import setup
from mpm_verify.cases.mms.external.execute import exported
from mpm_verify.cases.mms.run import STARTS, Run
from mpm_verify.cases.solvers.callables import Case
from mpm_verify.mms.manufacture import manufacture
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create

MODEL = create(MATERIALS, "neo_hookean")
EXACT = manufacture(create(SOLUTIONS, "clamped_shear"), MODEL, MODEL.rho0)
TYPED = f"{sys.executable} {{case}} {{out}}"
TESTS = Path(__file__).resolve().parent


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def called(tmp_path: Path, solver: Any, **more: Any) -> Any:
    axes = {"solution": "clamped_shear", "cells": [8, 12, 16, 24], "courant": [0.4, 0.2], "order": 2.0, **more}
    return mv.study("mms", solver=solver, ppc=4, out=tmp_path / "study", **axes)


# ---- precision


@pytest.mark.parametrize(
    ("given", "single", "double"),
    [
        ("bump", "bump:A=0.001", "bump"),
        ("bump:A=1e-6", "bump:A=1e-06", "bump"),
        ("bump:A=0.02", "bump:A=0.02", "bump:A=0.02"),
        ("bump:C=50", "bump:A=0.001,C=50", "bump:C=50"),
        ("clamped_shear:G=1e-6", "clamped_shear:G=1e-06", "clamped_shear:G=1e-06"),
        ("clamped_shear", "clamped_shear", "clamped_shear"),
    ],
)
def test_single_precision_has_a_larger_amplitude_where_none_is_given(given: str, single: str, double: str) -> None:
    """And the name of the solution says so, so that what it says is the same solution again."""
    asked = {"solution": given, "solver": TYPED}
    made = {p: canonical({**asked, "precision": p})["solution"] for p in ("single", "double")}
    assert {p: parts(name) for p, name in made.items()} == {"single": parts(single), "double": parts(double)}
    assert canonical({"solution": made["single"], "precision": "single"})["solution"] == made["single"]
    wanted, found = create(SOLUTIONS, single), create(SOLUTIONS, made["single"])
    assert wanted == found


def parts(specification: str) -> tuple[str, dict[str, float]]:
    name, _, given = specification.partition(":")
    return name, {key: float(value) for key, _, value in (item.partition("=") for item in given.split(",") if item)}


def test_the_case_says_its_precision() -> None:
    run = Run(solver=TYPED, solution="bump:A=0.001", material="neo_hookean", cells=4, precision="single")
    assert exported(run).record.precision == "single"


@pytest.mark.slow
def test_an_exported_case_has_the_amplitude_of_its_precision(verify: Call) -> None:
    code, _, _ = verify("export", "bump", "--cells", "4", "--precision", "single", "--to", "case")
    record = json.loads(Path("case/case.json").read_text())
    assert (code, record["precision"], record["solution"]) == (0, "single", "bump:A=0.001")
    assert "precision single\n" in Path("case/case.txt").read_text()


@pytest.mark.slow
def test_floors_know_the_precision(tmp_path: Path) -> None:
    """Walk of one rounding a step: eps, square root of the steps, and the size of the positions or of F."""

    def exact(case: Case) -> Any:
        X = case.array("X")
        times = {step: step * case.record.dt for step in case.record.frames}
        return {step: {"x": EXACT.x(X, t), "F": EXACT.F(X, t)} for step, t in times.items()}

    for precision, kind in (("single", np.float32), ("double", np.float64)):
        done = mv.study("mms", solver=exact, solution="clamped_shear", cells=[4], precision=precision,
                        out=tmp_path / precision)  # fmt: skip
        (result,) = done.record.results.values()
        walk = float(np.finfo(kind).eps) * np.sqrt(result.steps)
        extent = 1 - 1 / 8  # of the positions of 8 particles along the side
        assert result.floor["F"] == pytest.approx(walk)
        assert result.floor["u"] == pytest.approx(walk * extent)


def test_what_cannot_be_declared(verify: Call) -> None:
    line = one_line(verify("mms", "--quick", "--solver", TYPED, "--precision", "half"))
    assert "precision = 'half' must be one of double, single" in line
    assert "--precision is for a solver of your own" in one_line(verify("mms", "--quick", "--precision", "single"))
    line = one_line(verify("mms", "--quick", "--solver", TYPED, "--time-step", "h3"))
    assert "time_step = 'h3' must be one of h, h2" in line


SINGLE = {  # lines of the example in Python: what makes it compute in single precision
    'm, V0 = table["m"], table["V0"]': (
        'm, V0 = table["m"].astype(np.float32), table["V0"].astype(np.float32)\n'
        "X, x, v, F, lower = (values.astype(np.float32) for values in (X, x, v, F, lower))"
    ),
    "s = (x - lower) / dx": "s = (x - lower) / np.float32(dx)",
    "s = s - base": "s = s - base.astype(np.float32)",
    "exported.body_force(X, (step - 1) * dt)": "exported.body_force(X, (step - 1) * dt).astype(np.float32)",
    "np.zeros(len(node)), np.zeros((len(node), 2)), np.zeros((len(node), 2))": (
        "np.zeros(len(node), np.float32), *np.zeros((2, len(node), 2), np.float32)"
    ),
    "np.eye(2)": "np.eye(2, dtype=np.float32)",
    "    if step in record": (
        "    assert {a.dtype for a in (x, v, F, sigma, velocity)} == {np.dtype(np.float32)}\n    if step in record"
    ),
    "%.17g": "%.9g",
}


@pytest.mark.slow
def test_amplitude_of_single_precision(verify: Call, tmp_path: Path) -> None:
    """At 1e-3 rounding changes the error of u by less than 1e-3 of it; at 1e-6 it is more than the method's own error.

    The declared floor is above what rounding does, and within twenty times of it.
    """
    verify("example", "python", "toy")
    text = Path("toy/solver.py").read_text()
    for old, new in SINGLE.items():
        assert old in text
        text = text.replace(old, new)
    Path("toy/single.py").write_text(text)
    found: dict[str, Any] = {}
    for amplitude in ("1e-3", "1e-6"):
        for file in ("solver", "single"):
            typed, name = f"{sys.executable} toy/{file}.py {{case}} {{out}}", f"bump:A={amplitude}"
            out = tmp_path / f"{amplitude}-{file}"
            done = mv.study("mms", solver=typed, solution=name, cells=[12], precision="single", out=out)
            (found[amplitude, file],) = done.record.results.values()
    error = {key: result.errors["u"]["rms"] for key, result in found.items()}
    assert error["1e-3", "single"] == pytest.approx(error["1e-3", "solver"], rel=1e-3)
    rounding = error["1e-6", "single"]
    assert rounding > 5 * error["1e-6", "solver"]
    assert rounding < found["1e-6", "single"].floor["u"] < 20 * rounding


# ---- path of the time step


def test_paths_meet_at_eight_cells() -> None:
    """Along h2 twice the cells take four times the steps, with a solver of somebody else and with the reference."""
    run = {(p, n): Run(solution="bump", material="neo_hookean", method="mpm", cells=n, time_step=p)
           for p in ("h", "h2") for n in (4, 8, 16)}  # fmt: skip
    steps = {key: setup(one)[2] for key, one in run.items()}
    assert steps["h", 8] == steps["h2", 8] == 40
    assert (steps["h", 16], steps["h2", 16], steps["h2", 4]) == (80, 160, 10)
    theirs = Run(solver=TYPED, solution="bump", material="neo_hookean", cells=16, time_step="h2")
    assert exported(theirs).record.steps == 160
    assert exported(theirs).record.courant == 0.2
    assert len({one.digest for one in run.values()}) == len(run)


def implicit_euler(case: Case) -> Any:
    """Errors of dx^2 and of dt, the same on 8 cells with the usual step."""
    r = case.record
    usual = 0.4 / 8 / 100  # dt there
    X = case.array("X")
    return {s: {"x": X + (1 + r.dx**2 + r.dt / usual / 64) * EXACT.u(X, s * r.dt)} for s in r.frames}


@pytest.mark.slow
def test_an_order_along_a_path(tmp_path: Path) -> None:
    """What is of first order in dt has order 2 where dt falls with h^2; the time step is not halved apart from it."""
    done = called(tmp_path / "h2", implicit_euler, time_step="h2", courant=0.4)
    assert done.outcome == "PASS"
    assert done.verdicts[0]["observed"] == pytest.approx(2.0, abs=0.02)
    assert {run.courant for run in done.record.study.runs} == {0.4}
    (plan,) = (one for one in done.record.study.plans if one.judged)
    assert plan.expectation.source == "given with --order along dt ~ h2"
    done = called(tmp_path / "h", implicit_euler)
    assert done.outcome != "PASS"
    assert done.verdicts[0]["observed"] < 1.5


def test_a_step_that_is_too_long_on_few_cells(verify: Call) -> None:
    """The Courant number that is named is that of eight cells, and can be run."""
    usual = ["mms", "--method", "mpm", "--solution", "bump", "--cells", "4,8", "--dry-run"]
    words = [*usual, "--time-step", "h2"]
    line = one_line(verify(*words, "--courant", "0.6"))
    named = float(line.partition("take --courant ")[2].split(",")[0])
    assert 0.3 < named < 0.6
    assert verify(*words, "--courant", f"{named:g}")[0] == 0
    assert verify(*usual, "--courant", "0.6")[0] == 0


# ---- time levels


def leapfrog(case: Case) -> Any:
    """A particle in each point that its own force moves: of second order with v at -dt/2, of first with v at 0."""
    X, x, v, h = case.array("X"), case.array("x"), case.array("v", "_half"), 1e-6
    dt, found = case.record.dt, {}
    for step in range(1, case.record.steps + 1):
        t = (step - 1) * dt
        v = v + dt * (EXACT.v(X, t + h) - EXACT.v(X, t - h)) / (2 * h)
        x = x + dt * v
        if step in case.record.frames:
            found[step] = {"x": x}
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("start", "order"), [("half.now.start", 2.0), ("zero.now.start", 1.0)])
def test_a_start_that_is_given_is_judged(tmp_path: Path, start: str, order: float) -> None:
    """On all levels. The toy has no error of dx, so a smaller time step is asked for; of order one the rule is sure."""
    done = called(tmp_path, leapfrog, start=start, cells=[4, 6, 8, 12])
    (verdict,) = done.verdicts
    assert verdict["code"] == ("time_step_coupled" if order == 2 else "falls_short")
    assert verdict["observed"] == pytest.approx(order, abs=0.1)
    assert {run.start for run in done.record.study.runs} == {start}


def test_several_starts_are_a_search_in_which_nothing_is_judged() -> None:
    values = {"solver": [TYPED], "solution": ["bump"], "start": list(STARTS), "order": [2.0]}
    study = build(Asked("mms", values), "verify mms")
    assert not any(plan.judged for plan in study.plans)
    assert {run.start for run in study.runs} == set(STARTS)


ADAPTER = """
import sys
from pathlib import Path
import numpy as np
sys.path.insert(0, {tests!r})
from toy_solver import Toy
case, out = map(Path, sys.argv[1:])
toy = Toy(case, "first")
frames = [int(toy.case[f"frames_{{k + 1}}"]) for k in range(int(toy.case["frames"]))]
for step in range(1, int(toy.case["steps"]) + 1):
    toy.step()
    if step in frames:
        np.savez(out / f"state{{step:04d}}.npz", u=toy.x - toy.X)
"""
STUDY = """
case = "mms"
title = "Mine"

[run]
solver = "{python} {program} {{case}} {{out}}"
solver_version = "1.2"
solution = "bump"
columns = "map.toml"
precision = "double"
time_step = "h"
start = "{start}"
order = 2.0

[sweep]
cells = [8, 12, 16, 24, 32]
"""
MAP = """
files = "state{step:04d}.npz"
[columns]
id = "row"
x = {from = "u", add = "X"}
"""


def test_a_study_file_is_an_adapter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All that it declares reaches the runs."""
    import tomllib

    monkeypatch.chdir(tmp_path)
    Path("map.toml").write_text(MAP)
    text = STUDY.format(python=sys.executable, program="mine.py", start="zero.now.end").replace('"double"', '"single"')
    study = study_of("mine", tomllib.loads(text.replace('"h"', '"h2"')), "verify sweep mine.toml")
    assert {(r.solution, r.precision, r.time_step, r.start, r.order, r.solver_version) for r in study.runs} == {
        ("bump:A=0.001", "single", "h2", "zero.now.end", 2.0, "1.2")
    }
    assert all('"state{step:04d}.npz"' in run.columns for run in study.runs)
    assert [plan.quantity for plan in study.plans if plan.judged] == ["u"]


@pytest.mark.slow
@pytest.mark.parametrize(("start", "code"), [("half.before.start", 0), ("half.now.start", 1)])
def test_an_adapter_declares_the_start_that_its_step_needs(verify: Call, tmp_path: Path, start: str, code: int) -> None:
    """Update-stress-first has order 2 from F at -dt, which is a PASS, and order 1 from F at 0."""
    Path("mine.py").write_text(ADAPTER.format(tests=str(TESTS)))
    Path("map.toml").write_text(MAP)
    Path("mine.toml").write_text(STUDY.format(python=sys.executable, program=tmp_path / "mine.py", start=start))
    ended, out, _ = verify("sweep", "mine.toml", "--json", "--out", "study")
    (verdict,) = json.loads(out)["verdicts"]
    assert (ended == 0) == (code == 0), verdict
    assert (verdict["observed"] > 1.9) == (code == 0)
