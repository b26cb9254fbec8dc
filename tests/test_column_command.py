"""`verify column` and `verify sweep` from the command line: what is printed, stored, refused, and taken up again."""

import json
import sys
from pathlib import Path
from shutil import copytree
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest

from mpm_verify.cases.column.exam import ColumnRemark, examine
from mpm_verify.cases.column.records import ClaimCode
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.cases.harness.checks import Remark
from mpm_verify.cases.harness.store import Store
from mpm_verify.reports.export.column_files import tables
from mpm_verify.reports.figures.column import profiles
from mpm_verify.reports.frames import read
from mpm_verify.reports.pages.column import numbers
from mpm_verify.reports.sentences.column import listed
from mpm_verify.reports.words import DASH
from mpm_verify.verify.main import main

SMALL = ("--cells", "2", "--ppc", "4")
STUDY = """
title = "A small study"
words = ["What it is for."]
[run]
cells = 2
[sweep]
ppc = [4, 9, 16]
damping = [0.0, 0.1]
"""


class Ended:
    """How a command ended."""

    def __init__(self, code: int, out: str, err: str) -> None:
        self.code, self.out, self.err = code, " ".join(out.split()), err


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Any:
    """Runs a command in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def run(*words: str) -> Ended:
        monkeypatch.setattr(sys, "argv", ["verify", *words])
        with pytest.raises(SystemExit) as end:
            main()
        return Ended(int(end.value.code or 0), *capsys.readouterr())

    return run


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study of six small runs, done."""
    folder = tmp_path_factory.mktemp("swept")
    (folder / "small.toml").write_text(STUDY)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["verify", "sweep", str(folder / "small.toml"), "--out", str(folder / "out")])
        with pytest.raises(SystemExit) as end:
            main()
    assert end.value.code == 0
    return folder / "out"


def test_a_column_from_release_to_rest(verify: Any) -> None:
    """Numbers, checks, a page with an animation, and files for ParaView."""
    ended = verify("column", *SMALL, "--vtk", "--junit", "out.xml")  # snapshots are asked for, so there is a page
    assert (ended.code, ended.err) == (0, "")
    assert "1 of 1 runs came to their end. The front comes to" in ended.out
    assert "report: results/column-cells-2-ppc-4/report.html" in ended.out
    text = Path("results/column-cells-2-ppc-4/report.html").read_text()
    assert text.count('class="film"') == 1
    assert "Collapse of a granular column" in text
    store = Store(Path("results/column-cells-2-ppc-4"), "column")
    (run,) = store.study().runs
    assert run == ColumnRun(cells=2, ppc=4)
    names = sorted(file.name for file in Path("results/column-cells-2-ppc-4/vtk").iterdir())
    assert len(names) == 2 * 8 + 2
    assert f"{run.digest}.pvd" in names
    assert len(ElementTree.parse("out.xml").getroot()) == 7
    header = Path("results/column-cells-2-ppc-4/tables/curves.csv").read_text().partition("\n")[0].split(",")
    assert {"t", "front_99", "front_999", "toe", "height", "height_fit", "kinetic", "on_grid", "residual"} <= set(
        header
    )
    ended = pd.read_csv("results/column-cells-2-ppc-4/tables/profiles.csv")
    assert list(ended) == ["digest", "x", "profile", "profile_levelled", "profile_volume"]
    values = store.get(run.digest).values
    for name, expected in {"levelled": values["area_levelled"], "volume": values["volume"]}.items():
        total = ended[f"profile_{name}"].sum() * run.strip / (run.width * run.height)
        assert total == pytest.approx(expected, rel=1e-3)  # but for particles that fly


def test_json(verify: Any) -> None:
    ended = verify("column", *SMALL, "--duration", "0.1", "--json")
    assert (ended.code, ended.err) == (1, "")  # it does not rest in a tenth of a second
    told = json.loads(ended.out)
    assert (told["version"], told["case"], told["outcome"]) == (4, "column", "FAIL")
    assert told["study"] == "column-cells-2-ppc-4-duration-0.1"
    (one,) = told["runs"]
    assert one["gate"] is None  # infinite
    assert one["values"]["rest"] is None
    fronts = [one["values"][name] for name in told["more"]["measures"]["front"]]
    assert 0.08 < fronts[0] < fronts[1] < fronts[2] * 1.05
    assert told["more"]["measures"]["height"] == ["height", "height_fit"]
    assert one["values"]["on_grid"] > 0
    assert any(check["outcome"] == "FAIL" and check["group"] == "Runs" for check in told["checks"])


