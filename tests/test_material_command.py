"""`verify material`: its checks pass, and fail where a law is wrong; what is stored, told, and refused."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from cases.checks import load
from cases.element_paths import TESTS
from cases.material_checks import law_checks
from cases.material_exam import examine
from cases.records import Outcome
from solver.material import mohr_coulomb, ubcsand
from solver.plugins import available, create
from verify.main import main

LAWS = available("solver.material")
QUICK = [TESTS["isotropic"], TESTS["undrained"]]


def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["verify", *words])
    with pytest.raises(SystemExit) as end:
        main()
    said = capsys.readouterr()
    return int(end.value.code or 0), said.out, said.err


@pytest.mark.parametrize("name", LAWS)
def test_every_law_passes_its_own_checks(name: str) -> None:
    """Whatever the law: its tables and limits, and two tests."""
    found = examine(name, create("solver.material", name), QUICK, 5e3, 20, "")
    assert found.checks
    missed = [check for check in found.checks if check.outcome is not Outcome.PASS]
    assert not missed


@pytest.mark.parametrize(
    "name", ["mohr_coulomb:phi=25,psi=5", "mohr_coulomb:c=100", "ubcsand:Rf=0.9", "ubcsand:Pa=1e5,KGp=8"]
)
def test_other_parameters_are_held_against_closed_forms(name: str) -> None:
    checks = law_checks(create("solver.material", name))
    assert checks
    assert not [check for check in checks if check.outcome is not Outcome.PASS]
    assert not [check for check in checks if check.source == "reference table" and "ubcsand" in name]


def test_a_wrong_direction_of_flow_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Flow along phi in place of psi misses the table, Davis' ratio and the dilation."""
    law = create("solver.material", "mohr_coulomb")
    wrong = create("solver.material", "mohr_coulomb:psi=31").constants()
    monkeypatch.setattr(mohr_coulomb.MohrCoulomb, "constants", lambda self: wrong)
    missed = {check.name for check in law_checks(law) if check.outcome is not Outcome.PASS}
    assert "plane: largest miss, zz in any place" in missed
    assert "dilation, vertical strain over shear" in missed


def test_a_lost_failure_ratio_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel that takes Rf as 0.7: the hyperbola is another one."""
    law = create("solver.material", "ubcsand")
    wrong = create("solver.material", "ubcsand:Rf=0.7").constants()
    monkeypatch.setattr(ubcsand.Ubcsand, "constants", lambda self: wrong)
    missed = [check for check in law_checks(law) if check.outcome is not Outcome.PASS]
    assert len(missed) > 20


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code, JSON, JUnit, page, and the page once more from what is stored."""
    out, junit = tmp_path / "out", tmp_path / "checks.xml"
    words = ("material", "mohr_coulomb", "--test", "biaxial", "--steps", "10", "--out", str(out))
    code, said, err = verify(monkeypatch, capsys, *words, "--json", "--junit", str(junit))
    assert (code, err) == (0, "")
    told = json.loads(said)
    assert told["outcome"] == "PASS"
    assert {check["outcome"] for check in told["checks"]} == {"PASS"}
    assert "testcase" in junit.read_text()
    stored = load(out)
    assert stored.curves["test/biaxial"]["s"].shape == stored.curves["test/biaxial"]["ev"].shape
    page = out / "report.html"
    first = page.read_bytes()
    assert b"Drained biaxial compression" in first
    page.unlink()
    code, said, err = verify(monkeypatch, capsys, "report", str(out))
    assert (code, err) == (0, "")
    assert page.read_bytes() == first


def test_a_path_of_ones_own_is_shown_and_not_judged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.csv"
    path.write_text("exx,eyy,gxy\n0,0,0\n0,-0.001,0\n0,-0.001,0.01\n")
    words = ("material", "neo_hookean", "--path", str(path), "--steps", "4", "--out", str(tmp_path / "out"))
    code, said, err = verify(monkeypatch, capsys, *words)
    assert (code, err) == (0, "")  # the derivative of the energy is known on any path
    code, said, err = verify(monkeypatch, capsys, "material", "drucker_prager:c=10", *words[2:])
    assert (code, err) == (3, "")
    assert "nothing is judged" in " ".join(said.split())
    curves = load(tmp_path / "out").curves["test/path"]
    assert curves["tau"][-1] != 0
    assert np.isfinite(curves["s"]).all()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["sand"], "no material 'sand'; choose from"),
        (["mohr_coulomb:psi=40"], "psi = 40.0 must lie between 0 and phi"),
        (["mohr_coulomb:nu=0.5"], "nu = 0.5 must lie between"),
        (["mohr_coulomb:E=-1"], "must be above zero"),
        (["mohr_coulomb:rate=spin"], "no rate 'spin'; choose from"),
        (["ubcsand", "--test", "triaxial"], "no test 'triaxial'; choose from isotropic"),
        (["ubcsand", "--stress", "-5"], "--stress -5 must be above zero"),
        (["ubcsand", "--stress", "nan"], "must be above zero and finite"),
        (["neo_hookean", "--stress", "5"], "a law of F starts undeformed"),
        (["ubcsand", "--steps", "0"], "--steps takes whole numbers from 1"),
        (["ubcsand", "--path", "none.csv"], "none.csv: no such file"),
    ],
)
def test_what_is_wrong_is_one_line(
    words: list[str], told: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code, said, err = verify(monkeypatch, capsys, "material", *words)
    assert (code, said) == (2, "")
    assert err.startswith("verify: ")
    assert err.count("\n") == 1
    assert told in err
