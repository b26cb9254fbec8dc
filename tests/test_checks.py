"""Checks and examinations: each way of a check, what is stored and read again, and what the command makes of it."""

import json
from dataclasses import replace
from math import inf, nan
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import typer

from mpm_verify.cases.element.case import ElementAnalysis
from mpm_verify.cases.element.run import ElementResult, ElementRun
from mpm_verify.cases.harness.analysis import Analysis
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.checks import Check, Examination, Remark
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.reports.components.examined import Section, checks_table, digits, render
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.export.document import document
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.remarks import notes
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.solver.plugins import CASES, available
from mpm_verify.verify.main import main
from mpm_verify.verify.run import Settings, conduct, more_of, usage
from mpm_verify.verify.terminal.checks import closest, sentence

ARRAYS = {"run/block of 1 m/t": np.linspace(0, 1, 5), "run/block of 1 m/xx": np.arange(5.0), "exact/t": np.zeros(0)}
FINDINGS = (
    Remark("objectivity.missed", {"missed": 2, "checks": 30}),
    Remark("element.against", {"source": "a sieve <&>"}),
    Remark("objectivity.particles", {"largest": 0.123}, "words"),
    Remark("element.order", {"order": 1.5}, "words"),
)
GOOD = Check("turn", "stress", 1.001, 1.0, "relative", "closed form", 0.01)
BAD = Check("turn", "shear stress", 0.2, 0.1, "at_most", "symmetry")
LOST = Check("shear", "order", nan, 2.0, "absolute", "leading term", 0.1)
INVERTED = Failure(FailureKind.INVERTED, 3)


def examination(*checks: Check, name: str = "objectivity") -> Examination:
    return Examination(
        name, "A turn", "verify objectivity", FINDINGS, checks, {"E [Pa]": 5e5, "rate": "jaumann"},
        {"E [Pa]": "objectivity.paper"}, {"python": "3"},
    )  # fmt: skip


# ---- a check


@pytest.mark.parametrize(
    ("way", "found", "expected", "within", "outcome", "miss"),
    [
        ("absolute", 2.05, 2.0, 0.1, "PASS", 0.05),
        ("absolute", 2.15, 2.0, 0.1, "FAIL", 0.15),
        ("absolute", 1.75, 2.0, 0.25, "PASS", 0.25),  # the bound itself
        ("absolute", -0.05, 0.0, 0.1, "PASS", 0.05),
        ("absolute", 1.0, 1.0, 0.0, "PASS", 0.0),
        ("relative", 205.0, 200.0, 0.03, "PASS", 0.025),
        ("relative", 194.0, 200.0, 0.02, "FAIL", 0.03),
        ("relative", -205.0, -200.0, 0.03, "PASS", 0.025),
        ("relative", 200.0, -200.0, 0.03, "FAIL", 2.0),
        ("at_least", 0.2, 0.1, 0.0, "PASS", 0.1),
        ("at_least", 0.1, 0.1, 0.0, "PASS", 0.0),
        ("at_least", 0.05, 0.1, 0.0, "FAIL", 0.05),
        ("at_most", 0.05, 0.1, 0.0, "PASS", 0.05),
        ("at_most", 0.1, 0.1, 0.0, "PASS", 0.0),
        ("at_most", 0.2, 0.1, 0.0, "FAIL", 0.1),
    ],
)
def test_ways(way: Any, found: float, expected: float, within: float, outcome: str, miss: float) -> None:
    check = Check("g", "n", found, expected, way, "s", within)
    assert check.outcome == outcome
    assert check.miss == pytest.approx(miss, abs=1e-12)


@pytest.mark.parametrize("way", ["relative", "absolute", "at_least", "at_most"])
@pytest.mark.parametrize("found", [nan, inf, -inf])
def test_no_number_is_an_error(way: Any, found: float) -> None:
    assert Check("g", "n", found, 0.1, way, "s", 1.0).outcome is Outcome.ERROR


def test_the_worst_check_is_the_outcome() -> None:
    assert examination().outcome is Outcome.INCONCLUSIVE
    assert examination(GOOD).outcome is Outcome.PASS
    assert examination(GOOD, BAD).outcome is Outcome.FAIL
    assert examination(LOST, BAD, GOOD).outcome is Outcome.FAIL
    assert examination(LOST, GOOD).outcome is Outcome.ERROR
    assert examination(LOST, BAD, GOOD).groups == ("shear", "turn", "words")


# ---- the store


def study_of_checks() -> Study[ElementRun]:
    """A study of one run, whose Result holds whatever checks a test puts into it."""
    asked = Asked("element", {"material": ["mohr_coulomb"], "test": ["properties"]})
    return build(asked, "verify material mohr_coulomb --test properties", "checks", "A turn")


