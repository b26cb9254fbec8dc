"""A solver of somebody else: its command, its answer in any order and form, its failures, and its digits."""

import json
import shutil
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fixtures_command import Call, caller, one_line

import mpm_verify as mv
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.mms.external.errors import compare
from mpm_verify.cases.mms.external.hints import hints
from mpm_verify.cases.mms.run import STARTS, Run
from mpm_verify.cases.solvers import command
from mpm_verify.cases.solvers.answer import Frame, read
from mpm_verify.cases.solvers.callables import Case, register, version
from mpm_verify.cases.solvers.levels import Levels, levels
from mpm_verify.mms.export.case import Names, export
from mpm_verify.mms.export.start import named
from mpm_verify.mms.manufacture import manufacture
from mpm_verify.reports import words as spelt
from mpm_verify.reports.export.junit import write_junit
from mpm_verify.reports.export.summary import markdown
from mpm_verify.reports.sentences import commands, failures, own_solver
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create
from mpm_verify.solver.state import Floats
from mpm_verify.verify.terminal import table

HEAD = "id,X,Y,x,y,vx,vy,Fxx,Fxy,Fyx,Fyy,sxx,syy,szz,sxy"
LAW = create(MATERIALS, "neo_hookean")
SOLUTION = create(SOLUTIONS, "clamped_shear")
EXACT = manufacture(SOLUTION, LAW, LAW.rho0)
LAYOUT = SOLUTION.layout(0.25, 4)
X, STEPS, DT, USUAL = LAYOUT.X, (3, 7), 1e-3, Levels()


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def rows(step: int, v_lag: float = 0.5, F_lag: float = 0.0) -> Floats:
    """The exact answer at a step, (P,15)."""
    t = step * DT
    x, v = EXACT.x(X, t), EXACT.v(X, t - v_lag * DT)
    F, sigma = EXACT.F(X, t - F_lag * DT).reshape(-1, 4), EXACT.sigma(X, t - F_lag * DT)
    return np.column_stack([np.arange(len(X)), X, x, v, F, sigma])


def written(path: Path, table: Floats, head: str = HEAD, mark: str = ",", form: str = "%.17g") -> None:
    np.savetxt(path, table, fmt=form, delimiter=mark, header=head.replace(",", mark), comments="")


def errors(folder: Path, told: Levels = USUAL) -> dict[str, dict[str, float]]:
    frames = {step: read(folder, step, X, 0.125) for step in STEPS}
    return compare(EXACT, X, LAYOUT.V0, DT, frames, told).errors


# ---- an answer that is right


def csv(folder: Path, step: int, table: Floats) -> None:
    written(folder / f"result_{step}.csv", table)


def permuted(folder: Path, step: int, table: Floats) -> None:
    written(folder / f"result_{step}.csv", np.random.default_rng(step).permutation(table))


def by_position(folder: Path, step: int, table: Floats) -> None:
    shuffled = np.random.default_rng(step).permutation(table)[:, 1:]
    written(folder / f"result_{step}.csv", shuffled, HEAD.removeprefix("id,"))


def columns_in_another_order(folder: Path, step: int, table: Floats) -> None:
    written(folder / f"result_{step}.csv", table[:, ::-1], ",".join(HEAD.split(",")[::-1]))


def tabs(folder: Path, step: int, table: Floats) -> None:
    written(folder / f"result_{step}.tsv", table, mark="\t")


def spaces(folder: Path, step: int, table: Floats) -> None:
    written(folder / f"result_{step}.txt", table, mark=" ")


def arrays(folder: Path, step: int, table: Floats) -> None:
    parts = dict(zip(["x", "v", "F", "sigma"], np.split(table[:, 3:], (2, 4, 8), axis=1), strict=True))
    np.savez(folder / f"result_{step}.npz", id=table[:, 0], **parts)


def three_dimensional_arrays(folder: Path, step: int, table: Floats) -> None:
    x, v, F, s = np.split(table[:, 3:], (2, 4, 8), axis=1)
    zero = np.zeros(len(x))
    full_F = np.stack([F[:, 0], F[:, 1], zero, F[:, 2], F[:, 3], zero, zero, zero, zero + 1], axis=1).reshape(-1, 3, 3)
    full_s = np.stack([s[:, 0], s[:, 3], zero, s[:, 3], s[:, 1], zero, zero, zero, s[:, 2]], axis=1).reshape(-1, 3, 3)
    vectors = {"x": np.column_stack([x, zero]), "v": np.column_stack([v, zero]), "X": table[:, 1:3]}
    np.savez(folder / f"result_{step}.npz", F=full_F, sigma=full_s, **vectors)


