"""`verify material`: its checks pass, and fail where a law is wrong; what is stored, told, and refused."""

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.element.case import examine
from mpm_verify.cases.element.checks import TABLE, material_checks, run
from mpm_verify.cases.element.drawn import limit as limits
from mpm_verify.cases.element.exam import ElementRemark, beyond, notes, origins, parameters
from mpm_verify.cases.element.execute import execute
from mpm_verify.cases.element.paths import TESTS
from mpm_verify.cases.element.run import PROPERTIES
from mpm_verify.cases.element.study import study
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.checks import Examination
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.reports.figures.element import stress
from mpm_verify.reports.frames import read
from mpm_verify.reports.sentences.remarks import lead, sentence
from mpm_verify.reports.sentences.remarks import notes as told_notes
from mpm_verify.reports.sentences.remarks import parameters as shown
from mpm_verify.solver.material import mohr_coulomb, ubcsand
from mpm_verify.solver.plugins import available, create
from mpm_verify.verify.main import main

LAWS = available("mpm_verify.solver.material")
QUICK = ("isotropic", "undrained")


def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["verify", *words])
    with pytest.raises(SystemExit) as end:
        main()
    said = capsys.readouterr()
    return int(end.value.code or 0), said.out, said.err


class Kept:
    """A store in memory."""

    def __init__(self) -> None:
        self.results: dict[str, Any] = {}
        self.kept: dict[str, Any] = {}

    def arrays(self, digest: str) -> Any:
        """Those of a run."""
        return self.kept[digest]


def examined(name: str, tests: tuple[str, ...], steps: int) -> Examination:
    """Tests of a material, and what is known of it, run and judged as the command does."""
    asked = Asked("element", {"material": [name], "test": [*tests, PROPERTIES], "steps": [steps]})
    made, store = build(asked, ""), Kept()
    for one in made.runs:
        store.results[one.digest], store.kept[one.digest] = execute(one)
    (found,) = examine(made, store.results, store).examinations.values()  # type: ignore[arg-type]
    return found


@pytest.mark.parametrize("name", LAWS)
def test_every_law_passes_its_own_checks(name: str) -> None:
    """Whatever the law: its tables and limits, and two tests."""
    found = examined(name, QUICK, 20)
    assert found.checks
    missed = [check for check in found.checks if check.outcome is not Outcome.PASS]
    assert not missed


@pytest.mark.parametrize(
    "name",
    [
        "mohr_coulomb:phi=25,psi=5",
        "mohr_coulomb:c=100",
        "mohr_coulomb:phi=0,c=1000",
        "drucker_prager:phi=0,c=1000",
        "ubcsand:Rf=0.9",
        "ubcsand:Pa=1e5,KGp=8",
    ],
)
def test_other_parameters_are_held_against_closed_forms(name: str) -> None:
    checks = material_checks(create("mpm_verify.solver.material", name))
    assert checks
    assert not [check for check in checks if check.outcome is not Outcome.PASS]
    assert not [check for check in checks if check.source == TABLE and "ubcsand" in name]


def test_a_wrong_direction_of_flow_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Flow along phi in place of psi misses the table, Davis' ratio and the dilation."""
    law = create("mpm_verify.solver.material", "mohr_coulomb")
    wrong = create("mpm_verify.solver.material", "mohr_coulomb:psi=31").constants()
    monkeypatch.setattr(mohr_coulomb.MohrCoulomb, "constants", lambda self: wrong)
    missed = {check.name for check in material_checks(law) if check.outcome is not Outcome.PASS}
    assert "plane: largest miss, zz in any position" in missed
    assert "dilation, vertical strain over shear" in missed


