"""The command as its users meet it: what is wrong is one line that says what is allowed, and nothing stored is lost."""

import os
import pty
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import fixtures_study as fixtures
import pytest
from typer.main import get_command

from mpm_verify.cases.harness.shipped import shipped
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.mms import execute as mms
from mpm_verify.cases.mms import expectations
from mpm_verify.cases.mms.run import NORMS, QUANTITIES, Result
from mpm_verify.solver.plugins import available
from mpm_verify.verify.main import application, main

METHODS, SOLUTIONS, MATERIALS = (
    available(p) for p in ("mpm_verify.solver.basis", "mpm_verify.mms.solutions", "mpm_verify.solver.material")
)
VERIFY = [sys.executable, "-m", "mpm_verify"]
BELOW_A_FILE = "file/below"  # cannot be made even by root, whom no permission stops


@dataclass(frozen=True)
class Spoken:
    code: int
    out: str
    err: str

    @property
    def line(self) -> str:
        """The one line of a complaint."""
        assert (self.code, self.out) == (2, "")
        assert self.err.startswith("verify: ")
        assert self.err.count("\n") == 1
        assert "Traceback" not in self.err
        return self.err


Verify = Callable[..., Spoken]


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Verify:
    """Call the command in this process, in an empty folder that holds `file`."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")

    def call(*arguments: str) -> Spoken:
        monkeypatch.setattr(sys, "argv", ["verify", *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        out, err = capsys.readouterr()
        return Spoken(int(ended.value.code or 0), out, err)

    return call


@pytest.fixture
def quickly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Known results in place of the solver, and no page."""
    monkeypatch.setattr(mms, "execute", lambda run, tick: (fixtures._result(run), {}))
    monkeypatch.setattr(expectations, "recorded", lambda *key: ())  # those of the fixtures are made of those of u
    monkeypatch.setattr("mpm_verify.verify.run.page_of", lambda record, vtk=False: record.store.folder / "report.html")
    monkeypatch.setattr("mpm_verify.verify.run.SMALL", float("inf"))  # worker processes would run the solver


def content(folder: Path) -> dict[str, bytes]:
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


# ---- bad input