def test_what_a_sweep_says(swept: Path) -> None:
    """Every axis has its sentences and its refinement, in families."""
    collapse = read(swept).analysis.more
    assert len(collapse.ran) == 6
    assert {listed(claim.shared) for claim in collapse.claims} == {
        "no damping", "10 % damping", "4 per cell", "9 per cell", "16 per cell",
    }  # fmt: skip
    assert [(one.axis, one.shared) for one in collapse.refined[::5]] == [
        ("ppc", {"damping": 0.0}), ("ppc", {"damping": 0.1}),
    ]  # fmt: skip
    assert [value for value, _ in collapse.refined[0].levels] == [16, 9, 4]
    text = (swept / "report.html").read_text()
    for word in ("A small study", "What it is for.", "reproduced", "Richardson", "not reproduced"):
        assert word in text
    assert text.count('class="film"') == 6


@pytest.mark.slow  # five seconds of pages
def test_twice_is_once(verify: Any, swept: Path) -> None:
    """Nothing is computed again, and the page is the same to the byte."""
    before = {file: (file.read_bytes(), file.stat().st_mtime_ns) for file in (swept / "runs").iterdir()}
    page = (swept / "report.html").read_bytes()
    ended = verify("sweep", str(swept.parent / "small.toml"), "--out", str(swept))
    assert ended.code == 0
    assert {file: (file.read_bytes(), file.stat().st_mtime_ns) for file in (swept / "runs").iterdir()} == before
    assert (swept / "report.html").read_bytes().partition(b"How it was made")[0] == page.partition(b"How it was made")[
        0
    ]


@pytest.mark.slow
def test_a_report_is_made_again(verify: Any, swept: Path) -> None:
    page = (swept / "report.html").read_bytes()
    (swept / "report.html").unlink()
    ended = verify("report", str(swept))
    assert (ended.code, ended.err) == (0, "")
    assert (swept / "report.html").read_bytes() == page


def test_results_stored_before_a_measure_was_made_are_read(swept: Path, tmp_path: Path) -> None:
    """Old numbers stand, a dash for what they do not have; claims and refinements are those of the others."""
    folder = Path(copytree(swept, tmp_path / "out"))
    for file in (folder / "runs").glob("*.json"):
        told = json.loads(file.read_text())
        for name in ("height_fit", "area_levelled", "creep_fit"):
            del told["values"][name]
        file.write_text(json.dumps(told))
    for file in (folder / "runs").glob("*.npz"):
        with np.load(file) as stored:
            kept = {k: stored[k] for k in stored.files if k not in ("curve_profile_levelled", "curve_profile_volume")}
        np.savez(file, **{k: v for k, v in kept.items() if k != "curve_height_fit"})
    whole, old = read(swept).analysis.more, read(folder).analysis.more
    assert [one.values["front_99"] for one in old.ran] == [one.values["front_99"] for one in whole.ran]
    assert [(c.code, c.reproduced) for c in old.claims] == [(c.code, c.reproduced) for c in whole.claims]
    assert {one.quantity for one in whole.refined} - {one.quantity for one in old.refined} == {"height_fit"}
    run = old.study.runs[0]
    cells = numbers(run, old.results[run.digest])
    assert (cells[3] != DASH, cells[4], cells[7]) == (True, DASH, DASH)
    assert len(profiles(old.ran, ["a"] * 6).axes) == 1
    assert len(profiles(whole.ran, ["a"] * 6).axes) == 2
    tables(old, read(folder).store, folder / "tables")
    assert (folder / "tables" / "profiles.csv").read_text().startswith("digest,ppc,damping,x,profile\n")


@pytest.mark.slow  # five seconds of pages
def test_what_is_missing_is_run(verify: Any, swept: Path) -> None:
    """A study that was stopped goes on: the run that is not there, and no other."""
    store = Store(swept, "column")
    run = store.study().runs[2]
    kept = (swept / "runs" / f"{run.digest}.json").read_text()
    others = {file: file.stat().st_mtime_ns for file in (swept / "runs").iterdir() if run.digest not in file.name}
    (swept / "runs" / f"{run.digest}.json").unlink()
    assert len(examine(store.study(), {}, store).ran) == 0
    collapse = read(swept).analysis.more
    assert Remark(ColumnRemark.TO_DO, {"runs": 1}) in collapse.examination.findings
    assert collapse.examination.outcome == "FAIL"  # the study declares that six come to their end
    assert verify("sweep", str(swept.parent / "small.toml"), "--out", str(swept)).code == 0
    again = json.loads((swept / "runs" / f"{run.digest}.json").read_text())
    assert again["values"] == json.loads(kept)["values"]
    assert {file: file.stat().st_mtime_ns for file in others} == others