def test_a_lost_failure_ratio_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel that takes Rf as 0.7: the hyperbola is another one."""
    law = create("mpm_verify.solver.material", "ubcsand")
    wrong = create("mpm_verify.solver.material", "ubcsand:Rf=0.7").constants()
    monkeypatch.setattr(ubcsand.Ubcsand, "constants", lambda self: wrong)
    missed = [check for check in material_checks(law) if check.outcome is not Outcome.PASS]
    assert len(missed) > 20


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code, JSON, JUnit, page, and the page once more from what is stored."""
    out, junit = tmp_path / "out", tmp_path / "checks.xml"
    words = ("material", "mohr_coulomb", "--test", "biaxial", "--steps", "10", "--out", str(out))
    code, said, err = verify(monkeypatch, capsys, *words, "--json", "--junit", str(junit), "--page")
    assert (code, err) == (0, "")
    told = json.loads(said)
    assert told["outcome"] == "PASS"
    assert {check["outcome"] for check in told["checks"]} == {"PASS"}
    assert "testcase" in junit.read_text()
    (stored,) = read(out).analysis.more.examinations.values()
    assert stored.curves["test/biaxial"]["s"].shape == stored.curves["test/biaxial"]["ev"].shape == (161,)
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
    code, _, err = verify(monkeypatch, capsys, *words)
    assert (code, err) == (0, "")  # the derivative of the energy is known on any path
    for law in ("drucker_prager:c=10", "ubcsand:c=10"):
        code, _, err = verify(monkeypatch, capsys, "material", law, *words[2:])
        assert (code, err) == (0, "")
    (stored,) = read(tmp_path / "out").analysis.more.examinations.values()
    assert all(check.group.endswith("to round-off") for check in stored.checks)  # of the material, none of the path
    curves = stored.curves["test/path"]
    assert curves["tau"][-1] != 0
    assert np.isfinite(curves["s"]).all()


def test_what_was_read_and_what_has_no_effect_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Terminal, JSON and page: columns, the largest strain, and a rate where nothing turns."""
    path, out = tmp_path / "mine.csv", tmp_path / "out"
    path.write_text("time;EXX [%];eyy [%];ezz [%];gxy [%]\n0;0;0;0;0\n1;0;-0,1;0;0\n")
    words = ("material", "hypoelastic:rate=jaumann", "--path", str(path), "--steps", "4", "--out", str(out))
    code, said, err = verify(monkeypatch, capsys, *words)
    assert (code, err) == (0, "")
    flat = " ".join(said.split())
    (told,) = json.loads(verify(monkeypatch, capsys, *words, "--json")[1])["more"].values()
    page = (out / "report.html").read_text()
    for line in (
        "rate=jaumann changes nothing here: along a path of strains the material works in its own frame",
        "exx, eyy, gxy are read of mine.csv; the largest strain is 0.001 (0.1 %).",
        "ezz: zero in every row, as in plane strain",
        "Not used of mine.csv: time.",
    ):
        assert line in flat
        assert line in told["lead"]
        assert line in page
    codes = {ElementRemark.RATE_IDLE, ElementRemark.PATH_READ, ElementRemark.PATH_ZERO, ElementRemark.PATH_UNUSED}
    assert [finding["code"] for finding in told["findings"] if finding["code"] in codes] == [
        "element.rate_idle", "element.path_read", "element.path_zero", "element.path_unused",
    ]  # fmt: skip
    (told,) = json.loads(
        verify(monkeypatch, capsys, "material", "hypoelastic", "--test", "isotropic", *words[4:], "--json")[1]
    )["more"].values()
    assert not codes & {finding["code"] for finding in told["findings"]}


@pytest.mark.parametrize("name", ["mohr_coulomb", "drucker_prager"])
def test_first_order_is_told_to_be_expected(name: str) -> None:
    """Where an order is told at all: of paths on which each step is exact there is none."""
    assert "First order is expected" in lead(examined(name, ("shear_stress", "isotropic"), 10))
    flat = examined(name, ("isotropic",), 10)
    assert ElementRemark.FIRST_ORDER not in {finding.code for finding in flat.findings}
    assert "1 is exact" in lead(flat)


def test_second_order_is_not_told_to_be_first() -> None:
    found = examined("ubcsand", QUICK, 10)
    assert {finding.code for finding in found.findings} >= {ElementRemark.TESTS, ElementRemark.ORDERS}
    assert ElementRemark.FIRST_ORDER not in {finding.code for finding in found.findings}


@pytest.mark.parametrize("name", ["mohr_coulomb", "drucker_prager", "mohr_coulomb:psi=20"])
def test_the_limit_that_is_drawn_is_the_one_that_is_reached(name: str) -> None:
    """Davis' ratio times the vertical stress, in the curves of the page."""
    law = create("mpm_verify.solver.material", name)
    limit = limits(law, 5e3)["limit/shear_stress"]["tau"]
    end = run(law, "shear_stress", 0.3, 5e3, 400).sigma[-1, 3]
    assert end == pytest.approx(limit[0], rel=1e-4)
    drawn = examined(name, ("shear_stress",), 5).curves
    np.testing.assert_array_equal(drawn["limit/shear_stress"]["tau"], limit)
    figure = stress(drawn["test/shear_stress"], None, "gamma", "tau", (), limit[0])
    assert [line.get_label() for line in figure.axes[0].lines] == ["at failure (Davis)", "computed"]