NUMBERS = "whole numbers"
BAD = {
    "unknown method": (["--method", "nope"], ["'nope'", *METHODS]),
    "unknown second method": (["--method", "cpdi", "--method", "CPDI"], ["'CPDI'", *METHODS]),
    "unknown method in a list": (["--method", "cpdi,nope"], ["'nope'", *METHODS]),
    "a path as method": (["--method", "../basis/cpdi"], METHODS),
    "unknown solution": (["--solution", "nope"], ["'nope'", *SOLUTIONS]),
    "unknown material": (["--material", "nope"], ["'nope'", *MATERIALS]),
    "unknown parameter of a solution": (["--solution", "axis_aligned:Q=1"], ["'Q'", "A", "L", "C", "phase"]),
    "unknown parameter of a material": (["--material", "neo_hookean:K=1"], ["'K'", "E", "nu", "rho0"]),
    "parameter that is no number": (["--solution", "axis_aligned:A=abc"], ["A='abc'", "not a number"]),
    "parameter without a value": (["--solution", "axis_aligned:A"], ["A=''", "not a number"]),
    "amplitude too large": (["--solution", "axis_aligned:A=0.2"], ["A = 0.2", "below 0.1592"]),
    "amplitude that is no number": (["--solution", "axis_aligned:A=nan"], ["A=nan", "finite number"]),
    "side of zero": (["--solution", "axis_aligned:L=0"], ["above zero"]),
    "nu too large": (["--material", "neo_hookean:nu=0.5"], ["between -1 and 0.5"]),
    "ppc no square": (["--ppc", "4,3"], ["3", "square", "1, 4, 9"]),
    "ppc 0": (["--ppc", "0"], ["0", "square", "1, 4, 9"]),
    "ppc negative": (["--ppc", "-4"], ["-4", "square", "1, 4, 9"]),
    "ppc no number": (["--ppc", "four"], ["--ppc 'four'", NUMBERS]),
    "cells 0": (["--cells", "0"], ["cells = 0", NUMBERS, "from 2 to"]),
    "cells 1": (["--cells", "8,1"], ["cells = 1", NUMBERS, "from 2 to"]),
    "cells negative": (["--cells", "-8"], ["cells = -8", NUMBERS, "from 2 to"]),
    "cells huge": (["--cells", "99999999999999999999"], [NUMBERS, "from 2 to"]),
    "cells no numbers": (["--cells", "8,many"], ["--cells '8,many'", NUMBERS]),
    "cells no whole numbers": (["--cells", "8.5"], ["--cells '8.5'", NUMBERS]),
    "cells empty": (["--cells", ""], ["--cells is empty", "leave it out"]),
    "cells with a comma too many": (["--cells", "8,16,"], ["--cells '8,16,'", NUMBERS]),
    "courant 0": (["--courant", "0"], ["courant", "0.001 to 10", "0.4"]),
    "courant negative": (["--courant", "-0.4"], ["courant", "0.001 to 10", "0.4"]),
    "courant nan": (["--courant", "nan"], ["courant", "0.001 to 10", "0.4"]),
    "courant infinite": (["--courant", "inf"], ["courant", "0.001 to 10"]),
    "second courant 0": (["--courant", "0.4,0"], ["courant = 0.0", "0.001 to 10"]),
    "second courant above the first": (["--courant", "0.4,0.8"], ["courant = 0.8", "above the first", "0.4,0.2,0.1"]),
    "courant empty": (["--courant", ""], ["--courant is empty", "leave it out"]),
    "courant with a comma too many": (["--courant", "0.4,"], ["--courant '0.4,'", "0.4,0.2,0.1"]),
    "replicates 0": (["--replicates", "0"], ["replicates = 0", NUMBERS, "from 1 to 64"]),
    "replicates 65": (["--replicates", "65"], ["replicates = 65", NUMBERS, "from 1 to 64"]),
    "replicates no number": (["--replicates", "some"], ["--replicates", "whole number"]),
    "courant no number": (["--courant", "fast"], ["--courant", "number"]),
    "unknown transfer": (["--transfer", "nope"], ["'nope'", "apic, flip, fmpm, pic"]),
    "fraction of flip 2": (["--transfer", "flip:fraction=2"], ["fraction = 2", "above 0", "up to 1"]),
    "fraction of flip 0": (["--transfer", "flip:fraction=0"], ["fraction = 0", "pic"]),
    "fraction of flip nan": (["--transfer", "flip:fraction=nan"], ["fraction=nan", "finite number"]),
    "order of fmpm 0": (["--transfer", "fmpm:order=0"], ["order = 0", "whole number from 1"]),
    "order of fmpm 2.5": (["--transfer", "fmpm:order=2.5"], ["order = 2.5", "whole number from 1"]),
    "unknown parameter of a transfer": (["--transfer", "flip:share=0.9"], ["'share'", "fraction"]),
    "unknown stress order": (["--stress", "first"], ["'first'", "usl, musl, usf"]),
    "jobs 0": (["--jobs", "0"], ["--jobs", NUMBERS, "from 1"]),
    "jobs negative": (["--jobs", "-1"], ["--jobs", NUMBERS, "from 1"]),
    "jobs no number": (["--jobs", "all"], ["--jobs", "whole number"]),
    "threads 0": (["--threads", "0"], ["--threads", NUMBERS, "from 1"]),
    "unknown option": (["--colour"], ["--colour"]),
    "option without its value": (["--cells"], ["--cells"]),
    "stray word": (["cpdi"], ["cpdi"]),
}


@pytest.fixture
def stored(tmp_path: Path) -> Path:
    """A study folder with Results, which no bad input may touch."""
    return fixtures.make(tmp_path / "stored", ("cpdi",), largest=8)


