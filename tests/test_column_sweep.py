"""Studies from TOML: what ships reads, a product is a product, and what is wrong is one line."""

from math import inf
from pathlib import Path

import pytest

from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.cases.harness.shipped import shipped
from mpm_verify.cases.harness.study_file import read

FIGURES = {f"figure{number}" for number in range(3, 9)}


@pytest.mark.parametrize("name", shipped())
def test_what_ships_can_be_run(name: str) -> None:
    """Each is set up, small, as it is read; a study says what it is for."""
    study = read(name, "")
    assert study.runs
    assert study.words
    assert 0 <= study.finish <= len(study.runs)
    assert len(set(study.runs)) == len(study.runs)


def test_all_figures_ship() -> None:
    assert set(shipped()) >= FIGURES
    assert [run.ppc for run in read("figure4", "").runs] == [1, 4, 9]
    assert [run.damping for run in read("figure5", "").runs] == [0, 0.02, 0.05, 0.1]
    assert {(run.smoothing, run.damping) for run in read("figure8", "").runs} == {("deviatoric", 0.05)}
    assert read("figure3", "").runs == (ColumnRun(),)


def own(folder: Path, text: str) -> str:
    path = folder / "own.toml"
    path.write_text(text)
    return str(path)


def test_a_product_without_doubles(tmp_path: Path) -> None:
    text = (
        '[run]\nppc = 1\nlimit = inf\n[sweep]\ncells = [4, 7, 4]\noffset = [[0, 0], [0.1, 0.2]]\nmaterial = ["ubcsand"]'
    )
    study = read(own(tmp_path, text), "verify sweep own.toml")
    assert [(run.cells, run.offset) for run in study.runs] == [
        (4, (0.0, 0.0)), (4, (0.1, 0.2)), (7, (0.0, 0.0)), (7, (0.1, 0.2)),
    ]  # fmt: skip
    assert {(run.ppc, run.limit, run.material) for run in study.runs} == {(1, inf, "ubcsand")}
    assert (study.name, study.title, study.axes, study.finish) == ("own", "own", ("cells", "offset"), 4)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[run", "cannot be read as TOML"),
        (
            "[runs]\nppc = 1",
            r"the file has 'runs' \(did you mean run\?\), and may have case, title, words, finish, replicates",
        ),
        ("[run]\nparticles = 1", "column has no axis 'particles'; it has method, cells"),
        ("[sweep]\ncase = ['mms']", "column has no axis 'case'"),
        ("run = 3", r"run must be a table, \[run\], not 3"),
        ("[sweep]\nppc = 4", "ppc in .sweep. must be a list of one value or more, not 4"),
        ("[sweep]\nppc = []", "must be a list of one value or more"),
        ("[run]\nppc = 4\n[sweep]\nppc = [4, 9]", "must stand in .run. or in .sweep., not in both"),
        ("[sweep]\nppc = [4, 3]", "3 particles per cell is not a square number"),
        ("[run]\nppc = 'four'", "ppc = 'four' must be a whole number"),
        ("[run]\ncells = '4'", "cells = '4' must be a whole number"),
        ("[run]\ncells = true", "cells = True must be a whole number"),
        ("[run]\ndamping = false", "damping = False must be a number"),
        ("[run]\nvoid = 1", "void = 1 must be true or false"),
        ("[run]\noffset = [0.1]", "offset"),
        ("[run]\ncells = 100000", "cells = 100000 cannot be run; choose whole numbers from 2 to 1000"),
        ("[run]\nchannel = 7.3", "channel = 7.3 must make whole cells"),
        ("[run]\ng = 1e300", "must be at most 1e4"),
        ("[run]\nmaterial = 'mohr_coulomb:rho0=1e-300'", "steps would be needed"),
        ("title = 3", "case and title must be text, not 'column' and 3"),
        ("finish = true", "finish = True must be a whole number"),
        ("[run]\nstart = 'wet'", "start = 'wet' must be 'none', 'k0' or 'oedometric'"),
        ("[run]\nmaterial = 'clay'", "no material 'clay'; choose from"),
        ("[run]\nmaterial = 'neo_hookean'", "must have a material in rate form"),
        ("[run]\ncells = 14\naspect = 6.5001", "must make whole cells"),
        ("[run]\noffset = [0.7, 0]", "must lie between -0.5 and 0.5"),
        ("[run]\ndamping = nan", "must lie from 0"),
        ("[run]\ncourant = inf", "must be above zero and finite"),
        ("[run]\nsmoothing = 'full:beta=1'", "must be below 1 with both parts"),
        ("[run]\nmaterial = 'truesdell'", "no material 'truesdell'"),
        ("finish = 2", "finish = 2 must be a whole number from 0 to the 1 runs"),
        ("words = 'many'", "words must be a list of sentences"),
        (
            f"[sweep]\ncells = {list(range(2, 103))}\nppc = {[k * k for k in range(1, 101)]}",
            "10,100 runs are asked for, and 10,000 is the most",
        ),
    ],
)
def test_what_is_wrong_is_said(text: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=says) as error:
        read(own(tmp_path, text), "")
    assert "\n" not in str(error.value)
    assert "own.toml" in str(error.value)


def test_no_such_study(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no study 'figure9' \(did you mean figure8\?\); choose from"):
        read("figure9", "")
    with pytest.raises(ValueError, match=r"cannot read .*none\.toml: no such file"):
        read(str(tmp_path / "none.toml"), "")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(ValueError, match="cannot be read as TOML"):
        read(str(tmp_path / "binary.toml"), "")
