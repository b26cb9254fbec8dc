"""Logs of somebody else's solver that fails: kept, and their last lines on the terminal, the page and in exports."""

import json
import sys
from io import StringIO
from pathlib import Path
from xml.etree import ElementTree

import pytest
from fixtures_command import Call, caller
from rich.console import Console

from mpm_verify.cases.solvers.log import LINES, WIDTH, end_of, logged, of_text
from mpm_verify.reports.frames import read
from mpm_verify.reports.sentences import failures
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.verify.terminal import table

PROGRAM = """
import json, os, pathlib, sys, time
case, out = map(pathlib.Path, sys.argv[1:])
cells = json.loads((case / "case.json").read_text())["cells"]
if cells == 4:
    for step in range(20):
        print("step", step)
    print("no wall in", case, file=sys.stderr)
    sys.exit(3)
if cells == 6:
    print("hangs", flush=True)
    time.sleep(9)
if cells == 8:
    print("takes much", flush=True)
    taken = bytearray(10**10)
if cells == 12:
    for word in ("\\x1b[31mred\\x1b[0m", "[bold]no markup[/bold]", "10 %\\r20 %", "<b>&amp;"):
        print(word, flush=True)
    os.write(1, bytes(range(256)))
    os.kill(os.getpid(), 11)
if cells == 16:
    sys.exit(3)
print("done")
"""
CELLS = (4, 6, 8, 12, 16, 24)
ENDED = {
    4: "exit code 3 under a limit of 3000 MB of memory: no wall in {case}",
    6: "longer than 1 s",
    8: "exit code 1 under a limit of 3000 MB of memory: MemoryError",
    12: "signal 11 (Segmentation fault)",
    16: "exit code 3",
    24: "the solver has not written result_",
}
LAST = {4: "no wall in {case}", 6: "hangs", 8: "MemoryError", 12: "<b>&amp;", 24: "done"}


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def asked(tmp_path: Path, program: str = PROGRAM, among: tuple[int, ...] = CELLS) -> list[str]:
    """Words of a study of a program, by default of one that fails on each grid in another way."""
    (tmp_path / "mine.py").write_text(program)
    typed = f"{sys.executable} mine.py {{case}} {{out}}"
    cells = ",".join(map(str, among))
    return ["mms", "--solver", typed, "--solution", "bump", "--cells", cells, "--order", "2", "--out", "study",
            "--time-limit", "1" if program == PROGRAM else "60", "--memory-limit", "3000"]  # fmt: skip


@pytest.mark.slow
def test_each_way_to_fail_is_shown_with_what_was_printed(verify: Call, tmp_path: Path) -> None:
    """Terminal, page, JSON, JUnit and Markdown; the kept log has all lines, and the names of the folders."""
    exports = ["--junit", "junit.xml", "--summary", "summary.md", "--page"]
    code, out, _ = verify(*asked(tmp_path), *exports, "--json")
    told = {run["cells"]: run for run in json.loads(out)["runs"] if run["courant"] == 0.4}
    page = (tmp_path / "study" / "report.html").read_text()
    junit = ElementTree.parse(tmp_path / "junit.xml").findtext(".//system-out") or ""
    summary = (tmp_path / "summary.md").read_text()
    assert code == 4
    assert "What failed runs printed" in page
    for cells in CELLS:
        assert ENDED[cells] in told[cells]["reason"], cells
        if cells == 16:
            assert told[cells]["log"] == []
            assert told[cells]["log_file"] is None
            continue
        assert any(LAST[cells] in line for line in told[cells]["log"]), told[cells]["log"]
        assert LAST[cells] in (tmp_path / told[cells]["log_file"]).read_text()
        assert LAST[cells] in junit
        assert LAST[cells] in summary
        assert LAST[cells].replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;") in page
    assert len(told[4]["log"]) == LINES
    assert len((tmp_path / told[4]["log_file"]).read_text().splitlines()) == 21
    assert "\x1b" not in "".join(told[12]["log"])

    console = Console(file=StringIO(), width=100)
    table.show(read(tmp_path / "study"), None, console)  # from what is stored alone
    out = console.file.getvalue()
    assert "the last 8 lines that it printed" in out
    assert "  | step 19" in out
    assert "  | no wall in {case}" in out
    assert Path(told[4]["log_file"]).name in "".join(out.split())
    assert "other logs of failed runs: on the page" in " ".join(out.split())