def test_a_study_under_way_keeps_its_folder(verify: Verify, stored: Path) -> None:
    """Whoever comes second is refused before it writes anything, its own study.json included."""
    with Store(stored).locked():
        before = content(stored)
        assert "another verify works in" in verify("mms", "--cells", "8,16", "--out", str(stored)).line
        assert content(stored) == before


@pytest.mark.parametrize("name", BAD)
def test_bad_input(verify: Verify, stored: Path, name: str) -> None:
    arguments, said = BAD[name]
    before = content(stored)
    line = verify("mms", "--out", str(stored), *arguments).line
    assert all(word in line for word in said), line
    assert content(stored) == before
    assert sorted(path.name for path in stored.parent.iterdir()) == ["file", "stored"]


@pytest.mark.parametrize(
    "arguments",
    [
        ["--solution", "axis_aligned:boundary=1"],
        ["--solution", "axis_aligned:C=inf"],
        ["--solution", "axis_aligned:phase=nan"],
        ["--solution", "axis_aligned:L=inf"],
        ["--material", "neo_hookean:E=inf"],
    ],
    ids=" ".join,
)
def test_bad_parameters(verify: Verify, stored: Path, quickly: None, arguments: list[str]) -> None:
    before = content(stored)
    assert verify("mms", "--out", str(stored), *arguments).line
    assert content(stored) == before


@pytest.mark.parametrize("out", [BELOW_A_FILE, "file", "/proc/study"])
def test_unwritable_out(verify: Verify, out: str) -> None:
    line = verify("mms", "--quick", "--out", out).line
    assert f"cannot make the study folder {out}" in line
    assert "--out" in line


@pytest.mark.parametrize("junit", [f"{BELOW_A_FILE}.xml", "/proc/out.xml", "."])
def test_unwritable_junit(verify: Verify, quickly: None, junit: str, tmp_path: Path) -> None:
    assert verify("mms", "--cells", "8,16", "--ppc", "4", "--out", "study", "--junit", junit).line
    assert len(list((tmp_path / "study" / "runs").glob("*.json"))) in (0, 3)  # before the first run, or kept


def test_unwritable_junit_is_named(verify: Verify, quickly: None) -> None:
    line = verify("mms", "--cells", "8", "--ppc", "4", "--out", "study", "--junit", f"{BELOW_A_FILE}.xml").line
    assert "--junit" in line
    assert f"{BELOW_A_FILE}.xml" in line


def test_unknown_subcommand(verify: Verify) -> None:
    assert "'nope'" in verify("nope").line


def test_unknown_subcommand_says_which_there_are(verify: Verify) -> None:
    line = verify("nope").line
    assert all(name in line for name in ("mms", "list", "report"))


def test_report_of_what(verify: Verify) -> None:
    assert "DIR" in verify("report").line


@pytest.mark.parametrize("arguments", [["report", "study"], ["mms", "--cells", "8", "--ppc", "4", "--out", "study"]])
@pytest.mark.parametrize(("text", "said"), [('{"for', "is broken"), ('{"format": 7}', "this version reads 2")])
def test_broken_study(verify: Verify, tmp_path: Path, arguments: list[str], text: str, said: str) -> None:
    """Neither command writes over a study.json that it cannot read."""
    fixtures.make(tmp_path / "study", ("cpdi",), largest=8)
    (tmp_path / "study" / "study.json").write_text(text)
    before = content(tmp_path)
    line = verify(*arguments).line
    assert said in line
    assert "study/study.json" in line
    assert content(tmp_path) == {**before, "file": b""}


@pytest.mark.parametrize("folder", ["nowhere", ".", "file"])
def test_report_of_no_study_folder(verify: Verify, folder: str, tmp_path: Path) -> None:
    verify("report", folder).line  # noqa: B018 - the property holds the assertions
    assert content(tmp_path) == {"file": b""}


