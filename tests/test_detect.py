"""The campaign of planted defects: data, copies, mutants, rates, the quoted certificate, each check failing once."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from mpm_verify.cases.detect import certificate
from mpm_verify.cases.detect.defect import KINDS, MAKERS, NONE, Defect, defects, replaced
from mpm_verify.cases.detect.mutate import files, mutant, mutants, sampled
from mpm_verify.cases.detect.plant import Planted
from mpm_verify.cases.detect.rates import Row, alone, rate, rates, redundant
from mpm_verify.cases.detect.run import CHECKS, JUDGES, Run
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.reports.sentences.detect import quote
from mpm_verify.solver.source_hash import TOP
from mpm_verify.verify.commands.detect import told_list
from mpm_verify.verify.detecting import checks, rule
from mpm_verify.verify.terminal import detect as terminal

ROW = Row("one", "cpdi", "order", "index", "solver/step.py", False, "", {})


def row(kind: str = "order", **changed: str) -> Row:
    return replace(ROW, kind=kind, changed=changed)


@pytest.mark.parametrize("one", [one for one in defects().values() if one.name != NONE], ids=lambda one: one.name)
def test_a_defect_can_be_planted(one: Defect) -> None:
    """Each old text stands in its file, what comes out is Python, and it is another program unless it is a placebo."""
    text = (TOP / one.file).read_text()
    planted = replaced(text, one)
    compile(planted, one.file, "exec")
    assert planted != text


def test_kinds_and_makers_have_names_of_their_own() -> None:
    """A rate of one would be told as that of the other: one of 46 in the judge was, as 1 of 1."""
    assert not set(KINDS) & set(MAKERS)
    assert {one.by for one in defects().values() if one.name != NONE} <= set(MAKERS)


def test_there_are_enough_defects() -> None:
    real = [one for one in defects().values() if one.kind != "placebo" and not one.equivalent]
    quiet = [one for one in defects().values() if one.kind == "placebo" and one.name != NONE]
    assert len(real) >= 150
    assert sum(not one.listed for one in real) >= len(real) / 2
    assert len(quiet) >= 20
    assert {method for one in real for method in one.methods} >= {"mpm", "cpdi", "cpdi2", "bspline2"}


def test_a_copy_is_sound_again_and_the_original_untouched(tmp_path: Path) -> None:
    one = defects()["hooke-zz-zero"]
    file = tmp_path / "mpm_verify" / one.file
    file.parent.mkdir(parents=True)
    original = (TOP / one.file).read_bytes()
    file.write_bytes(original)
    before = file.stat()
    with Planted(tmp_path, one):
        assert "sigma[4 * b + 2] = 0.0" in file.read_text()
        assert int(file.stat().st_mtime) != int(before.st_mtime)  # byte code of the sound file is not taken for it
    assert file.read_bytes() == original == (TOP / one.file).read_bytes()
    assert file.stat().st_mtime_ns == before.st_mtime_ns


def test_an_old_text_that_is_not_there_is_told() -> None:
    with pytest.raises(ValueError, match="does not hold its old text"):
        replaced("a = 1", Defect("one", "solver/step.py", "b", "c"))
    assert replaced("a a a", Defect("one", "f", "a", "b", at=2)) == "a a b"


def test_mutants_are_programs_and_stay_the_same() -> None:
    found = mutants("solver/boundary.py")
    assert {one.by for one in found} >= {"sign", "factor", "term", "bound", "arguments", "constant"}
    text = (TOP / "solver/boundary.py").read_text()
    for one in found:
        planted = replaced(text, one)
        compile(planted, one.file, "exec")
        assert planted != text
    assert mutant(found[3].name) == found[3]
    assert sampled(20, 5) == sampled(20, 5) != sampled(20, 6)
    assert not [file for file in files() if "detect" in file]
    with pytest.raises(ValueError, match="no mutant"):
        mutant("mutant:solver/boundary.py:100000")


def test_rates_have_the_intervals_of_tables() -> None:
    """Clopper & Pearson of 8 of 10, and of all of 20."""
    found = rate("one", [True] * 8 + [False] * 2)
    assert (found.low, found.high) == (pytest.approx(0.4439, abs=1e-4), pytest.approx(0.9748, abs=1e-4))
    assert rate("one", [True] * 20).low == pytest.approx(0.025 ** (1 / 20), abs=1e-9)
    assert rate("one", [True] * 20).high == 1.0


def test_rates_leave_placebos_and_equivalents_out() -> None:
    found = [row(exact="FAIL"), row(axis_aligned="INCONCLUSIVE"), row(), row("placebo", exact="FAIL")]
    found.append(replace(row(), equivalent="nothing changes"))
    named = {one.name: one for one in rates(found)}
    assert (named["all"].noticed, named["all"].total) == (2, 3)
    assert (named["as FAIL"].noticed, named["as FAIL"].total) == (1, 2)
    assert alone(found, "exact") == 1
    assert redundant([row(exact="FAIL", norms="FAIL")], ("exact", "norms", "rule")) == ("norms", "rule") or redundant(
        [row(exact="FAIL", norms="FAIL")], ("exact", "norms", "rule")
    ) == ("exact", "rule")


def test_runs_of_a_defect_of_one_method_have_that_method() -> None:
    case = case_named("detect")
    assert case.canonical({"defect": "mpm-round", "method": "cpdi"})["method"] == "mpm"
    assert case.canonical({"defect": "pic", "method": "bspline2"})["method"] == "bspline2"
    first, *_ = case.companions([Run("pic", "cpdi2")])
    assert (first.defect, first.method) == (NONE, "cpdi2")
    with pytest.raises(ValueError, match="no defect 'nothing'"):
        Run("nothing")


def test_another_change_is_another_run() -> None:
    assert Run("pic").digest != Run("move-dt").digest
    assert Run("pic").digest == Run("pic").digest


def test_the_certificate_is_quoted_with_what_was_missed() -> None:
    found = certificate.Certificate(
        "2026-01-02", "0" * 16, "a processor", ["cpdi"], 9, 9, 146, 150, 120, 140, 0, 20, 3, {}, ["a", "b"]
    )
    text = quote(found)
    assert "noticed 146 of 150 planted mistakes (cpdi); not: a, b." in text
    assert "0 of 20 placebos" in text
    assert "2026-01-02" in text
    assert "earlier state" in text


def test_the_document_has_the_numbers_of_the_certificate() -> None:
    kept = certificate.stored()
    assert kept is not None
    text = " ".join((TOP.parent / "docs" / "detect.md").read_text().split())
    noticed = f"{kept.copies} copies on an Intel Xeon: {kept.noticed} of {kept.planted} mistakes were noticed"
    assert f"{noticed} ({100 * kept.noticed / kept.planted:.0f} %" in text
    assert f"{kept.failed} of them with a FAIL, and none of {kept.placebos} placebos" in text
    assert kept.alarms == 0
    for name, words in {
        "order": "Of the mistakes in order", "listed": "of the listed ones", "not listed": "of the others",
        "judge": "of the judge", "mms --quick and exact": "`verify mms --quick` and `verify exact` alone noticed",
    }.items():  # fmt: skip
        k, n = (int(number) for number in kept.kinds[name][:2])
        assert f"{words} {k} of {n} ({100 * k / n:.0f} %)" in text
    missed = text.partition("| mistake | why |")[2].partition("Of 16 mutants")[0]
    assert {word.strip("`") for word in missed.split() if word.startswith("`")} == set(kept.missed)


def test_known_answers_are_given_and_each_part_can_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    assert rule.ask() == ("PASS", "")
    monkeypatch.setattr("mpm_verify.cases.judging.order.COUPLED", 1e9)
    assert rule.ask()[0] == "FAIL"
    monkeypatch.undo()
    monkeypatch.setattr("mpm_verify.cases.judging.fit.STEADY", 1.5)
    assert rule.ask()[0] == "FAIL"


@pytest.mark.parametrize("check", JUDGES)
def test_the_judge_is_sound(check: str, tmp_path: Path) -> None:
    """A check that fails on the sound package notices nothing."""
    assert checks.CHECKS[check](checks.Subject("cpdi", tmp_path, tmp_path, True)) == ("PASS", "")


def test_blind_needs_a_key(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mpm_verify", "detect", "--blind"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=TOP.parent, timeout=60)
    assert done.returncode == 2
    assert "--blind and --key FILE belong together" in done.stderr


def test_the_list_is_one_json_document_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert told_list(json_output=True) == 0
    assert [one["name"] for one in json.loads(capsys.readouterr().out)] == list(defects())


@pytest.mark.slow
def test_a_crash_a_hang_and_a_defect_are_caught_and_a_placebo_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """Copies of their own: the judge's checks alone, which take a second each."""
    from mpm_verify.cases.detect import workshop

    asked = workshop.workshop().ask(defects()["exit-code"], "cpdi", ("rule", "norms"))
    assert {one.check: one.outcome for one in asked.answers} == {"rule": "FAIL", "norms": "PASS"}
    asked = workshop.workshop().ask(defects()["placebo-logs"], "cpdi", ("rule",))
    assert [one.outcome for one in asked.answers] == ["PASS"]
    crash = Defect("crash", "cases/judging/fit.py", "STEADY = 0.15", "STEADY = 0.15\nimport os\nos.abort()")
    assert workshop.workshop().ask(crash, "cpdi", ("rule",)).ended == "crash"
    monkeypatch.setattr(workshop, "SECONDS", 4)
    hang = replace(crash, new="STEADY = 0.15\nwhile True:\n    pass")
    assert workshop.workshop().ask(hang, "cpdi", ("rule",)).ended == "hang"
    assert workshop.workshop().ask(defects()[NONE], "cpdi", ("rule",)).answers[0].outcome == "PASS"