def stored(folder: Path, *checks: Check) -> Study[ElementRun]:
    """That study in a folder, its Result with these checks."""
    study = study_of_checks()
    (run,) = study.runs
    store = Store(folder, "element")
    store.create(study)
    store.put(ElementResult(run=run, digest=run.digest, status="finished", checks=checks), ARRAYS)
    return study


def test_round_trip(tmp_path: Path) -> None:
    """Bit for bit, NaN and infinity included; a second time over the first."""
    kept = (GOOD, BAD, replace(BAD, found=np.float64(1 / 3), expected=inf), replace(LOST, failure=INVERTED))
    for _ in range(2):
        (run,) = stored(tmp_path / "a" / "b", *kept).runs
        store = Store(tmp_path / "a" / "b", "element")
        read = store.get(run.digest).checks
        assert read[:3] == kept[:3]
        assert (np.isnan(read[3].found), replace(read[3], found=0.0)) == (True, replace(kept[3], found=0.0))
        assert read[3].outcome is Outcome.ERROR
        arrays = store.arrays(run.digest)
        assert list(arrays) == list(ARRAYS)
        for name, values in ARRAYS.items():
            np.testing.assert_array_equal(arrays[name], values)
    names = sorted(path.name for path in (tmp_path / "a" / "b").rglob("*"))
    assert names == sorted([f"{run.digest}.json", f"{run.digest}.npz", "runs", "study.json"])


BROKEN = {
    "empty": ("json", b""),
    "cut off": ("json", b'{"format": 2, "case": "elem'),
    "no object": ("json", b"[1]"),
    "no text": ("json", b"\xff\xfe\x00"),
    "another format": ("json", b'{"format": 99}'),
    "a way that is none": ("json", None),
    "arrays cut off": ("npz", b"PK\x03\x04 and no more"),
    "arrays of something else": ("npz", b"hello"),
    "arrays empty": ("npz", b""),
}


@pytest.mark.parametrize("what", BROKEN)
def test_a_broken_file_is_one_line_and_stays(what: str, tmp_path: Path) -> None:
    (run,) = stored(tmp_path, GOOD).runs
    end, content = BROKEN[what]
    file = tmp_path / "runs" / f"{run.digest}.{end}"
    content = file.read_bytes().replace(b'"relative"', b'"about"') if content is None else content
    file.write_bytes(content)
    store = Store(tmp_path, "element")
    with pytest.raises(StoreError) as told:
        store.get(run.digest) if end == "json" else store.arrays(run.digest)
    assert "\n" not in str(told.value)
    assert str(file) in str(told.value)
    kinds = {"another format": "format 99", "json": "left as it is", "npz": "delete it and its .json file"}
    assert kinds.get(what, kinds[end]) in str(told.value)
    assert file.read_bytes() == content


@pytest.mark.parametrize("name", ["study.json", "json", "npz"])
def test_a_missing_file_is_named(name: str, tmp_path: Path) -> None:
    """A Result that is not there is a run still to be done; arrays that are not there are named."""
    (run,) = stored(tmp_path, GOOD).runs
    store = Store(tmp_path, "element")
    if name == "study.json":
        (tmp_path / name).unlink()
        with pytest.raises(StoreError, match=r"is not a study folder: it has no study\.json"):
            store.study()
        return
    (tmp_path / "runs" / f"{run.digest}.{name}").unlink()
    if name == "json":
        assert store.get(run.digest) is None
    else:
        with pytest.raises(StoreError, match=rf"cannot read .*{run.digest}\.npz: .*No such file"):
            store.arrays(run.digest)


# ---- the command


def drawn(folder: Path, *checks: Check) -> str:
    """A page of the words and the checks alone."""

    def sections(found: Examination, add: Add) -> list[Section]:
        return [Section("turn", "The turn", ("Words.",), (), [checks_table("turn", found.checks)])]

    return render(folder, examination(*checks), sections).read_text()


def run(tmp_path: Path, *checks: Check, **settings: Any) -> int:
    """Exit code of a study whose checks are these; what is stored is not computed again."""
    return conduct(stored(tmp_path / "out", *checks), Settings(tmp_path / "out", **settings))