@pytest.mark.parametrize(("text", "said"), [('{"for', "is broken"), ('{"format": 7}', "this version reads 2")])
def test_report_of_a_broken_result(verify: Verify, stored: Path, text: str, said: str) -> None:
    broken = sorted((stored / "runs").glob("*.json"))[3]
    broken.write_text(text)
    before = content(stored)
    with fixtures.sources():
        line = verify("report", str(stored)).line
    assert said in line
    assert str(broken) in line
    assert content(stored) == before


def test_report_with_missing_arrays(verify: Verify, tmp_path: Path) -> None:
    """They cost figures alone: verdicts and tables stand in the Results."""
    stored = fixtures.make(tmp_path / "stored", ("cpdi",), largest=16)
    with fixtures.sources():
        assert verify("report", str(stored)).code == 0
    whole = {file.name for file in (stored / "figures").iterdir()}
    before = (stored / "tables" / "verdicts.csv").read_bytes()
    for file in (stored / "runs").glob("*.npz"):
        file.unlink()
    results = content(stored / "runs")
    with fixtures.sources():
        assert verify("report", str(stored)).code == 0
    assert content(stored / "runs") == results
    assert (stored / "tables" / "verdicts.csv").read_bytes() == before
    left = {file.name for file in (stored / "figures").iterdir()}
    assert whole - left == {f"error_field_cpdi.{kind}" for kind in ("svg", "pdf", "png")}


def test_not_enough_memory(verify: Verify, quickly: None, monkeypatch: pytest.MonkeyPatch) -> None:
    def execute(run: object, tick: object) -> None:
        raise MemoryError

    monkeypatch.setattr(mms, "execute", execute)
    assert "memory" in verify("mms", "--cells", "8", "--ppc", "4", "--jobs", "1", "--out", "study").line


# ---- what is said where all is well


def test_version(verify: Verify) -> None:
    assert verify("--version") == Spoken(0, f"verify {version('mpm-verify')}\n", "")


def test_list_names_every_plugin(verify: Verify) -> None:
    said = verify("list")
    assert (said.code, said.err) == (0, "")
    listed = {line.split()[0] for line in said.out.splitlines() if line.startswith("  ")}
    others = (
        "mpm_verify.cases",
        "mpm_verify.solver.transfers",
        "mpm_verify.solver.smoothing",
        "mpm_verify.mms.layouts",
        "mpm_verify.cases.benchmark.problems",
        "mpm_verify.solver.rates",
        "mpm_verify.solver.negative_controls",
    )
    plugins = {name for package in others for name in available(package)}
    assert listed == {*METHODS, *SOLUTIONS, *MATERIALS, *plugins, *shipped()}
    assert all(len(line.split()) > 2 for line in said.out.splitlines() if line.startswith("  "))  # and says what it is


@pytest.mark.parametrize("arguments", [["--help"], ["mms", "--help"], ["list", "--help"], ["report", "--help"]])
def test_help(verify: Verify, arguments: list[str]) -> None:
    said = verify(*arguments)
    assert (said.code, said.err) == (0, "")
    assert "Usage" in said.out


def test_help_of_mms_lists_the_choices(verify: Verify) -> None:
    words = verify("mms", "--help").out.replace(",", " ").replace(";", " ").split()
    assert {*METHODS, *SOLUTIONS, *MATERIALS} <= set(words)


