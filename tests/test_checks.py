"""Checks and examinations: each way of a check, what is stored and read again, and what the command makes of it."""

import json
from dataclasses import replace
from math import inf, nan
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from mpm_verify.verify.examine import closest, conduct, document, sentence

from mpm_verify.cases.harness.checks import Check, Examination, Remark, load, save
from mpm_verify.cases.harness.store import StoreError
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.reports.components.examined import Section, checks_table, digits, render
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.sentences.remarks import notes
from mpm_verify.verify.main import main

CURVES = {"run/block of 1 m": {"t": np.linspace(0, 1, 5), "xx": np.arange(5.0)}, "exact": {"t": np.zeros(0)}}
FINDINGS = (
    Remark("objectivity.missed", {"missed": 2, "checks": 30}),
    Remark("element.against", {"source": "a sieve <&>"}),
    Remark("objectivity.particles", {"largest": 0.123}, "words"),
    Remark("element.order", {"order": 1.5}, "words"),
)
GOOD = Check("turn", "stress", 1.001, 1.0, "relative", "closed form", 0.01)
BAD = Check("turn", "shear stress", 0.2, 0.1, "at most", "symmetry")
LOST = Check("shear", "order", nan, 2.0, "absolute", "leading term", 0.1)


def examination(*checks: Check, name: str = "objectivity") -> Examination:
    return Examination(
        name, "A turn", "verify objectivity", FINDINGS, checks, {"E [Pa]": 5e5, "rate": "jaumann"},
        {"E [Pa]": "objectivity.paper"}, {"python": "3"}, CURVES,
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
        ("at least", 0.2, 0.1, 0.0, "PASS", 0.1),
        ("at least", 0.1, 0.1, 0.0, "PASS", 0.0),
        ("at least", 0.05, 0.1, 0.0, "FAIL", 0.05),
        ("at most", 0.05, 0.1, 0.0, "PASS", 0.05),
        ("at most", 0.1, 0.1, 0.0, "PASS", 0.0),
        ("at most", 0.2, 0.1, 0.0, "FAIL", 0.1),
    ],
)
def test_ways(way: Any, found: float, expected: float, within: float, outcome: str, miss: float) -> None:
    check = Check("g", "n", found, expected, way, "s", within)
    assert check.outcome == outcome
    assert check.miss == pytest.approx(miss, abs=1e-12)


@pytest.mark.parametrize("way", ["relative", "absolute", "at least", "at most"])
@pytest.mark.parametrize("found", [nan, inf, -inf])
def test_no_number_is_an_error(way: Any, found: float) -> None:
    assert Check("g", "n", found, 0.1, way, "s", 1.0).outcome is Outcome.ERROR


def test_the_worst_check_is_the_outcome() -> None:
    assert examination().outcome is Outcome.INCONCLUSIVE
    assert examination(GOOD).outcome is Outcome.PASS
    assert examination(GOOD, BAD).outcome is Outcome.FAIL
    assert examination(LOST, BAD, GOOD).outcome is Outcome.ERROR
    assert examination(LOST, BAD, GOOD).groups == ("shear", "turn", "words")


# ---- the store


def test_round_trip(tmp_path: Path) -> None:
    """Bit for bit, NaN and infinity included; a second time over the first."""
    kept = examination(GOOD, BAD, replace(BAD, found=np.float64(1 / 3), expected=inf))
    for _ in range(2):
        save(tmp_path / "a" / "b", kept)
        read = load(tmp_path / "a" / "b")
        assert read == kept
        assert {name: list(curve) for name, curve in read.curves.items()} == {k: list(c) for k, c in CURVES.items()}
        for name, curve in CURVES.items():
            for column, values in curve.items():
                np.testing.assert_array_equal(read.curves[name][column], values)
    assert sorted(path.name for path in (tmp_path / "a" / "b").iterdir()) == ["curves.npz", "examination.json"]
    save(tmp_path, examination(LOST))
    assert np.isnan(load(tmp_path).checks[0].found)
    assert load(tmp_path).outcome is Outcome.ERROR


BROKEN = {
    "empty": ("examination.json", b""),
    "cut off": ("examination.json", b'{"format": 2, "name": "objec'),
    "no object": ("examination.json", b"[1]"),
    "no text": ("examination.json", b"\xff\xfe\x00"),
    "another format": ("examination.json", b'{"format": 99}'),
    "a way that is none": ("examination.json", None),
    "curves cut off": ("curves.npz", b"PK\x03\x04 and no more"),
    "curves of something else": ("curves.npz", b"hello"),
}