def test_the_checks_are_those_that_a_child_has() -> None:
    from mpm_verify.verify.detecting.checks import CHECKS as THERE

    assert set(CHECKS["full"]) == set(THERE)
    assert set(CHECKS["quick"]) < set(THERE)
    json.dumps(list(CHECKS["full"]))


@pytest.mark.parametrize("count", [1, 40])
def test_few_defects_are_told_one_by_one(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []
    monkeypatch.setattr(terminal.checks, "show", lambda record, page, lead: told.append(lead))
    rows = [Row(NONE, "cpdi", "placebo", "", "", False, "", {})]
    rows += [Row(f"one-{i}", "cpdi", "order", "index", "f", True, "", {"exact": "FAIL"}) for i in range(count)]
    record = SimpleNamespace(analysis=SimpleNamespace(more=SimpleNamespace(rows=rows)))
    terminal.show(cast(Any, record), None)
    assert told == (["one-0, cpdi: exact FAIL"] if count == 1 else [""])


@pytest.mark.slow
def test_a_campaign_that_was_killed_goes_on_and_says_the_same(tmp_path: Path) -> None:
    """What was stored before the kill stays as it is, and the outcomes are those of a campaign that ran through."""
    names = ("none", "exit-code", "rise-not-seen", "placebo-logs")
    command = [sys.executable, "-m", "mpm_verify", "detect", "--defect", ",".join(names), "--checks", "quick"]

    def outcomes(folder: Path) -> dict[str, Any]:
        found = [json.loads(file.read_text()) for file in sorted((folder / "runs").glob("*.json"))]
        return {one["run"]["defect"]: (one["outcomes"], one["evidence"]) for one in found}

    through, killed = tmp_path / "through", tmp_path / "killed"
    done = subprocess.run([*command, "--out", str(through)], capture_output=True, text=True, timeout=900)
    assert done.returncode in (0, 1), done.stderr
    with subprocess.Popen(
        [*command, "--out", str(killed)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    ) as going:
        while not (first := list((killed / "runs").glob("*.json"))) and going.poll() is None:
            time.sleep(0.05)
        os.killpg(going.pid, signal.SIGKILL)
    assert len(outcomes(killed)) < len(names)
    written = {file: file.stat().st_mtime_ns for file in first}
    again = subprocess.run([*command, "--out", str(killed)], capture_output=True, text=True, timeout=900)
    assert again.returncode == done.returncode
    assert {file: file.stat().st_mtime_ns for file in first} == written
    assert outcomes(killed) == outcomes(through)
    assert {name: told[0]["rule"] for name, told in outcomes(through).items()} == {
        "none": "PASS", "exit-code": "FAIL", "rise-not-seen": "FAIL", "placebo-logs": "PASS",
    }  # fmt: skip
