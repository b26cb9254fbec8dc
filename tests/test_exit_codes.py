"""Exit codes: one table for all commands, whoever reads what they print, and whatever a user's file does."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from fixtures_command import TOP, Call, asked, caller, commands, one_line, process, study_commands

from mpm_verify.cases.harness.analysis import Analysis
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.runner import RunnerError, process_pool, run_study
from mpm_verify.cases.harness.store import Store
from mpm_verify.reports import frames
from mpm_verify.verify import run as conducted
from mpm_verify.verify.main import files

STUDIES = study_commands()


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def content(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


# ---- one table

CHECKS = {"pass": 0.0, "fail": 1.0, "error": float("nan")}
OUTCOMES = {"pass": 0, "fail": 1, "error": 4, "nothing": 3}


def test_every_study_is_here() -> None:
    assert {"mms", "methods", "graded", "column", "sweep", "material", "objectivity"} <= set(STUDIES)


@pytest.mark.parametrize(("outcome", "code"), OUTCOMES.items())
@pytest.mark.parametrize("name", STUDIES)
def test_a_study_ends_with_its_verdict(
    verify: Call, monkeypatch: pytest.MonkeyPatch, name: str, outcome: str, code: int
) -> None:
    """The whole way from a command to an exit code; the runs and what is found in them are made up."""
    checks = (Check("group", "a number", CHECKS[outcome], 0.0, "absolute", "source"),) if outcome in CHECKS else ()
    monkeypatch.setattr(conducted, "compute", lambda *given: {})
    monkeypatch.setattr(conducted, "more_of", lambda record: {})
    monkeypatch.setattr(frames, "analyse", lambda study, results, store: Analysis((), checks))
    found, out, err = verify(*asked(name), "--json", "--yes", "--out", "study")
    assert (found, err) == (code, "")
    assert f'"exit_code": {code},' in out


@pytest.mark.parametrize("name", STUDIES)
def test_a_defect_is_4_with_its_traceback(verify: Call, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    def broken(*arguments: Any) -> None:
        raise RuntimeError("a wrong index")

    monkeypatch.setattr(conducted, "conduct", broken)
    code, out, err = verify(*asked(name))
    assert (code, out) == (4, "")
    assert "RuntimeError: a wrong index" in err
    assert err.splitlines()[-1].startswith("verify: this is a defect of verify")


@pytest.mark.parametrize("name", commands())
def test_usage_is_2_and_one_line(verify: Call, tmp_path: Path, name: str) -> None:
    assert "--nonsense" in one_line(verify(*asked(name), "--nonsense"))
    assert content(tmp_path) == []


@pytest.mark.parametrize("name", [name for name in commands() if name not in (*STUDIES, "power", "paper")])
def test_what_runs_nothing_is_0_or_2(verify: Call, tmp_path: Path, name: str) -> None:
    """Folders that hold no study are input, and so is a solver that is not there."""
    said = verify(*asked(name))
    if name in ("report", "diff", "check-force", "compare", "index"):
        assert "study" in one_line(said)
    else:
        assert said[0] == 0
        assert said[1]
        assert said[2] == ""
    assert [path for path in content(tmp_path) if path.partition("/")[0] != "case"] == []


@pytest.mark.parametrize("arguments", [["-h"], ["--help"], ["--version"], *([name, "-h"] for name in files())])
def test_help_is_0(verify: Call, arguments: list[str]) -> None:
    code, out, err = verify(*arguments)
    assert (code, err) == (0, "")
    assert "Usage" in out or arguments == ["--version"]
    assert arguments[0].startswith("-") or f"verify {arguments[0]}" in out


def test_no_command_is_2(verify: Call) -> None:
    assert verify()[0] == 2


# ---- nobody reads, or the disk is full


def ended(arguments: list[str], out: str, err: str = "") -> tuple[int, str]:
    """Exit code and standard error with the redirections of a shell."""
    redirected = f'exec "$@" {out} {err}'
    command = ["bash", "-c", redirected, "bash", sys.executable, "-m", "mpm_verify", *arguments]
    done = subprocess.run(command, stderr=subprocess.PIPE, text=True, cwd=TOP, timeout=120,
                          env={**os.environ, "PYTHONPATH": str(TOP)})  # fmt: skip
    return done.returncode, done.stderr


PRINTING = [["list"], ["--help"], ["--version"], ["mms", "-h"], ["expectations"], ["schema"]]


@pytest.mark.parametrize("arguments", PRINTING, ids=" ".join)
def test_standard_output_is_closed(arguments: list[str]) -> None:
    assert ended(arguments, ">&-") == (0, "")


@pytest.mark.parametrize("arguments", PRINTING, ids=" ".join)
def test_standard_output_is_full(arguments: list[str]) -> None:
    code, err = ended(arguments, ">/dev/full")
    assert (code, err) == (2, "verify: cannot write to standard output: No space left on device\n")


@pytest.mark.parametrize("arguments", PRINTING, ids=" ".join)
def test_the_reader_has_gone(arguments: list[str]) -> None:
    """As `verify list | head -1`, where head is the faster one."""
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run([sys.executable, "-m", "mpm_verify", *arguments], stdout=writer, stderr=subprocess.PIPE,
                          text=True, cwd=TOP, timeout=120)  # fmt: skip
    os.close(writer)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("out", "err", "arguments", "code"),
    [
        ("", "2>&-", ["list"], 0),
        ("", "2>&-", ["nope"], 2),
        ("", "2>/dev/full", ["nope"], 2),
        (">&-", "2>&-", ["mms", "--cells", "x"], 2),
        (">/dev/full", "2>/dev/full", ["list"], 2),
    ],
)
def test_standard_error_is_closed(out: str, err: str, arguments: list[str], code: int, tmp_path: Path) -> None:
    """A complaint that nobody can read goes nowhere, and not to standard output."""
    file = tmp_path / "out"
    assert ended(arguments, out or f">{file}", err) == (code, "")
    assert not out or not file.exists()
    assert code == 0 or not file.exists() or file.read_text() == ""


@pytest.mark.slow
@pytest.mark.parametrize("redirected", [">&-", ">/dev/full", "2>&-"])
def test_a_study_whose_end_nobody_reads(tmp_path: Path, redirected: str) -> None:
    """The study is stored; what cannot be printed is no verdict."""
    words = ["material", "linear_elastic", "--test", "isotropic", "--steps", "1", "--no-page", "--out", str(tmp_path)]
    code, err = ended(words, redirected, ">/dev/null" if redirected == "2>&-" else "")
    assert code == (2 if "full" in redirected else 0)
    assert err == ("verify: cannot write to standard output: No space left on device\n" if code else "")
    assert len(list((tmp_path / "runs").glob("*.json"))) == 2


# ---- a user's file that ends the program

SOLUTION = """
import os, sys
import sympy as sp
{imported}
def displacement(X, t):
    {called}
    x, y = X
    return sp.Matrix([1, 1]) * 0.02 * sp.sin(sp.pi * x) * sp.sin(sp.pi * y) * sp.sin(100 * sp.pi * t)