@pytest.mark.parametrize("what", BROKEN)
def test_a_broken_file_is_one_line_and_stays(what: str, tmp_path: Path) -> None:
    save(tmp_path, examination(GOOD))
    name, content = BROKEN[what]
    whole = (tmp_path / "examination.json").read_bytes()
    content = whole.replace(b'"relative"', b'"about"') if content is None else content
    (tmp_path / name).write_bytes(content)
    with pytest.raises(StoreError) as told:
        load(tmp_path)
    assert "\n" not in str(told.value)
    assert str(tmp_path) in str(told.value)
    assert ("format 99" if what == "another format" else "left as they are") in str(told.value)
    assert (tmp_path / name).read_bytes() == content


def test_empty_curves_are_one_line(tmp_path: Path) -> None:
    save(tmp_path, examination(GOOD))
    (tmp_path / "curves.npz").write_bytes(b"")
    with pytest.raises(StoreError, match="left as they are"):
        load(tmp_path)


@pytest.mark.parametrize("name", ["examination.json", "curves.npz"])
def test_a_missing_file_is_named(name: str, tmp_path: Path) -> None:
    save(tmp_path, examination(GOOD))
    (tmp_path / name).unlink()
    with pytest.raises(StoreError, match=f"holds no examination: {name} is missing"):
        load(tmp_path)


# ---- the command


def drawn(folder: Path, found: Examination) -> Path:
    """A page of the words and the checks alone."""

    def sections(found: Examination, add: Add) -> list[Section]:
        return [Section("turn", "The turn", ("Words.",), (), [checks_table("turn", found.checks)])]

    return render(folder, found, sections)


def run(tmp_path: Path, *checks: Check, as_json: bool = False, junit: Path | None = None) -> int:
    return conduct(lambda: examination(*checks), drawn, tmp_path / "out", as_json, junit)


@pytest.mark.parametrize(
    ("checks", "code"),
    [((GOOD,), 0), ((GOOD, BAD), 1), ((GOOD, LOST), 1), ((), 3)],
    ids=["pass", "fail", "error", "none"],
)
def test_exit_codes_and_what_is_printed(
    checks: tuple[Check, ...], code: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, *checks) == code
    out = capsys.readouterr().out
    words = " ".join(out.split())
    assert "A turn" in out
    assert "2 of 30 checks did not pass; they stand first. Errors are against: a sieve <&>." in words
    assert out.rstrip().endswith("report.html")
    assert ("FAIL turn: shear stress is 0.2, expected at most 0.1 (symmetry)" in words) == (BAD in checks)
    assert ("ERROR shear: order is nan, expected 2 within 0.1 (leading term)" in words) == (LOST in checks)
    assert (tmp_path / "out" / "tables" / "checks.csv").read_text().count("\n") == len(checks) + 1 or not checks


def strict(constant: str) -> None:
    raise AssertionError(f"{constant} is no JSON")


