"""An answer in which nothing moves, in digits of many kinds: a FAIL, but where a sound answer would look the same."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from fixtures_faults import case_of

import mpm_verify as mv
from mpm_verify.cases.mms.exact import manufactured
from mpm_verify.cases.mms.external.evidence import Evidence
from mpm_verify.cases.mms.external.motion import still
from mpm_verify.cases.solvers.answer import read
from mpm_verify.cases.solvers.callables import Case
from mpm_verify.cases.solvers.digits import last_digits, rounding
from mpm_verify.cases.solvers.levels import Levels
from mpm_verify.mms.export.case import Exported
from mpm_verify.reports.sentences import own_solver
from mpm_verify.solver.state import Floats

LAW = "neo_hookean"
Write = Callable[[Path, Floats], None]


def printed(form: str) -> Write:
    """Positions as C prints them."""
    return lambda path, x: table(path, [[form % value for value in row] for row in x])


def shortest(path: Path, x: Floats) -> None:
    """Positions in as many digits as they need: dyadic ones have few."""
    table(path, [[repr(float(value)) for value in row] for row in x])


def rounded(path: Path, x: Floats) -> None:
    """Positions with five decimals, and no zeros at their end."""
    shortest(path, x.round(5))


def table(path: Path, rows: list[list[str]]) -> None:
    path.with_suffix(".csv").write_text("id,x,y\n" + "".join(f"{k},{x},{y}\n" for k, (x, y) in enumerate(rows)))


def double(path: Path, x: Floats) -> None:
    np.savez(path.with_suffix(".npz"), id=np.arange(len(x)), x=x)


def single(path: Path, x: Floats) -> None:
    np.savez(path.with_suffix(".npz"), id=np.arange(len(x)), x=x.astype(np.float32))


WRITERS: dict[str, Write] = {
    "17 digits": printed("%.17g"), "shortest": shortest, "6 digits": printed("%.6g"), "6 decimals": printed("%.6f"),
    "powers": printed("%.7e"), "3 digits": printed("%.3g"), "5 decimals": rounded, "float64": double, "float32": single,
}  # fmt: skip
SOUND = 1.01  # of the exact displacement

# what is said of a run in which nothing moves: on 12 cells numbers are not dyadic, on 16 they have at most 6 digits
STILL = {
    ("bump", 12): {"17 digits", "shortest", "6 digits", "6 decimals", "powers", "float64", "float32"},
    ("bump", 16): {"17 digits", "shortest", "6 digits", "6 decimals", "powers", "float64", "float32"},
    ("clamped_shear:G=1e-6", 16): {"17 digits", "shortest", "6 digits", "6 decimals", "powers", "float64", "float32"},
    ("bump:A=0.05", 8): set(WRITERS),
}


def said(case: Exported, solution: str, write: Write, factor: float, out: Path) -> dict[str, float]:
    """What is said of an answer whose displacement from the start is this factor times the exact one."""
    exact, p = manufactured(solution, LAW), case.particles
    X, x = (np.stack([p[a], p[b]], axis=1) for a, b in (("X", "Y"), ("x", "y")))
    out.mkdir(exist_ok=True)
    steps = case.record.frames[3::4]
    for step in steps:
        write(out / f"result_{step}", x + factor * (exact.x(X, step * case.record.dt) - x))
    frames = {step: read(out, step, X, case.record.dx / 2) for step in steps}
    return still(Evidence(exact, case, frames, Levels()))


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize(("solution", "cells"), STILL)
def test_what_does_not_move_is_told_in_any_digits(solution: str, cells: int, name: str, tmp_path: Path) -> None:
    """And nothing of a sound answer in the same digits, but that no digit of it changes where all are too few."""
    case = case_of(solution, cells)
    motionless = said(case, solution, WRITERS[name], 0.0, tmp_path / "still")
    sound = said(case, solution, WRITERS[name], SOUND, tmp_path / "sound")
    assert set(motionless) == {"still" if name in STILL[solution, cells] else "unmoved"}
    assert "still" not in sound
    assert "unmoved" not in sound or "unmoved" in motionless
    if "unmoved" in motionless:
        assert motionless["unmoved"] > 1
        assert own_solver.hint("unmoved", motionless["unmoved"]).endswith("write 17 digits.")


def start_of(case: Case) -> tuple[dict[int, dict[str, Floats]], dict[str, float]]:
    """A solver that gives back the start."""
    return {step: {"x": case.array("x")} for step in case.record.frames}, {}


def start_in_three_digits(case: Case) -> tuple[dict[int, dict[str, Floats]], dict[str, float]]:
    """The same with three digits, as texts."""
    x = np.array([[f"{value:.3g}" for value in row] for row in case.array("x")])
    return {step: {"x": x} for step in case.record.frames}, {}


def sound_in_four_digits(case: Case) -> tuple[dict[int, dict[str, Floats]], dict[str, float]]:
    """A sound solver with an error of dx², and four digits."""
    exact, X = manufactured("bump:A=0.05", LAW), case.array("X")
    frames = {}
    for step in case.record.frames:
        u = exact.u(X, step * case.record.dt) * (1 + case.record.dx**2)
        frames[step] = {"x": np.array([[f"{value:.4g}" for value in row] for row in X + u])}
    return frames, {}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("solver", "solution", "verdict", "code"),
    [
        (start_of, "bump", "FAIL", "nothing_moves"),
        (start_in_three_digits, "bump", "INCONCLUSIVE", "near_round_off"),
        (start_in_three_digits, "bump:A=0.05", "FAIL", "nothing_moves"),
        (sound_in_four_digits, "bump:A=0.05", "INCONCLUSIVE", "near_round_off"),
    ],
)
def test_the_verdict(solver: Callable[[Case], object], solution: str, verdict: str, code: str, tmp_path: Path) -> None:
    """Grids whose positions are all dyadic, so that they have few digits however many are written."""
    axes = {"cells": [4, 8, 16, 32], "ppc": 4, "courant": [0.4, 0.2], "order": 2.0}
    done = mv.study("mms", solver=solver, solution=solution, out=tmp_path / "study", **axes)
    (found,) = (one for one in done.record.findings if one.counts)
    assert str(found.verdict.outcome) == verdict
    assert str(found.verdict.reason.code) == code
    told = own_solver.hints(done.record.results.values())
    assert [line for line in told if "nothing moves" in line.lower()] == (
        [] if solver is sound_in_four_digits else told
    )
    assert bool(told) == (solver is not sound_in_four_digits)


def test_last_digits_of_numbers() -> None:
    """Of a text from the digits that the longest has, of an array from its type; zero where none is known."""
    texts = {"x": np.array(["0.5", "12.25", "0"]), "v": np.array(["1e-3", "2.25e-3", "nan"])}
    last = last_digits(texts)
    assert last["x"].tolist() == [1e-4, 1e-2, 0.0]
    assert last["v"].tolist() == pytest.approx([1e-6, 1e-6, 0.0], rel=1e-12)
    assert last_digits({"x": np.array(["0.5", "12.25"])})["x"].tolist() == [1e-2, 1e-2]
    assert last_digits({"x": np.array([0.5, 2.0], dtype=np.float32)})["x"].tolist() == [2.0**-24, 2.0**-22]
    assert last_digits({"id": np.array(["1", "2"]), "k": np.array([1, 2])}) == {}
    assert rounding(np.array([0.0, 1e-3])) == pytest.approx(1e-3 / 12**0.5)
    assert rounding(np.zeros(3)) == 0.0