def test_table(verify: Verify, quickly: None) -> None:
    said = verify("mms", "--method", "cpdi", "--method", "mpm", "--ppc", "4", "--out", "study")
    assert (said.code, said.err) == (0, "")
    rows = [line.split() for line in said.out.splitlines()]
    assert ["cpdi", "4", "u", "rms", "8", "3.043e-03", "2.0"] in rows  # the last is of crossings, per particle
    assert ["16", "7.122e-04", "2.10", "4.0"] in rows
    assert ["mpm", "4", "u", "rms", "8", "4.814e-03", "2.0"] in rows
    assert ["16", "6.724e-03", "-0.48", "4.0"] in rows
    assert any(row[:2] == ["128", "-"] and "det" in row for row in rows)  # the failed run by its reason
    text = " ".join(said.out.split())
    assert "PASS cpdi, 4 per cell, u in rms, order 2 expected: " in text
    assert "diverges, as registered mpm, 4 per cell, u in rms: does not converge, as expected" in text
    assert "STALL mpm, 4 per cell, u in rms: from 32 to 64 cells the order is −0.85; −0.48, −1.09 before" in text
    assert "STALL cpdi" not in text
    assert said.out.splitlines()[-1] == f"report: {Path('study/report.html')}"
    assert "\x1b" not in said.out  # no colours where there is no terminal


def test_nothing_judged_is_said(verify: Verify, quickly: None) -> None:
    said = verify("mms", "--ppc", "1", "--out", "study")
    assert said.code == 3
    assert "INCONCLUSIVE: nothing here has a registered expectation" in said.out


@pytest.mark.parametrize(
    ("error", "code"),
    [(None, 0), (lambda run: 0.02 / run.cells, 1), (lambda run: 1e-13, 3)],
    ids=["pass", "fail", "floor"],
)
def test_exit_code_is_the_verdict(
    verify: Verify, quickly: None, monkeypatch: pytest.MonkeyPatch, error: Callable[..., float] | None, code: int
) -> None:
    def execute(run: Any, tick: object) -> tuple[Result, dict[str, Any]]:
        result = fixtures._result(run)
        if error is None:
            return result, {}
        return replace(result, errors={q: dict.fromkeys(NORMS, error(run)) for q in QUANTITIES}), {}

    monkeypatch.setattr(mms, "execute", execute)
    assert verify("mms", "--out", "study").code == code


def test_error_of_zero(verify: Verify) -> None:
    """A solution at rest is met exactly."""
    assert verify("mms", "--cells", "8,16", "--ppc", "4", "--solution", "axis_aligned:A=0", "--out", "study").code == 3


def test_default_folder_is_named_after_what_is_swept(verify: Verify, quickly: None, tmp_path: Path) -> None:
    verify("mms", "--method", "mpm", "--method", "cpdi", "--method", "mpm", "--cells", "8")
    assert [path.name for path in (tmp_path / "results").iterdir()] == ["mms-mpm-cpdi-cells-8"]


def test_command_in_the_study_repeats_it(verify: Verify, quickly: None, tmp_path: Path) -> None:
    from mpm_verify.cases.harness.store import Store

    where = ["--out", "study", "--jobs", "1", "--threads=1", "--junit=out.xml", "--json"]
    verify("mms", "--cells", "8,16", *where, "--solution", "axis_aligned:A=0.01")
    assert Store(tmp_path / "study").study().command == "verify mms --cells 8,16 --solution axis_aligned:A=0.01"


# ---- nothing heavy where nothing is computed


HEAVY = ("numba", "sympy", "scipy", "matplotlib", "pandas", "numpy")
LOOK = f"""
import sys
from mpm_verify.verify.main import main
sys.argv[0] = "verify"
try:
    main()
finally:
    print(*[name for name in {HEAVY!r} if name in sys.modules], file=sys.stderr)
"""


def light(*arguments: str, **environment: str) -> str:
    """Standard output of the command, if it has imported nothing heavy: its start has to feel immediate."""
    command = [sys.executable, "-c", LOOK, *arguments]
    run = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **environment}, timeout=60)
    assert run.stderr == "\n"
    return run.stdout