def points(folder: Path, step: int, table: Floats) -> None:
    import meshio

    x = np.column_stack([table[:, 3:5], np.zeros(len(table))])
    data = {"id": table[:, 0], "v": table[:, 5:7], "F": table[:, 7:11], "sigma": table[:, 11:15]}
    cells = [("vertex", np.arange(len(x))[:, None])]
    meshio.Mesh(x, cells, point_data=data).write(folder / f"result_{step}.vtu")


FORMS = [csv, permuted, by_position, columns_in_another_order, tabs, spaces, arrays, three_dimensional_arrays, points]


@pytest.mark.parametrize("form", FORMS)
def test_the_exact_answer_has_no_error(tmp_path: Path, form: Callable[[Path, int, Floats], None]) -> None:
    for step in STEPS:
        form(tmp_path, step, rows(step))
    found = errors(tmp_path)
    size = {"u": 1e-15, "v": 1e-12, "F": 1e-14, "sigma": 1e-14 * LAW.E}
    assert set(found) == set(size)
    assert all(norms["max"] < size[quantity] for quantity, norms in found.items()), found


@pytest.mark.parametrize(("v_lag", "F_lag"), [(0.0, 0.0), (0.5, 1.0), (-0.5, -1.0)])
def test_fields_are_compared_at_the_levels_that_are_told(tmp_path: Path, v_lag: float, F_lag: float) -> None:
    """And at no other: the usual ones leave an error of v and F."""
    for step in STEPS:
        csv(tmp_path, step, rows(step, v_lag, F_lag))
    (tmp_path / "result.json").write_text(json.dumps({"v_lag": v_lag, "F_lag": F_lag, "version": "mine 1.2"}))
    told = levels(tmp_path)
    assert told.version == "mine 1.2"
    right, usual = errors(tmp_path, told), errors(tmp_path)
    assert right["v"]["max"] < 1e-12
    assert (usual["v"]["max"] > 1e-6) == (v_lag != 0.5)
    assert right["F"]["max"] < 1e-14
    assert (usual["F"]["max"] > 1e-6) == (F_lag != 0)


def test_norms_of_a_known_error() -> None:
    """Every particle is off by 3 and 4 in x: rms, max and final are 5; printed shrinks with what there is."""
    frames = {step: Frame({"x": EXACT.x(X, step * DT) + np.array([3.0, 4.0])}) for step in STEPS}
    found = compare(EXACT, X, LAYOUT.V0, DT, frames, Levels())
    assert set(found.errors) == {"u"}
    for norm in ("rms", "max", "final"):
        assert found.errors["u"][norm] == pytest.approx(5.0, rel=1e-12)
    assert found.errors["u"]["printed"] == pytest.approx(5.0 / np.sqrt(2 * len(X)), rel=1e-12)


def test_columns_that_are_missing_are_not_judged(tmp_path: Path) -> None:
    for step in STEPS:
        written(tmp_path / f"result_{step}.csv", rows(step)[:, [0, 3, 4, 5, 6]], "id,x,y,vx,vy")
    assert set(errors(tmp_path)) == {"u", "v"}


@pytest.mark.parametrize(("form", "floor"), [("%.17g", 1e-17), ("%.6f", 3e-7), ("%.4e", 1e-5), ("%.9g", 1e-10)])
def test_digits_of_a_file_are_a_floor(tmp_path: Path, form: str, floor: float) -> None:
    """Within a factor of three of the error that they make, measured."""
    for step in STEPS:
        written(tmp_path / f"result_{step}.csv", rows(step), form=form)
    frames = {step: read(tmp_path, step, X, 0.125) for step in STEPS}
    found = compare(EXACT, X, LAYOUT.V0, DT, frames, Levels())
    assert floor / 5 < found.floor["u"] < 5 * floor
    if floor > 1e-12:
        assert found.errors["u"]["rms"] / 3 < found.floor["u"] < 3 * found.errors["u"]["rms"]


# ---- an answer that is none


def broken(text: str) -> Callable[[Path], None]:
    return lambda path: path.write_text(text) and None


def cut(keep: slice) -> Callable[[Path], None]:
    return lambda path: written(path, rows(3)[keep])


def with_value(value: float, column: int = 3) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        table = rows(3)
        table[5, column] = value
        written(path, table)

    return write


