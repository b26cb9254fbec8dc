"""Arrays that cannot be read stop no verdict: what Results hold is judged, what needs curves is an ERROR."""

import sys
from pathlib import Path

import numpy as np
import pytest

from mpm_verify.cases.harness.analysis import analyse
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.cases.objectivity.axes import KINEMATIC
from mpm_verify.cases.objectivity.block import SMALL, blocks
from mpm_verify.cases.objectivity.case import Result
from mpm_verify.cases.objectivity.exam import STORED
from mpm_verify.reports.frames import Record, read
from mpm_verify.verify.main import main
from mpm_verify.verify.run import page_of, shown

COLUMN = "finish = 0\n[run]\ncells = 4\nppc = 4\nduration = 0.05\n[sweep]\ndamping = [0.0, 0.05]\n"
STUDIES = {  # arguments, exit code, runs with arrays
    "mms": (["mms", "--cells", "8,16,24,32,48", "--ppc", "4"], 0, 6),
    "column": (["sweep", "two.toml", "--vtk"], 0, 2),
    "element": (["material", "mohr_coulomb", "--test", "biaxial,isotropic"], 0, 3),
    "wave_bar": (["wave_bar", "--cells", "8,12,16,24,32"], 0, 6),
}


def verify(words: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> tuple[int, str]:
    """Exit code and what is printed."""
    monkeypatch.setattr(sys, "argv", ["verify", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    told = capsys.readouterr()
    assert told.err == ""
    return int(str(ended.value.code)), told.out


def cut(store: Path) -> list[Path]:
    """Truncate every array file of a study; those files."""
    files = sorted((store / "runs").glob("*.npz"))
    for file in files:
        file.write_bytes(file.read_bytes()[:-30])
    return files


@pytest.mark.parametrize("case", STUDIES)
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
    drawn = {file.name for file in Path("study/figures").glob("*.svg")}
    files = cut(Path("study"))
    assert len(files) == count
    stored = {file: file.read_bytes() for file in files}
    code, told = verify(command, capsys, monkeypatch)
    left, text = read(Path("study")), Path("study/report.html").read_text()
    assert code == before[0]
    if case == "column":  # the paper's sentences need curves
        assert whole.more.claims
        assert not left.analysis.more.claims
        assert "The stored curves of 2 cannot be read: they are in no figure" in " ".join(told.split())
    else:
        assert told == before[1]
    assert (text.count("Its stored curves cannot be read, and are not drawn.") == 2) == (case == "element")
    assert left.analysis.outcomes == whole.outcomes
    assert left.analysis.checks == whole.checks
    assert not any(left.store.readable(run.digest) for run in left.study.runs)
    assert {file.name for file in Path("study/figures").glob("*.svg")} <= drawn
    assert {file: file.read_bytes() for file in files} == stored  # nothing is run again or written over
    assert verify(["report", "study"], capsys, monkeypatch)[0] == 0


def test_a_check_that_needs_curves_is_an_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Of the turned block: what needs no curves is judged all the same, and an ERROR hides no FAIL."""
    record = block(tmp_path, found=0.0)
    (error,) = (check for check in record.analysis.checks if check.outcome is Outcome.ERROR)
    assert (error.group, error.name) == (STORED, SMALL)
    assert [check.outcome for check in record.analysis.checks] == [Outcome.ERROR, Outcome.PASS]
    assert record.analysis.exit_code == 4
    text = page_of(record).read_text()
    assert SMALL in text
    assert "of the kinematic part" in text
    shown(record, None)
    assert f"ERROR {STORED}: {SMALL}" in capsys.readouterr().out
    missed = block(tmp_path / "missed", found=1.0).analysis
    assert [check.outcome for check in missed.checks] == [Outcome.ERROR, Outcome.FAIL]
    assert missed.exit_code == 1


def block(folder: Path, found: float) -> Record:
    """A record of the turned block whose kinematic part found a number; the curves of the small block are cut off."""
    study = build(Asked("objectivity", {"cells": (4,)}), "verify", "t")
    store = Store(folder, "objectivity")
    store.create(study)
    known = Check("Rates", "of the kinematic part", found, 0.5, "at most", "closed form")
    base = study.runs[0]
    for run in study.runs:
        checks = (known,) if run.part == KINEMATIC else ()
        store.put(Result(run=run, digest=run.digest, status="finished", checks=checks), {"mean/t": np.zeros(1)})
    small = store.runs / f"{blocks(base)[SMALL].digest}.npz"
    small.write_bytes(small.read_bytes()[:-30])
    results = {run.digest: store.get(run.digest) for run in study.runs}
    assert analyse(study, results, store).outcome is not Outcome.PASS
    return Record(store, study, results, earlier=False)