def domain():
    return {{"lower": (0, 0), "upper": (1, 1), "duration": 0.01, "speed": 100}}
"""
ENDS = ["os._exit(0)", "sys.exit(0)", "raise SystemExit", "from os import _exit; _exit(0)"]


def own(folder: Path, imported: str = "", called: str = "pass") -> str:
    path = folder / "own.py"
    path.write_text(SOLUTION.format(imported=imported, called=called))
    return str(path)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("where", "line"), [("imported", 4), ("called", 6)], ids=["when it is imported", "in displacement()"]
)
@pytest.mark.parametrize("end", ENDS)
def test_a_file_cannot_end_a_study(tmp_path: Path, where: str, line: int, end: str) -> None:
    path = own(tmp_path, **{where: end})
    said = process("mms", "--solution", path, "--cells", "8", "--ppc", "1", "--out", "study", folder=tmp_path)
    assert (said.code, said.out) == (2, ""), said
    assert said.err.startswith(f"verify: {path}, line {line}: SystemExit")
    assert said.err.count("\n") == 1
    assert content(tmp_path) == ["own.py"]


MATERIAL = '''
import os, sys
from dataclasses import dataclass
from mpm_verify.solver.material.linear_elastic import LinearElastic
@dataclass(frozen=True)
class Own(LinearElastic):
    """One that ends in its first steps, not when it is tried."""
    def update(self, particles, dt):
        if len(particles) > 10: {end}
'''


@pytest.mark.parametrize("end", ENDS[:2])
def test_a_file_cannot_end_a_run(tmp_path: Path, end: str) -> None:
    """End in the midst of a time step, in this process."""
    path = tmp_path / "own.py"
    path.write_text(MATERIAL.format(end=end))
    words = ("mms", "--material", str(path), "--cells", "8", "--ppc", "1", "--jobs", "1", "--out", "study")
    said = process(*words, folder=tmp_path)
    assert (said.code, said.out) == (2, ""), said
    assert said.err.startswith(f"verify: {path}, line 9: SystemExit: 0")
    assert said.err.count("\n") == 1
    assert not list((tmp_path / "study" / "runs").glob("*.json"))


@pytest.mark.parametrize("end", ENDS[:2])
def test_a_file_cannot_end_a_worker(tmp_path: Path, end: str) -> None:
    """Nor a study with it: the worker's failure is told."""
    elsewhere = f"os.getpid() != {os.getpid()} and {end}"
    asked = Asked("mms", {"solution": [own(tmp_path, elsewhere)], "cells": [8], "ppc": [1]})
    study = build(asked, "verify mms", "mms")
    store = Store(tmp_path / "study")
    store.create(study)
    with pytest.raises(RunnerError, match=r"^what computes cpdi 8² cells") as told, process_pool(1, "mms") as (pool, _):
        run_study(study, store, pool, 1)
    assert not told.value.defect
    assert not list(store.runs.iterdir())