BAD: dict[str, tuple[Callable[[Path], None], FailureKind, str]] = {
    "empty": (broken(""), FailureKind.UNREADABLE, "result_3.csv cannot be read: it is empty"),
    "a header alone": (broken(HEAD + "\n"), FailureKind.OTHER_PARTICLES, "0 of the 64 particles"),
    "no numbers": (broken("id,x,y\n" + "a,b,c\n" * 64), FailureKind.UNREADABLE, "'a' in column id is not a number"),
    "binary": (lambda path: path.write_bytes(b"\x00\xff\xfe" * 99) and None, FailureKind.UNREADABLE, "cannot be read"),
    "ragged": (broken("id,x,y\n0,1,2\n1,2,3,4,5\n"), FailureKind.UNREADABLE, "cannot be read"),
    "half of the particles": (cut(slice(0, 32)), FailureKind.OTHER_PARTICLES, "32 of the 64"),
    "one particle lost": (cut(slice(1, None)), FailureKind.OTHER_PARTICLES, "63 of the 64"),
    "ids twice": (
        with_value(0.0, 0),
        FailureKind.OTHER_PARTICLES,
        "63 of the 64 particles that were given: id 0 is there twice",
    ),
    "an id that is none": (with_value(999.0, 0), FailureKind.OTHER_PARTICLES, "id 999 is none of 0 to 63"),
    "not a number": (with_value(np.nan), FailureKind.NOT_FINITE, "not finite"),
    "infinite": (with_value(np.inf), FailureKind.NOT_FINITE, "not finite"),
    "1e200": (with_value(-1e200), FailureKind.NOT_FINITE, "a value of 1e+200 in result_3.csv, too large for an error"),
    "no x": (broken("id,y\n" + "".join(f"{k},0\n" for k in range(64))), FailureKind.NO_COLUMN, "no column x"),
    "no name": (broken("x,y\n" + "0,0\n" * 64), FailureKind.NO_COLUMN, "no column id"),
    "other positions": (broken("X,Y,x,y\n" + "9,9,9,9\n" * 64), FailureKind.OTHER_PARTICLES, "0 of the 64"),
}


@pytest.mark.parametrize("name", BAD)
def test_an_answer_that_cannot_be_used(tmp_path: Path, name: str) -> None:
    write, kind, says = BAD[name]
    write(tmp_path / "result_3.csv")
    with pytest.raises(RunFailed) as caught:
        read(tmp_path, 3, X, 0.125)
    assert caught.value.failure.kind is kind
    assert says in failures.failure(caught.value.failure)


def test_a_frame_that_is_missing(tmp_path: Path) -> None:
    with pytest.raises(RunFailed) as caught:
        read(tmp_path, 3, X, 0.125)
    assert failures.failure(caught.value.failure) == "the solver has not written result_3.csv at step 3"


@pytest.mark.parametrize("text", ["", "[]", "{", '{"v_lag": "x"}', '{"v_lag": 99}', '{"F_lag": null}', "null"])
def test_levels_that_cannot_be_read(tmp_path: Path, text: str) -> None:
    (tmp_path / "result.json").write_text(text)
    with pytest.raises(RunFailed, match="unreadable"):
        levels(tmp_path)


# ---- the command


def test_the_version_is_of_the_program_and_of_its_files(tmp_path: Path) -> None:
    script = tmp_path / "mine.py"
    script.write_text("x = 1\n")
    typed = f"{sys.executable} {script} {{case}} {{out}}"
    before = command.version(typed)
    assert command.version(typed) == before
    script.write_text("x = 2\n")
    assert command.version(typed) != before
    assert command.program(typed) == "mine.py"