@pytest.mark.parametrize("arguments", [["--help"], ["mms", "--help"], ["--version"], ["list"]], ids=" ".join)
def test_starts_light(arguments: list[str]) -> None:
    assert light(*arguments)


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("verify mms --method ", METHODS),
        ("verify mms --solution ", SOLUTIONS),
        ("verify mms --material ", MATERIALS),
        ("verify mms --solution cl", ["clamped_shear"]),
        ("verify mms --method nope", []),
        ("verify ", [str(command.name) for command in application().registered_commands]),
    ],
)
def test_completion(line: str, offered: list[str]) -> None:
    """As the script of bash asks for it."""
    words = line.split(" ")
    said = light(_VERIFY_COMPLETE="complete_bash", COMP_WORDS=line, COMP_CWORD=str(len(words) - 1))
    assert said.split() == offered


# ---- terminals and signals


def test_progress_bar_on_a_terminal_only(tmp_path: Path) -> None:
    """Standard error is a terminal here, standard output is not; the other way round is tested with --json."""
    terminal, end = pty.openpty()
    command = [*VERIFY, "mms", "--cells", "8,16", "--ppc", "4", "--jobs", "1", "--out", "study"]
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "120"}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=end, text=True, cwd=tmp_path, env=environment)
    os.close(end)
    shown = b""
    try:
        while part := os.read(terminal, 4096):
            shown += part
    except OSError:  # how Linux tells that the other end is closed
        pass
    os.close(terminal)
    out = process.communicate(timeout=60)[0]
    assert process.returncode == 3
    assert b"%" in shown
    assert b"3 runs" in shown
    assert "report: study/report.html" in out
    assert "\x1b" not in out


def test_interrupt_of_a_process(tmp_path: Path) -> None:
    """Ctrl-C in the middle of a run of some seconds, in this process alone."""
    command = [*VERIFY, "mms", "--cells", "8,128", "--ppc", "9", "--jobs", "1", "--out", "study"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path)
    deadline = time.monotonic() + 60
    while not (tmp_path / "study" / "study.json").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (130, "")
    assert "Traceback" not in err
    assert not [path.name for path in (tmp_path / "study" / "runs").iterdir()]  # the longest run is the first


def test_interrupt_is_one_line(verify: Verify, quickly: None, monkeypatch: pytest.MonkeyPatch) -> None:
    def execute(run: object, tick: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(mms, "execute", execute)
    said = verify("mms", "--cells", "8", "--ppc", "4", "--out", "study")
    assert (said.code, said.out, said.err.count("\n")) == (130, "", 1)
    assert "the same command goes on from there" in said.err


def test_nobody_listens() -> None:
    """As in `verify list | head -0`: no complaint, and no exit code that says FAIL."""
    reader, writer = os.pipe()
    os.close(reader)
    run = subprocess.run([*VERIFY, "list"], stdout=writer, stderr=subprocess.PIPE, text=True, timeout=60)
    os.close(writer)
    assert (run.returncode, run.stderr) == (0, "")


# ---- numbers that are none


def numeric() -> list[tuple[str, str]]:
    """Command and option of all options that take one number."""
    commands = get_command(application()).commands  # type: ignore[attr-defined]
    return [
        (name, max(option.opts, key=len))
        for name, command in commands.items()
        for option in command.params
        if getattr(option, "type_descriptor", None) and option.type_descriptor.annotation in (int, float)
    ]


def test_a_number_that_cannot_be_read_is_told_plainly(verify: Verify) -> None:
    """Every option that the parser itself reads is told in our words, not in those of the library."""
    found = numeric()
    assert {("judge", "--order"), ("export", "--cells"), ("mms", "--threads"), ("power", "--seed")} <= set(found)
    for command, option in found:
        line = verify(command, option, "abc").line
        assert f"{option} 'abc' cannot be read; write a " in line
        assert "number, such as " in line
        assert "Input should" not in line


def test_what_the_parser_refuses_names_the_help(verify: Verify) -> None:
    assert verify("mms", "maybe").line.endswith("(maybe); verify mms --help says more\n")
    assert verify("example").line == "verify: Missing argument 'LANGUAGE'; verify example --help says more\n"