@pytest.mark.parametrize("name", ["mohr_coulomb:c=10", "drucker_prager:cone=compression", "ubcsand", "hypoelastic"])
def test_no_limit_is_drawn_where_none_is_known(name: str) -> None:
    assert not limits(create("mpm_verify.solver.material", name), 5e3)


def told_of(law: Any) -> dict[str, str]:
    """Parameters of a material as they are shown."""
    return shown(Examination("m", "", "", (), (), parameters(law, 5e3, 10), origins(law)))


def test_the_correlation_is_the_default() -> None:
    """What is said of Rf is what it is."""
    assert pytest.approx(1.1 * ubcsand.Ubcsand.N**-0.15, rel=1e-9) == ubcsand.Ubcsand.Rf


def test_parameters_say_what_they_do() -> None:
    """Parameters of UBCSAND: which have no effect, which are not in the paper, which is our reading."""
    usual = told_of(ubcsand.Ubcsand())
    factors = [f"hfac{n}" for n in range(1, 7)]
    assert [usual[name].partition(" ")[2] for name in factors] == ["(no effect in primary loading)"] * 6
    assert usual["Rf"].startswith("0.7708770538 (not in the paper's Table 2; ")
    assert "1.1 N^-0.15" in usual["Rf"]
    assert usual["reversal"].startswith("0 (1 is how we read the cyclic model")
    cyclic = told_of(ubcsand.Ubcsand(reversal=1.0))
    told = [cyclic[name].partition(" ")[2] for name in factors]
    assert told == ["(in the stiffness after a reversal)"] * 2 + ["(no effect)"] * 4
    assert told_of(create("mpm_verify.solver.material", "mohr_coulomb"))["phi"] == "31"


@pytest.mark.parametrize("reversal", [0.0, 1.0])
def test_what_is_told_of_the_factors_is_so(reversal: float) -> None:
    """Cyclic shear with other factors: hfac1 and hfac2 count with reversals, the rest never."""

    def end(**factors: float) -> bytes:
        law = ubcsand.Ubcsand(reversal=reversal, **factors)
        found = run(law, "cyclic_shear", 0.02, 5e3, 96)
        assert not found.failed
        return found.sigma.tobytes()

    for number in range(1, 7):
        assert (end(**{f"hfac{number}": 0.5}) != end()) == (reversal == 1 and number <= 2)


def test_how_often_zz_is_out_of_range_is_told() -> None:
    """All of isotropic compression, where zz lags behind; none of shear at constant vertical stress; UBCSAND alone."""
    found = examined("ubcsand", ("isotropic", "shear_stress"), 10)
    assert "in 100 % of the steps" in told_notes(found, "Isotropic compression")[-1]
    assert "zz is within the range" in told_notes(found, "Simple shear at constant vertical stress")[-1]
    soil = create("mpm_verify.solver.material", "mohr_coulomb")
    codes = {remark.code for remark in notes(soil, study(soil, TESTS["isotropic"], 5e3, 10))}
    assert codes == {ElementRemark.AGAINST, ElementRemark.ROUND_OFF}


def test_the_share_counts_the_steps() -> None:
    """Two of three, as the start is no step."""
    law = ubcsand.Ubcsand()
    sx, sy, sz, tau = np.array([[1, 3, 5, 0], [1, 3, 0.5, 0], [1, 3, 3.5, 0], [2, 2, 2, 1.0]]).T
    one = replace(study(law, TESTS["isotropic"], 5e3, 1), curve={"s": sx, "sx": sx, "sy": sy, "sz": sz, "tau": tau})
    assert beyond(law, one) == pytest.approx(2 / 3)
    assert " in 66.7 % of the steps" in sentence(notes(law, one)[-1])