REFUSED = {
    "no program": ("./nothing_there {case} {out}", "there is no program"),
    "no case": ("python {out}", "has no {case}"),
    "no out": ("python {case}", "has no {out}"),
    "neither": ("python", "has no {case} and no {out}"),
    "a quote": ("python '{case} {out}", "cannot be split"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_command_that_cannot_be_run(verify: Call, name: str) -> None:
    typed, says = REFUSED[name]
    assert says in one_line(verify("mms", "--quick", "--solver", typed))


def test_a_program_that_may_not_be_executed(verify: Call, tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text("x = 1\n")
    line = one_line(verify("mms", "--quick", "--solver", f"{tmp_path}/own.py {{case}} {{out}}"))
    assert f"type chmod +x {tmp_path}/own.py, or name what runs it, such as 'python {tmp_path}/own.py" in line


@pytest.mark.parametrize("option", ["--transfer=apic", "--stress=usf", "--layout=graded", "--no-staggered"])
def test_what_is_for_the_reference_solver(verify: Call, option: str) -> None:
    typed = f"{sys.executable} {{case}} {{out}}"
    assert "leave it out beside --solver" in one_line(verify("mms", "--quick", "--solver", typed, option))


def test_a_method_to_be_judged_as(verify: Call) -> None:
    typed = f"{sys.executable} {{case}} {{out}}"
    line = one_line(verify("mms", "--quick", "--solver", typed, "--as", "gmp"))
    assert "did you mean gimp?" in line


def test_the_name_of_a_run_holds_what_computes_and_not_what_is_expected() -> None:
    run = Run(solver="x {case} {out}", solver_version="1", material="neo_hookean")
    assert run.digest == replace(run, order=2.0).digest == replace(run, time_limit=5.0).digest
    assert run.digest != replace(run, solver_version="2").digest
    assert run.digest != replace(run, solver="").digest


# ---- programs that fail

PROGRAM = """
import json, pathlib, sys, time
case, out = map(pathlib.Path, sys.argv[1:])
record = json.loads((case / "case.json").read_text())
{body}
"""
PERFECT = """
import importlib.util, numpy as np
spec = importlib.util.spec_from_file_location("exact", case / "body_force.py")
exact = importlib.util.module_from_spec(spec)
spec.loader.exec_module(exact)
table = np.genfromtxt(case / "particles.csv", delimiter=",", names=True)
X = np.stack([table["X"], table["Y"]], axis=1)
error = record["dx"] ** 2
for step in record["frames"]:
    x = X + exact.displacement(X, step * record["dt"]) * (1 + error)
    np.savetxt(out / f"result_{step}.csv", np.column_stack([table["id"], x]), "%.17g", ",",
               header="id,x,y", comments="")
"""
FAILS = {
    "it raises": ("raise SystemExit('the wall is missing')", "exit code 1: the wall is missing"),
    "it dies": ("import os; os.kill(os.getpid(), 11)", "signal 11"),
    "it writes nothing": ("pass", "has not written result_"),
    "it hangs": ("print('step 1', flush=True); time.sleep(99)", "longer than 0.5 s"),
}


def study(verify: Call, tmp_path: Path, body: str, *more: str, order: str = "2") -> tuple[int, dict[str, Any]]:
    """Exit code and JSON of a study of a program."""
    script = tmp_path / "mine.py"
    script.write_text(PROGRAM.format(body=body))
    typed = f"{sys.executable} {script} {{case}} {{out}}"
    words = ["mms", "--solver", typed, "--cells", "8,12,16,24", "--order", order, "--out", "study", "--json", *more]
    code, out, _ = verify(*words)
    return code, json.loads(out)


@pytest.mark.parametrize("name", FAILS)
def test_a_program_that_fails_is_a_result(verify: Call, tmp_path: Path, name: str) -> None:
    body, says = FAILS[name]
    code, told = study(verify, tmp_path, body, "--time-limit", "0.5" if "hangs" in name else "60")
    assert code == 4
    assert told["outcome"] == "ERROR"
    assert says in told["runs"][0]["reason"]


@pytest.mark.slow
def test_a_repaired_program_is_run_again_and_judged(verify: Call, tmp_path: Path) -> None:
    """Errors of dx^2 by construction: order 2 in all digits. What failed before is not taken from the store."""
    code, told = study(verify, tmp_path, "raise SystemExit(3)", "--courant", "0.4,0.2", "--solver-version", "same")
    assert code == 4
    code, told = study(verify, tmp_path, PERFECT, "--courant", "0.4,0.2", "--solver-version", "same")
    assert code == 0, told["verdicts"]
    (verdict,) = (v for v in told["verdicts"] if v["quantity"] == "u")
    assert verdict["observed"] == pytest.approx(2.0, abs=0.03)
    assert verdict["verdict"] == "PASS"


@pytest.mark.slow
def test_nothing_is_judged_without_an_expectation(verify: Call, tmp_path: Path) -> None:
    code, told = study(verify, tmp_path, PERFECT, order="0")
    assert (code, told["verdicts"]) == (3, [])


def test_the_study_has_the_name_of_the_program() -> None:
    typed = f"{sys.executable} {__file__} {{case}} {{out}}"
    made = build(Asked("mms", {"solver": [typed], "solution": ["bump"]}), "verify mms")
    assert {run.method for run in made.runs} == {"test_own_solver"}
    assert [run.cells for run in made.runs if run.courant == 0.4] == [8, 16, 32, 64]
    assert "test_own_solver.py against the manufactured solution bump" in made.title


def test_a_program_is_called_as_its_file_is(tmp_path: Path) -> None:
    """One name in the title, the tables and the sentences: `run.sh`, not `run_sh` and `run sh`."""
    script = tmp_path / "run_mine.sh"
    script.write_text("#!/bin/sh\n")
    script.chmod(0o755)
    made = build(Asked("mms", {"solver": [f"{script} {{case}} {{out}}"], "solution": ["bump"]}), "verify mms")
    assert {run.method for run in made.runs} == {"run_mine.sh"} == {spelt.method(run.method) for run in made.runs}
    assert made.title.startswith("run_mine.sh against")


# ---- the examples, against the digits that eight programs agree on

DIGITS = {
    "clamped_shear:G=1e-6": (7.253e-8, 3.208e-8, 1.787e-8, 7.873e-9, 4.415e-9),
    "bump": (4.139e-8, None, 1.079e-8, None, 2.737e-9),
}
NEEDS = {"python": "", "numpy-class": "", "cpp": "c++", "fortran": "gfortran", "julia": "julia"}


@pytest.mark.slow
@pytest.mark.parametrize("language", NEEDS)
@pytest.mark.parametrize("solution", DIGITS)
def test_the_examples_have_the_digits_of_other_programs(
    verify: Call, tmp_path: Path, language: str, solution: str
) -> None:
    needed = NEEDS[language]
    if needed and shutil.which(needed) is None:
        pytest.skip(f"{needed} is not there")
    code, out, _ = verify("example", language, "toy")
    assert code == 0
    typed = out.partition("--solver '")[2].partition("'")[0]
    words = ["--as", "mpm", "--solution", solution, "--out", "study", "--json"]
    code, out, _ = verify("mms", "--quick", "--solver", typed, *words)
    found = [r["errors"]["u"]["rms"] for r in json.loads(out)["runs"] if r["courant"] == 0.4]
    for error, digits in zip(sorted(found, reverse=True), DIGITS[solution], strict=True):
        assert digits is None or error == pytest.approx(digits, rel=2e-4)
    assert code == 0


def test_the_command_of_an_example_runs_with_a_python_that_has_numpy(
    verify: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where `python` is none, or another one, it is the one that runs verify, by its path."""
    monkeypatch.setenv("PATH", str(tmp_path))
    _, out, _ = verify("example", "python", "toy")
    assert f"--solver '{sys.executable} ./toy/solver.py {{case}} {{out}}'" in out
    (tmp_path / "python").symlink_to(sys.executable)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    _, out, _ = verify("example", "numpy-class", "other")
    assert "--solver 'python ./other/adapter.py {case} {out}'" in out
    (tmp_path / "python").unlink()
    typed = ("--solver", "python mine.py {case} {out}", "--solution", "bump", "--order", "2")
    _, _, err = verify("mms", *typed)
    assert f"there is no program 'python'; give its path, such as {tmp_path / 'python'}" in err


FINEST = {"clamped_shear:G=1e-6": (64, 1.099e-9)}


@pytest.mark.slow
@pytest.mark.parametrize("language", ["python", "cpp"])
def test_the_finest_level_has_the_digits_of_other_programs(verify: Call, tmp_path: Path, language: str) -> None:
    """7.253e-8 to 1.099e-9 over 8 to 64 cells: the last of them; orders 2.02 2.02 2.01 with those above."""
    if (needed := NEEDS[language]) and shutil.which(needed) is None:
        pytest.skip(f"{needed} is not there")
    ((solution, (cells, known)),) = FINEST.items()
    _, out, _ = verify("example", language, "toy")
    typed = out.partition("--solver '")[2].partition("'")[0]
    axes = ["--cells", str(cells), "--courant", "0.4", "--time-step", "h", "--order", "0"]
    _, out, _ = verify("mms", "--solver", typed, "--solution", solution, *axes, "--out", "study", "--json")
    (run,) = [run for run in json.loads(out)["runs"] if run["courant"] == 0.4]
    assert float(f"{run['errors']['u']['rms']:.3e}") == known
    coarser = DIGITS[solution][-1] or 0.0
    assert np.log2(coarser / run["errors"]["u"]["rms"]) == pytest.approx(2.01, abs=0.01)


# ---- hints

STEP = 2e-4  # so long that a step is seen
CASE = export(Names("clamped_shear", "neo_hookean"), SOLUTION, LAW, 4, 4, checked=False)
GIVEN = replace(CASE, record=replace(CASE.record, dt=STEP))


def frames_of(change: Callable[[int], dict[str, Floats]]) -> dict[int, Frame]:
    """Exact frames with some fields changed."""

    def fields(step: int) -> dict[str, Floats]:
        t = step * STEP
        exact = {"x": EXACT.x(X, t), "v": EXACT.v(X, t - STEP / 2), "F": EXACT.F(X, t).reshape(-1, 4)}
        return exact | {"sigma": EXACT.sigma(X, t)} | change(step)

    return {step: Frame(fields(step)) for step in (10, 20, 35)}


ONE, HALVED = np.array([1.0, 0.0, 0.0, 1.0]), -9.0
FAULTS: dict[str, tuple[Callable[[int], dict[str, Floats]], float]] = {
    "still": (lambda step: {"x": X}, 0.0),
    "shift": (lambda step: {"x": EXACT.x(X, (step - 2) * STEP)}, 2.0),
    "x_is_u": (lambda step: {"x": EXACT.u(X, step * STEP)}, 1.0),
    "v_lag": (lambda step: {"v": EXACT.v(X, step * STEP)}, 0.0),
    "F_lag": (lambda step: {"F": EXACT.F(X, (step - 1) * STEP).reshape(-1, 4)}, 1.0),
    "F_transposed": (lambda step: {"F": EXACT.F(X, step * STEP).transpose(0, 2, 1).reshape(-1, 4)}, HALVED),
    "F_twice": (lambda step: {"F": ONE + 2 * (EXACT.F(X, step * STEP).reshape(-1, 4) - ONE)}, HALVED),
    "sigma_sign": (lambda step: {"sigma": -EXACT.sigma(X, step * STEP)}, -1.0),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_hinted_at(name: str) -> None:
    change, value = FAULTS[name]
    found = hints(EXACT, GIVEN, frames_of(change), USUAL)
    assert set(found) == {name}
    assert found[name] < 0.5 if value == HALVED else found[name] == pytest.approx(value, abs=1e-9)
    assert own_solver.hint(name, value)


def test_no_fault_is_hinted_at_where_there_is_none() -> None:
    """Of a right answer, and of one with errors of five per cent that no other reading mends."""
    assert hints(EXACT, GIVEN, frames_of(lambda step: {}), USUAL) == {}
    wrong = frames_of(lambda step: {"x": X + 1.05 * EXACT.u(X, step * STEP)})
    assert hints(EXACT, GIVEN, wrong, USUAL) == {}


# ---- Python functions


def by_the_book(case: Case) -> Any:
    """The exact positions and velocities, with an error of dx^2 in both."""
    u, v = EXACT.u, EXACT.v
    error, found = 1 + case.record.dx**2, {}
    start = case.array("X")
    for step in case.record.frames:
        t = step * case.record.dt
        found[step] = {"x": start + error * u(start, t), "v": error * v(start, t)}
    return found, {"v_lag": 0.0, "version": "1"}


def called(tmp_path: Path, solver: Callable[[Case], Any], **more: Any) -> Any:
    axes = {"solution": "clamped_shear", "cells": [8, 12, 16, 24], "courant": [0.4, 0.2], "order": 2.0, **more}
    return mv.study("mms", solver=solver, ppc=4, out=tmp_path / "study", **axes)


@pytest.mark.slow
def test_a_function_is_a_solver(tmp_path: Path) -> None:
    done = called(tmp_path, by_the_book)
    done.check()
    rows = done.frames()["errors"]
    u, v = (rows[(rows.quantity == q) & (rows.cells == 8)].rms.iloc[0] for q in "uv")
    scale = {result.run.cells: result.scale for result in done.record.results.values()}[8]
    assert (u, v) == pytest.approx((scale["u"] / 64, scale["v"] / 64), rel=1e-9)
    assert set(rows.quantity[rows.rms.notna()]) == {"u", "v"}
    assert done.verdicts[0]["observed"] == pytest.approx(2.0, abs=0.03)


def test_a_failing_assertion_says_the_verdict(tmp_path: Path) -> None:
    done = called(tmp_path, by_the_book, order=3.0)
    with pytest.raises(AssertionError, match=r"(?s)FAIL  by_the_book.*order 2\.0.*below the band"):
        done.check()


def each(case: Case, arrays: dict[str, Any]) -> dict[int, Any]:
    """The same arrays in all frames."""
    return dict.fromkeys(case.record.frames, arrays)


GIVES: dict[str, tuple[Callable[[Case], Any], FailureKind]] = {
    "it raises": (lambda case: 1 / 0, FailureKind.SOLVER_ERROR),
    "nothing": (lambda case: None, FailureKind.UNREADABLE),
    "no frame": (lambda case: {}, FailureKind.NO_ANSWER),
    "no x": (lambda case: each(case, {"v": case.array("v")}), FailureKind.NO_COLUMN),
    "half": (lambda case: each(case, {"x": case.array("x")[::2]}), FailureKind.OTHER_PARTICLES),
    "words": (lambda case: each(case, {"x": "x"}), FailureKind.UNREADABLE),
    "levels": (
        lambda case: (each(case, {"x": case.array("x")}), {"v_lag": "x"}),
        FailureKind.UNREADABLE,
    ),
}


@pytest.mark.parametrize("name", GIVES)
def test_what_a_function_gives_is_held_against_the_contract(tmp_path: Path, name: str) -> None:
    function, kind = GIVES[name]
    done = called(tmp_path, function, cells=[8], courant=[0.4])
    kinds = {result.failure.kind for result in done.record.results.values()}
    assert kinds == {kind}
    assert done.exit_code == 4


def test_a_function_is_known_by_its_file_and_its_code() -> None:
    one, other = (lambda case: 1), (lambda case: 2)
    names = [register(one), register(other)]
    assert names[0] == names[1]  # two of one name are told apart by their code
    assert version(register(one)) != version(register(other))
    with pytest.raises(ValueError, match="is a Python function"):
        version("python:nowhere")


# ---- time levels by force


def leapfrog(case: Case) -> Any:
    """A particle in each point of the body that its own force moves: positions as if all stress were in b.

    It has order 2 in dt with v at -dt/2 and the force of the start of a step, and order 1 with v at 0.
    """
    X, x, v = case.array("X"), case.array("x"), case.array("v", "_half")
    dt, found = case.record.dt, {}
    for step in range(1, case.record.steps + 1):
        v = v + dt * acceleration(X, (step - 1) * dt)
        x = x + dt * v
        if step in case.record.frames:
            found[step] = {"x": x}
    return found


def acceleration(X: Floats, t: float) -> Floats:
    h = 1e-6
    return (EXACT.v(X, t + h) - EXACT.v(X, t - h)) / (2 * h)


@pytest.mark.slow
def test_the_start_that_fits_is_named(tmp_path: Path) -> None:
    """The force of the toy is its own, so b does not matter; v does."""
    starts = ["half.now.start", "half.now.end", "zero.now.start", "zero.before.end"]
    done = called(tmp_path, leapfrog, cells=[8, 16], courant=[0.4], start=starts)
    orders = table.by_start(done.record)
    assert orders["half.now.start"] == orders["half.now.end"] == pytest.approx(2.0, abs=0.05)
    assert orders["zero.now.start"] == pytest.approx(1.0, abs=0.1)
    assert own_solver.starts(orders).startswith("Order 2.0")
    assert "v at −dt/2" in own_solver.starts(orders)
    assert not done.verdicts


# ---- walls


def wrong_at_walls(case: Case) -> Any:
    """Exact positions with an error of first order where there are walls, of second order where there are none."""
    r, X = case.record, case.array("X")
    made = manufacture(create(SOLUTIONS, r.solution), LAW, LAW.rho0)
    held = "fixed" in r.edges.values()
    return {step: {"x": made.x(X, step * r.dt) + (1e-5 * r.dx if held else 1e-4 * r.dx**2)} for step in r.frames}


@pytest.mark.slow
def test_walls_are_told_from_the_interior(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With walls alone the command that tells is printed; with both, what it tells."""
    more: dict[str, Any] = {"cells": [4, 6, 8, 12], "order": 2.0, "courant": [0.4, 0.2]}
    alone = mv.study("mms", solver=wrong_at_walls, solution="clamped_shear:G=1e-6", out=tmp_path / "a", **more)
    assert own_solver.walls(table.by_walls(alone.record)) == ""
    both = mv.study("mms", solver=wrong_at_walls, solution=["clamped_shear:G=1e-6", "bump"], out=tmp_path / "b", **more)
    assert own_solver.walls(table.by_walls(both.record)) == "Order 1.00 with walls, 2.00 without: look at the walls."
    study = replace(
        alone.record.study, command="verify mms --solver './mine {case} {out}' --solution clamped_shear:G=1e-6"
    )
    typed = commands.walls(study, alone.record.findings, tmp_path / "a")
    assert typed.startswith("verify mms --solver './mine {case} {out}' --solution bump --out ")
    free = replace(study, runs=tuple(replace(run, solution="bump") for run in study.runs))
    assert commands.walls(free, alone.record.findings, tmp_path / "a") == ""
    sound = [f for f in both.record.findings if f.plan.run.solution == "bump"]
    assert commands.walls(study, sound, tmp_path / "a") == ""


@pytest.mark.slow
@pytest.mark.parametrize("name", STARTS)
def test_a_start_gives_each_field_one_level(name: str) -> None:
    """Under all names of the field; and the force is that of its end where it is asked for."""
    v, F, b = name.split(".")
    start = named(name)
    case = export(Names("clamped_shear", "neo_hookean"), SOLUTION, LAW, 4, 4, checked=False, start=start)
    plain, dt = export(Names("clamped_shear", "neo_hookean"), SOLUTION, LAW, 4, 4, checked=False), case.record.dt
    for column, values in case.particles.items():
        field, told = column.partition("_")[0], {"half": v == "half", "before": F == "before"}
        kind = next((kind for kind in told if f"{field}_{kind}" in plain.particles), "")
        wanted = f"{field}_{kind}" if kind and told[kind] else field if kind else column
        np.testing.assert_array_equal(values, plain.particles[wanted])
    space: dict[str, Any] = {}
    exec(case.sources["body_force.py"], space)
    at = 0.0 if b == "start" else dt
    np.testing.assert_allclose(space["body_force"](X, 0.003), EXACT.b(X, 0.003 + at), rtol=1e-10, atol=1e-6)
    assert start is not None
    np.testing.assert_array_equal(start.force(EXACT.b, dt)(X, 0.003), EXACT.b(X, 0.003 + at))


def test_a_start_is_for_a_solver_of_ones_own(verify: Call) -> None:
    assert "give --solver too" in one_line(verify("mms", "--quick", "--start", "half.now.start"))


def test_no_start_that_fits_is_said_too() -> None:
    assert own_solver.starts({}) == own_solver.starts({"half.now.start": 2.0}) == ""
    said = own_solver.starts({"half.now.start": 1.02, "zero.now.end": 0.98})
    assert said == "No time levels give order 2: the orders are 0.98 to 1.02."


def test_round_numbers_do_not_make_a_floor(tmp_path: Path) -> None:
    """Positions of a lattice have four digits; velocities beside them show that seventeen are written."""
    for step in STEPS:
        table_ = rows(step)
        table_[:, 3:5] = X
        csv(tmp_path, step, table_)
    frames = {step: read(tmp_path, step, X, 0.125) for step in STEPS}
    assert compare(EXACT, X, LAYOUT.V0, DT, frames, USUAL).floor["u"] < 1e-16


def pulling_is_pushing(case: Case) -> Any:
    """The exact answer but for the sign of the stress."""
    start, found = case.array("X"), {}
    for step in case.record.frames:
        t = step * case.record.dt
        found[step] = {"x": start + EXACT.u(start, t) * (1 + case.record.dx**2), "sigma": -EXACT.sigma(start, t)}
    return found


@pytest.mark.slow
def test_hints_reach_a_ci_job(tmp_path: Path) -> None:
    """In JUnit, in the Markdown summary, and as a value of the run."""
    done = called(tmp_path, pulling_is_pushing)
    write_junit(tmp_path / "out.xml", done.record)
    for text in ((tmp_path / "out.xml").read_text(), markdown(done.record)):
        assert "sigma fits that of F with the other sign" in text
    assert all("sigma_sign" in result.values for result in done.record.results.values())


def test_a_program_that_was_built_anew_is_run_anew(verify: Call, tmp_path: Path) -> None:
    """One without an ending, asked for in the same words in the same folder: the old study is not taken for it."""
    program = tmp_path / "mine"
    words = [
        "mms",
        "--solver",
        f"{program} {{case}} {{out}}",
        "--cells",
        "4",
        "--order",
        "2",
        "--out",
        "study",
        "--json",
    ]
    said = []
    for text in ("first", "second"):
        program.write_text(f"#!/bin/sh\necho {text}\nexit 1\n")
        program.chmod(0o755)
        code, out, _ = verify(*words, "--json")
        assert code == 4
        said.append({run["solver_version"] for run in json.loads(out)["runs"]})
    assert len(said[0]) == len(said[1]) == 1
    assert said[0] != said[1]