@pytest.mark.parametrize(
    ("checks", "code", "outcome"),
    [
        ((GOOD,), 0, "PASS"),
        ((GOOD, BAD), 1, "FAIL"),
        ((GOOD, LOST), 4, "ERROR"),
        ((LOST, BAD, GOOD), 1, "FAIL"),
        ((), 3, "INCONCLUSIVE"),
    ],
    ids=["pass", "fail", "error", "fail and error", "none"],
)
def test_exit_codes_and_what_is_printed(
    checks: tuple[Check, ...], code: int, outcome: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, *checks) == code
    out = capsys.readouterr().out
    words = " ".join(out.split())
    assert "A turn" in out
    missed = sum(check is not GOOD for check in checks)
    told = f"{missed} did not pass" if missed else "all pass"
    plural = "s" * (len(checks) != 1)
    assert (f" {len(checks)} check{plural}: {told}." if checks else "nothing is judged.") in words
    assert out.rstrip().endswith("report.html")
    assert ("FAIL turn: shear stress is 0.2, expected at most 0.1 (symmetry)" in words) == (BAD in checks)
    assert ("ERROR shear: order: there is no number to hold against 2" in words) == (LOST in checks)
    assert (tmp_path / "out" / "tables" / "checks.csv").exists() == bool(checks)
    if checks:
        assert (tmp_path / "out" / "tables" / "checks.csv").read_text().count("\n") == len(checks) + 1
    assert f'<span class="badge {outcome}">' in (tmp_path / "out" / "report.html").read_text()


def strict(constant: str) -> None:
    raise AssertionError(f"{constant} is no JSON")