# ---- what a study would take


@pytest.fixture
def idle(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing may run."""

    def compute(*arguments: Any) -> None:
        raise AssertionError("a run was begun")

    monkeypatch.setattr(conducted, "compute", compute)


@pytest.mark.parametrize("name", STUDIES)
def test_dry_run(verify: Call, idle: None, tmp_path: Path, name: str) -> None:
    """A line a run and a sum; nothing is written, and no folder is made, for JUnit either."""
    more = ["--junit", "below/out.xml"] if "--junit" in commands()[name] else []
    code, out, err = verify(*asked(name), "--dry-run", *more)
    assert (code, err) == (0, "")
    *runs, last = out.splitlines()
    assert all(line.startswith("to do   ") for line in runs)
    assert len({line.split()[2] for line in runs}) == len(runs) > 0
    assert len({line.split(maxsplit=3)[3] for line in runs}) == len(runs)  # each says what it is
    assert f": {len(runs)} run{'s' * (len(runs) > 1)} to be done, 0 stored, " in last
    assert "up to 1 particle" not in last  # of what has none, or is not known
    assert content(tmp_path) == []


LONG = ",".join(str(cells) for cells in range(2, 302))
SQUARES = ",".join(str(side**2) for side in range(1, 301))
HUNDRED = ",".join(f"flip:fraction={k / 100}" for k in range(1, 101))
TOML = f"""
case = "column"
[sweep]
damping = {[k / 300 for k in range(300)]}
g = {[float(k) for k in range(1, 301)]}
duration = {[k / 100 for k in range(1, 101)]}
"""
MILLIONS = ["9,000,000 runs are asked for", "10,000 is the most"]
TOO_MUCH = {
    "particles": (["mms", "--ppc", "10000000000"], ["163,840,000,000,000 particles", "GB", "this machine has"]),
    "cells": (["mms", "--cells", "4096"], ["150,994,944 particles", "this machine has", "take fewer cells"]),
    "a column": (["column", "--cells", "1000"], ["63,000,000 particles", "this machine has"]),
    "runs": (["mms", "--cells", LONG, "--ppc", SQUARES, "--transfer", HUNDRED], MILLIONS),
    "runs of a file": (["sweep", "many.toml"], MILLIONS),
    "replicates": (["mms", "--replicates", "1000000000"], ["runs are asked for"]),
    "hours": (["mms", "--cells", "2048", "--ppc", "1"], ["4 hours", "--yes", "--dry-run"]),
}


@pytest.mark.parametrize("name", TOO_MUCH)
def test_too_much_is_refused_at_once(verify: Call, idle: None, tmp_path: Path, name: str) -> None:
    """One line, in less than two seconds of this processor, before anything is made."""
    arguments, said = TOO_MUCH[name]
    (tmp_path / "many.toml").write_text(TOML)
    before = os.times()
    line = one_line(verify(*arguments))
    after = os.times()
    assert all(word in line for word in said), line
    assert after.user + after.system - before.user - before.system < 2
    assert content(tmp_path) == ["many.toml"]


def test_hours_are_run_where_they_are_wanted(verify: Call, idle: None) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(conducted, "compute", lambda *_: (_ for _ in ()).throw(ValueError("begun")))
        assert "begun" in one_line(verify("mms", "--cells", "2048", "--ppc", "1", "--yes"))