def test_curves_that_cannot_be_read_cost_figures_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Not a check, not an order, not the exit code; the file is named, and its figures are gone."""
    words = ("material", "mohr_coulomb", "--test", "biaxial,shear_stress", "--steps", "10", "--out", str(tmp_path))
    before = json.loads(verify(monkeypatch, capsys, *words, "--json", "--page")[1])
    figures = (tmp_path / "report.html").read_text().count('<svg role="img"')
    run = next(run for run in before["runs"] if run["test"] == "shear_stress")
    file = tmp_path / "runs" / f"{run['digest']}.npz"
    file.write_bytes(file.read_bytes()[:1000])
    code, said, err = verify(monkeypatch, capsys, *words)
    assert (code, err) == (0, "")
    line = f"The curves in runs/{file.name} cannot be read, and their figures are left out"
    assert line in " ".join(said.split())
    page = (tmp_path / "report.html").read_text()
    assert line in page
    assert page.count('<svg role="img"') == figures - 3
    after = json.loads(verify(monkeypatch, capsys, *words, "--json")[1])
    assert after["checks"] == before["checks"]
    (old,), (new,) = before["more"].values(), after["more"].values()
    unread = {"code": "element.unread", "numbers": {"files": f"runs/{file.name}"}, "group": ""}
    assert [finding for finding in new["findings"] if finding != unread] == old["findings"]
    assert unread in new["findings"]


def test_several_materials_and_paths_are_told_apart(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Checks, findings, figures and headings of each; two files of one name are two paths."""
    for name, shear in (("a", "0.01"), ("b", "0.02")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "mine.csv").write_text(f"exx,eyy,gxy\n0,0,0\n0,-0.001,{shear}\n")
    paths = ",".join(str(tmp_path / name / "mine.csv") for name in "ab")
    words = ("material", "neo_hookean", "hypoelastic", "--path", paths, "--steps", "4", "--out", str(tmp_path / "out"))
    code, said, err = verify(monkeypatch, capsys, *words, "--json", "--page")
    assert (code, err) == (0, "")
    told = json.loads(said)
    groups = {check["group"] for check in told["checks"]}
    names = ("neo_hookean", "hypoelastic")
    assert tuple(told["more"]) == names
    tests = {f"{name}: Strain path of mine.csv ({number})" for name in names for number in (1, 2)}
    assert tests <= groups
    page = (tmp_path / "out" / "report.html").read_text()
    assert all(f">{heading}</h2>" in page for heading in tests)
    assert page.count("stress path.") == 4


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["sand"], "no material 'sand' (did you mean ubcsand?); choose from"),
        (["mohr_coulomb:psi=40"], "psi = 40.0 must lie between 0 and phi"),
        (["mohr_coulomb:nu=0.5"], "nu = 0.5 must lie between"),
        (["mohr_coulomb:E=-1"], "must be above zero"),
        (["mohr_coulomb:rate=spin"], "no rate 'spin'; choose from"),
        (["ubcsand", "--test", "triaxial"], "no test 'triaxial'; choose from isotropic"),
        (["ubcsand", "--stress", "-5"], "stress = -5 must be above zero and finite"),
        (["ubcsand", "--stress", "nan"], "stress = nan must be above zero and finite"),
        (["neo_hookean", "--stress", "5"], "a material with a stress from F starts undeformed"),
        (["ubcsand:ne=1,me=1", "--steps", "1"], "or round-off does; choose --steps 2 or more, or --start none"),
        (["ubcsand", "--steps", "1", "--stress", "10"], "or round-off does; choose 35 or more, or --start none"),
        (["ubcsand:ne=1,me=1,KGe=1e8,KBe=1e8", "--steps", "1"], "or round-off does; choose --start none"),
        (["ubcsand", "--steps", "0"], "steps = 0 cannot be run; choose whole numbers from 1 to 10000"),
        (["ubcsand", "--path", "none.csv"], "none.csv: no such file"),
        (["ubcsand", "--path", "none.csv", "--units", "pct"], "--units pct must be one of percent, fraction"),
        (["ubcsand", "--units", "percent"], "--units belongs to --path FILE.csv"),
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