def test_json_has_no_nan_and_junit_every_check(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    junit = tmp_path / "new" / "checks.xml"
    infinite = replace(GOOD, name="lost", found=inf)
    assert run(tmp_path, GOOD, BAD, LOST, infinite, as_json=True, junit=junit) == 1
    told = json.loads(capsys.readouterr().out, parse_constant=strict)
    assert (told["examination"], told["outcome"], told["version"]) == ("objectivity", "ERROR", 1)
    assert [check["outcome"] for check in told["checks"]] == ["PASS", "FAIL", "ERROR", "ERROR"]
    assert [check["found"] for check in told["checks"]] == [1.001, 0.2, None, None]
    assert Path(told["report"]).exists()
    suite = ElementTree.parse(junit).getroot()
    assert suite.attrib == {"name": "objectivity", "tests": "4", "errors": "2", "failures": "1"}
    assert [case.attrib["classname"] for case in suite] == ["objectivity.turn"] * 2 + [
        "objectivity.shear",
        "objectivity.turn",
    ]
    assert [[child.tag for child in case] for case in suite] == [[], ["failure"], ["error"], ["error"]]


def test_what_is_wrong_with_the_input_is_one_line(tmp_path: Path) -> None:
    """Before anything is computed."""
    import typer

    with pytest.raises(typer.TyperException, match="cannot write --junit"):
        conduct(lambda: pytest.fail("computed"), drawn, tmp_path, junit=tmp_path)

    def refused() -> Examination:
        raise ValueError("n must be above zero")

    with pytest.raises(typer.TyperException, match="n must be above zero"):
        conduct(refused, drawn, tmp_path)
    assert not list(tmp_path.iterdir())


def test_the_page_names_what_missed_first(tmp_path: Path) -> None:
    run(tmp_path, GOOD, BAD, LOST)
    page = (tmp_path / "out" / "report.html").read_text()
    assert page.index("Checks that did not pass") < page.index("The turn")
    assert "Errors are against: a sieve &lt;&amp;&gt;." in page
    assert "500000 (paper)" in page
    run(tmp_path, GOOD)
    assert "Checks that did not pass" not in (tmp_path / "out" / "report.html").read_text()


def test_words_of_a_check() -> None:
    assert sentence(GOOD) == "stress is 1.001, expected 1 within 0.01 of it (closed form)"
    assert sentence(BAD) == "shear stress is 0.2, expected at most 0.1 (symmetry)"
    assert digits(-0.7568024953) == "\N{MINUS SIGN}0.7568025"
    assert digits(2.3e-10) == "2.3e-10"


def test_rows_of_the_page() -> None:
    """Found beside expected with eight digits, what is allowed, and the miss where there is a distance from it."""
    rows = checks_table("turn", [GOOD, replace(GOOD, way="absolute"), BAD, replace(BAD, way="at least")]).rows
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
    bound = Check("turn", "bound", 0.095, 0.1, "at most", "s")
    least = Check("turn", "least", 1.0, 0.1, "at least", "s")
    assert closest([GOOD, far, least]).endswith("far")
    assert closest([GOOD, far, bound]) == "0.095, at most 0.1: bound"
    assert closest([least]) == "1, at least 0.1: least"
    assert closest([GOOD]) == "0.001 of 0.01: stress"
    assert closest([LOST, GOOD]) == "0.001 of 0.01: stress"
    assert closest([LOST]) == ""
    assert closest([Check("turn", "none", 0.0, 0.0, "at most", "s")]) == ""


def test_document_is_of_the_examination_alone(tmp_path: Path) -> None:
    told = json.loads(document(examination(GOOD), tmp_path))
    assert told["parameters"] == {"E [Pa]": "500000 (paper)", "rate": "jaumann"}
    assert told["findings"][0] == {"code": "objectivity.missed", "numbers": {"missed": 2, "checks": 30}, "group": ""}
    assert told["lead"] == "2 of 30 checks did not pass; they stand first. Errors are against: a sieve <&>."


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


@pytest.mark.parametrize(
    ("name", "module"), [("objectivity", "objectivity_page"), ("material-ubcsand", "material_page")]
)
def test_report_makes_the_page_of_an_examination_again(
    name: str, module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """By its name; what is stored is read, nothing runs."""
    from types import ModuleType

    asked: list[Examination] = []

    def page(folder: Path, found: Examination) -> Path:
        asked.append(found)
        return drawn(folder, found)

    fake = ModuleType(f"reports.{module}")
    fake.page = page  # type: ignore[attr-defined]
    monkeypatch.setitem(__import__("sys").modules, fake.__name__, fake)
    save(tmp_path, examination(GOOD, name=name))
    code, out, err = ask(["report", str(tmp_path)], monkeypatch, capsys)
    assert (code, out, err) == (0, f"report: {tmp_path / 'report.html'}\n", "")
    assert asked == [examination(GOOD, name=name)]


def test_report_of_an_examination_that_cannot_be_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of another kind, without its curves, or broken: one line."""
    save(tmp_path, examination(GOOD, name="tea"))
    said = {"tea": ask(["report", str(tmp_path)], monkeypatch, capsys)}
    save(tmp_path, examination(GOOD))
    said["curves"] = ask(["report", str(tmp_path)], monkeypatch, capsys)
    (tmp_path / "examination.json").write_text("{")
    said["broken"] = ask(["report", str(tmp_path)], monkeypatch, capsys)
    for code, out, err in said.values():
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert err.startswith("verify: ")
    assert "must be of objectivity, material" in said["tea"][2]
    assert "run it again" in said["curves"][2]
    assert "left as they are" in said["broken"][2]