def test_json_has_no_nan_and_junit_every_check(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    junit = tmp_path / "new" / "checks.xml"
    infinite = replace(GOOD, name="lost", found=inf)
    assert run(tmp_path, GOOD, BAD, LOST, infinite, json_output=True, junit=junit, page=True) == 1
    told = json.loads(capsys.readouterr().out, parse_constant=strict)
    assert (told["study"], told["case"], told["outcome"], told["version"]) == ("checks", "element", "FAIL", 4)
    assert [check["outcome"] for check in told["checks"]] == ["PASS", "FAIL", "ERROR", "ERROR"]
    assert [check["found"] for check in told["checks"]] == [1.001, 0.2, None, None]
    assert Path(told["report"]).exists()
    suite = ElementTree.parse(junit).getroot()
    assert suite.attrib == {"name": "checks", "tests": "4", "errors": "2", "failures": "1", "time": "0.000"}
    assert [case.attrib["classname"] for case in suite] == ["checks.turn"] * 2 + ["checks.shear", "checks.turn"]
    assert [[child.tag for child in case] for case in suite] == [[], ["failure"], ["error"], ["error"]]


def test_names_in_junit_are_unique(tmp_path: Path) -> None:
    """Servers show one test of a name; checks of a case of one's own may share theirs."""
    run(tmp_path, GOOD, BAD, replace(GOOD, found=2.0), replace(GOOD, group="shear"), GOOD, junit=tmp_path / "out.xml")
    suite = ElementTree.parse(tmp_path / "out.xml").getroot()
    named = [(case.attrib["classname"], case.attrib["name"]) for case in suite]
    assert [name for _, name in named] == ["stress", "shear stress", "stress (2)", "stress", "stress (3)"]
    assert len(set(named)) == 5
    assert [len(case) for case in suite] == [0, 1, 1, 0, 0]


def test_what_is_wrong_with_the_input_is_one_line(tmp_path: Path) -> None:
    """Before anything is computed."""
    with pytest.raises(typer.TyperException, match="cannot write --junit"):
        conduct(study_of_checks(), Settings(tmp_path / "out", junit=tmp_path))
    with pytest.raises(typer.TyperException, match="n must be above zero"), usage():
        raise ValueError("n must be above zero")
    assert not list(tmp_path.iterdir())


def test_the_page_names_what_missed_first(tmp_path: Path) -> None:
    page = drawn(tmp_path, GOOD, BAD, LOST)
    assert page.index("Checks that did not pass") < page.index("The turn")
    assert "The errors are against the exact curve: a sieve &lt;&amp;&gt;." in page
    assert "500000 (paper)" in page
    assert '<span class="badge FAIL">' in page
    cells = page.count('data-head="found"')  # rows that a phone stacks: those that missed twice
    assert cells == page.count('data-head="expected"') >= 4
    assert "Checks that did not pass" not in drawn(tmp_path, GOOD)


def test_words_of_a_check() -> None:
    assert sentence(GOOD) == "stress is 1.001, expected 1 within 0.01 of it (closed form)"
    assert sentence(BAD) == "shear stress is 0.2, expected at most 0.1 (symmetry)"
    lost = sentence(replace(LOST, failure=INVERTED))
    assert lost == "order: det F \N{LESS-THAN OR EQUAL TO} 0 at step 3: there is no number to hold against 2"
    assert digits(-0.7568024953) == "\N{MINUS SIGN}0.7568025"
    assert digits(2.3e-10) == "2.3e-10"


def test_rows_of_the_page() -> None:
    """Found beside expected with eight digits, what is allowed, and the miss where there is a distance from it."""
    rows = checks_table("turn", [GOOD, replace(GOOD, way="absolute"), BAD, replace(BAD, way="at_least")]).rows
    assert [row[2:6] for row in rows] == [
        ("1.001", "1", "± 0.01 of it", "0.001"),
        ("1.001", "1", "± 0.01", "0.001"),
        ("0.2", "0.1", "or less", ""),
        ("0.2", "0.1", "or more", ""),
    ]
    assert checks_table("all", [LOST], group=True).rows[0][:4] == ("shear", "order", "ERROR", "nan")


def test_the_closest_call() -> None:
    """The check that uses most of what it is allowed, bounds included; none where none is allowed anything."""
    far = replace(GOOD, name="far", found=1.009)
    bound = Check("turn", "bound", 0.095, 0.1, "at_most", "s")
    least = Check("turn", "least", 1.0, 0.1, "at_least", "s")
    assert closest([GOOD, far, least]).endswith("far")
    assert closest([GOOD, far, bound]) == "0.095, at most 0.1: bound"
    assert closest([least]) == "1, at least 0.1: least"
    assert closest([GOOD]) == "0.001 of 0.01: stress"
    assert closest([LOST, GOOD]) == "0.001 of 0.01: stress"
    assert closest([LOST]) == ""
    assert closest([Check("turn", "none", 0.0, 0.0, "at_most", "s")]) == ""


def test_the_document_has_what_came_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Document: its lead, its findings as codes with numbers, its parameters with where they come from."""
    study = stored(tmp_path, GOOD)
    record = Record(Store(tmp_path, "element"), study, {}, earlier=False)
    found = Analysis((), (GOOD,), ElementAnalysis({"soil": examination(GOOD)}))
    monkeypatch.setattr(Record, "analysis", found)
    told = json.loads(document(record, tmp_path, more_of(record)))["more"]["soil"]
    assert told["parameters"] == {"E [Pa]": "500000 (paper)", "rate": "jaumann"}
    assert told["findings"][0] == {"code": "objectivity.missed", "numbers": {"missed": 2, "checks": 30}, "group": ""}
    against = "The errors are against the exact curve: a sieve <&>."
    assert told["lead"] == f"2 of 30 checks did not pass; they stand first. {against}"


def test_notes_are_those_of_a_group() -> None:
    assert notes(examination(), "turn") == []
    particles, order = notes(examination(), "words")
    assert "shear stresses of up to 12 %" in particles
    assert order == "The order is 1.50."


# ---- the page again


def ask(words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> tuple[int, str, str]:
    monkeypatch.setattr("sys.argv", ["verify", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    return (int(ended.value.code or 0), *capsys.readouterr())


def test_report_makes_the_page_of_an_examination_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The page is found by the case of its study; what is stored is read, nothing runs."""
    run(tmp_path, GOOD, BAD)
    page = tmp_path / "out" / "report.html"
    first = page.read_bytes()
    page.unlink()
    monkeypatch.setattr("mpm_verify.cases.element.execute.execute", lambda *_: pytest.fail("computed"))
    capsys.readouterr()
    code, out, err = ask(["report", str(tmp_path / "out")], monkeypatch, capsys)
    assert (code, out, err) == (0, f"report: {page}\n", "")
    assert page.read_bytes() == first
    assert b"shear stress" in first


def test_report_of_a_folder_that_cannot_be_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A folder of another case, without any run, or broken: one line."""
    (run,) = stored(tmp_path, GOOD).runs
    study = tmp_path / "study.json"
    whole = study.read_bytes()
    study.write_bytes(whole.replace(b'"case": "element"', b'"case": "tea"', 1))
    said = {"tea": ask(["report", str(tmp_path)], monkeypatch, capsys)}
    study.write_text("{")
    said["broken"] = ask(["report", str(tmp_path)], monkeypatch, capsys)
    study.write_bytes(whole)
    (tmp_path / "runs" / f"{run.digest}.json").unlink()
    said["empty"] = ask(["report", str(tmp_path)], monkeypatch, capsys)
    for code, out, err in said.values():
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert err.startswith("verify: ")
    assert f"is of the case tea, and this version has {', '.join(available(CASES))}; use" in said["tea"][2]
    assert "run its study to the end" in said["empty"][2]
    assert "left as it is" in said["broken"][2]