@pytest.mark.slow  # five seconds of pages
def test_curves_that_cannot_be_read_cost_figures_alone(verify: Any, swept: Path, tmp_path: Path) -> None:
    """Checks and numbers stand, and the exit code; the file is named, its film is gone, the others' are there."""
    folder = Path(copytree(swept, tmp_path / "out"))
    whole = read(folder).analysis
    digest = whole.more.study.runs[1].digest
    file = folder / "runs" / f"{digest}.npz"
    file.write_bytes(file.read_bytes()[:1000])
    found = read(folder).analysis
    assert found.checks == whole.checks
    assert repr(found.more.refined) == repr(whole.more.refined)  # an order that is not a number equals none
    gone = {claim.code for claim in whole.more.claims} - {claim.code for claim in found.more.claims}
    assert gone <= {ClaimCode.POTENTIAL_KEPT, ClaimCode.KINETIC_CHANGED}
    assert len(found.more.claims) == len(whole.more.claims) - 2  # those of the one family with that run
    ended = verify("sweep", str(swept.parent / "small.toml"), "--out", str(folder), "--vtk")
    assert (ended.code, ended.err) == (0, "")
    line = f"The curves in runs/{file.name} cannot be read, and their figures are left out"
    assert line in ended.out
    text = (folder / "report.html").read_text()
    assert line in text
    assert text.count('class="film"') == 5
    assert (folder / "tables" / "runs.csv").read_text().count("\n") == 7
    assert digest not in (folder / "tables" / "curves.csv").read_text()
    assert len(list((folder / "vtk").glob("*.pvd"))) == 2 * 5  # particles and their domains


def test_a_failed_run_is_a_result(verify: Any, tmp_path: Path) -> None:
    """What the plain scheme loses is told with its place; the study that says so beforehand passes."""
    (tmp_path / "plain.toml").write_text(
        'finish = 1\n[run]\ncells = 4\nppc = 4\n[sweep]\nlimit = [0.5, inf]\n'
    )  # fmt: skip
    ended = verify("sweep", "plain.toml")
    assert (ended.code, ended.err) == (0, "")
    assert "1 of 2 runs came to their end. 1 failed" in ended.out
    assert "failed at" in ended.out
    table = Path("results/plain/tables/runs.csv").read_text()
    assert table.count("failed") == 1


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["column", "--cells", "1"], "cells = 1 cannot be run; choose whole numbers from 2"),
        (["column", "--ppc", "3"], "3 particles per cell is not a square number"),
        (["column", "--material", "clay"], "no material 'clay'; choose from"),
        (["column", "--material", "neo_hookean"], "must have a material in rate form"),
        (["column", "--start", "wet"], "start = 'wet'"),
        (["column", "--offset", "0.1"], "--offset '0.1' must be two numbers"),
        (["column", "--offset", "0.1,0.9"], "must lie between -0.5 and 0.5"),
        (["column", "--damping", "-1"], "must lie from 0"),
        (["column", "--limit", "0"], "limit = 0.0 must be above zero"),
        (["column", "--threads", "0"], "--threads takes whole numbers from 1 on"),
        (["column", "--smoothing", "rough"], "no smoothing 'rough'; choose from"),
        (["sweep", "figure9"], "no study 'figure9' (did you mean figure8?); choose from"),
        (["sweep", "none.toml"], "cannot read none.toml"),
        (["sweep", "figure4", "--jobs", "0"], "--jobs takes whole numbers from 1 on"),
        (["sweep", "figure4", "--junit", "/dev/null/x.xml"], "cannot write --junit"),
        (["column", *SMALL, "--out", "/dev/null/x"], "Not a directory"),
    ],
)
def test_bad_input_is_one_line(verify: Any, words: list[str], says: str) -> None:
    ended = verify(*words)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.count("\n") == 1
    assert says.lower() in ended.err.lower()


@pytest.mark.slow
def test_a_store_that_cannot_be_read_stays(verify: Any, swept: Path, tmp_path: Path) -> None:
    """A broken Result is named and left; a folder of another case is refused."""
    verify("column", *SMALL, "--duration", "0.05", "--out", "one")
    (result,) = Path("one/runs").glob("*.json")
    result.write_text("{broken")
    ended = verify("column", *SMALL, "--duration", "0.05", "--out", "one")
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    assert result.name in ended.err
    assert result.read_text() == "{broken"
    ended = verify("mms", "--cells", "8", "--ppc", "1", "--out", str(swept))
    assert ended.code == 2
    assert "holds the case column, not mms; use another --out folder" in ended.err


def test_a_full_disk_is_one_line(verify: Any, monkeypatch: pytest.MonkeyPatch, swept: Path) -> None:
    """While a run is stored, and while the page is written; what was stored is kept."""

    def no_space(*_: Any, **__: Any) -> Any:
        raise OSError(28, "No space left on device")

    before = {file: file.read_bytes() for file in (swept / "runs").iterdir()}
    monkeypatch.setattr("os.replace", no_space)
    for words in (
        ("column", *SMALL, "--duration", "0.05"),
        ("sweep", str(swept.parent / "small.toml"), "--out", str(swept)),
    ):
        ended = verify(*words)
        assert ended.code == 2
        assert ended.err.count("\n") == 1
        assert "No space left on device" in ended.err
    monkeypatch.undo()
    assert {file: file.read_bytes() for file in (swept / "runs").iterdir()} == before
