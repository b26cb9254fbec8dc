"""Arrays that cannot be read stop no verdict, for Results hold what is judged; the turned block has its own tests."""

import sys
from pathlib import Path

import pytest

from mpm_verify.cases.harness.store import StoreError
from mpm_verify.reports.frames import read
from mpm_verify.verify.main import main

COLUMN = "finish = 0\n[run]\ncells = 4\nppc = 4\nduration = 0.05\n[sweep]\ndamping = [0.0, 0.05]\n"
STUDIES = {  # arguments, exit code, runs with arrays
    "mms": (["mms", "--cells", "8,16,24,32,48", "--ppc", "4"], 0, 6),
    "column": (["sweep", "two.toml", "--vtk"], 0, 2),
    "element": (["material", "mohr_coulomb", "--test", "biaxial,isotropic"], 0, 3),
    "wave_bar": (["wave_bar", "--cells", "8,12,16,24,32"], 0, 6),
}

SAID = ("column", "element")  # cases whose page has a lead
UNREAD: list[str] = []  # lines on standard error


def verify(words: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> tuple[int, str]:
    """Exit code and what is printed."""
    monkeypatch.setattr(sys, "argv", ["verify", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    told = capsys.readouterr()
    UNREAD[:] = told.err.splitlines()
    return int(str(ended.value.code)), told.out


def cut(store: Path) -> list[Path]:
    """Truncate every array file of a study; those files."""
    files = sorted((store / "runs").glob("*.npz"))
    for file in files:
        file.write_bytes(file.read_bytes()[:-30])
    return files


@pytest.mark.slow
@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=[pytest.mark.slow] if case == "column" else []) for case in STUDIES]
)
def test_verdicts_stand_without_arrays(
    case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same exit code, verdicts and checks; the page is drawn with the figures that are left, and says so."""
    monkeypatch.chdir(tmp_path)
    Path("two.toml").write_text(COLUMN)
    words, code, count = STUDIES[case]
    command = [*words, "--out", "study", "--jobs", "1"]
    before = verify(command, capsys, monkeypatch)
    whole = read(Path("study")).analysis
    assert before[0] == code
    assert "cannot be read" not in before[1]
    drawn = {file.name for file in Path("study/figures").glob("*.svg")}
    files = cut(Path("study"))
    assert len(files) == count
    stored = {file: file.read_bytes() for file in files}
    code, told = verify(command, capsys, monkeypatch)
    left, text = read(Path("study")), Path("study/report.html").read_text()
    assert code == before[0]
    assert ("cannot be read, and their figures are left out" in " ".join(told.split())) == (case in SAID)
    named = [file for file in files if f"runs/{file.name}" in text]
    assert len(named) == {"mms": 1, "wave_bar": 0}.get(case, 2)  # of the material's own properties there are no curves
    assert len(UNREAD) == (case == "mms")
    if case == "mms":  # the one whose error field is drawn
        assert UNREAD[0].startswith(f"verify: cannot read study/runs/{named[0].name}: ")
        assert "finished with its particles stored" not in text
    if case not in SAID:
        assert told == before[1]
    assert left.analysis.outcomes == whole.outcomes
    assert left.analysis.checks == whole.checks
    for run in left.study.runs:
        with pytest.raises(StoreError, match="cannot read"):
            left.store.arrays(run.digest)
    assert {file.name for file in Path("study/figures").glob("*.svg")} <= drawn
    assert {file: file.read_bytes() for file in files} == stored  # nothing is run again or written over
    assert verify(["report", "study"], capsys, monkeypatch)[0] == 0