def test_runs_that_end_alike_are_told_once_and_no_old_log_stays(verify: Call, tmp_path: Path) -> None:
    typed = asked(tmp_path, "print('the wall is missing')\nraise SystemExit(3)\n", (4, 6))
    code, out, _ = verify(*typed, "--no-page", "--solver-version", "1")
    assert code == 4
    assert out.count("LOG  ") == 1
    assert "(2 other runs ended alike); the last line that it printed" in " ".join(out.split())
    assert len(list((tmp_path / "study" / "runs").glob("*.log"))) == 3
    typed = asked(tmp_path, "raise SystemExit(3)\n", (4, 6))
    code, out, _ = verify(*typed, "--no-page", "--solver-version", "1")
    assert code == 4
    assert "it printed nothing." in " ".join(out.split())
    assert not list((tmp_path / "study" / "runs").glob("*.log"))


@pytest.mark.slow
def test_compare_shows_and_keeps_the_log(verify: Call, tmp_path: Path) -> None:
    typed = asked(tmp_path)
    code, out, _ = verify("compare", "--solver", typed[2], "--solution", "bump", "--cells", "4", "--out", "compared")
    assert code == 4
    assert "  | step 19\n" in out
    assert len((tmp_path / "compared" / "log.txt").read_text().splitlines()) == 21
    assert "no wall in {case}" in (tmp_path / "compared" / "report.html").read_text()
    code, out, _ = verify("compare", "--solver", typed[2], "--solution", "bump", "--cells", "4", "--json")
    assert json.loads(out)["log"][-1] == "no wall in {case}"


def test_a_python_function_that_raises_shows_its_traceback(tmp_path: Path) -> None:
    import mpm_verify as mv

    def mine(case: object) -> None:
        raise RuntimeError("particle 7 left the grid")

    done = mv.study("mms", solver=mine, solution="bump", order=2.0, cells=[4], courant=[0.4], out=tmp_path / "study")
    result = next(iter(done.record.results.values()))
    assert result.log[-1] == "RuntimeError: particle 7 left the grid"
    assert any("in mine" in line for line in result.log)


# ---- lines


def test_lines_are_printable_short_and_the_last(tmp_path: Path) -> None:
    (tmp_path / "out").write_bytes(b"first\n" * 50 + b"\x1b[31m\xff\x00" + b"x" * 1000 + b"\n\n")
    (tmp_path / "err").write_text(f"\tin {tmp_path}/a.csv\n")
    found = logged((tmp_path / "out", tmp_path / "err", tmp_path / "nowhere"), {str(tmp_path): "{case}"})
    assert len(found.lines) == LINES
    assert all(line.isprintable() and len(line) <= WIDTH for line in found.lines)
    assert found.lines[-1] == "    in {case}/a.csv"
    assert found.lines[-2].endswith("x…")
    assert found.text.startswith("first\nfirst\n")
    assert of_text(" \n\n") == of_text("")
    assert of_text("").kept == {}


def test_of_a_long_log_the_end_is_kept(tmp_path: Path) -> None:
    (tmp_path / "out").write_bytes(b"a" * 2**20 + b"the end\n")
    assert len(end_of(tmp_path / "out")) == 2**20
    assert end_of(tmp_path / "out").endswith("the end\n")


@pytest.mark.parametrize(("number", "says"), [(3, "exit code 3"), (-9, "signal 9 (Killed)"), (-9999, "signal 9999")])
def test_how_a_program_ended(number: int, says: str) -> None:
    assert failures.code(number) == says


def test_a_program_that_printed_nothing_is_told_why_that_may_be() -> None:
    late = failures.logged("mine", Failure(FailureKind.TIME_LIMIT, -1, numbers={"seconds": 2.0}), 0, "")
    assert late.startswith("mine: the solver took longer than 2 s; it printed nothing")
    assert "fflush" in late
    assert failures.logged("mine", Failure(FailureKind.NO_ANSWER, 3), 0, "").endswith("it printed nothing.")
