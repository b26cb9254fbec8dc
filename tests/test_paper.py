"""Ledger of the paper on made up Results: statuses by rules, readings, registered rows, and that nothing is typed."""

import json
import re
import shutil
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import fixtures_paper
import pytest

from mpm_verify.reports.export import paper as writing
from mpm_verify.reports.paper import registered
from mpm_verify.reports.paper.evidence import Evidence, below
from mpm_verify.reports.paper.ledger import claims, entry, ledger, readings, usual
from mpm_verify.reports.paper.records import Answer, Chosen, Claim, Entry, NotStoredError, Status
from mpm_verify.reports.paper.rules import RULES
from mpm_verify.reports.paper.studies import chosen, studies


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("paper")
    fixtures_paper.store(made)
    return made


@pytest.fixture(scope="module")
def found(folder: Path) -> dict[str, Entry]:
    return {one.claim.id: one for one in ledger(below(folder))}


def nothing(study: str) -> Any:
    raise NotStoredError(study)


def test_status_is_made_of_parts() -> None:
    assert Answer({"a": True, "b": True}).status is Status.HOLDS
    assert Answer({"a": True, "b": None}).status is Status.IN_PART
    assert Answer({"a": True, "b": False}).status is Status.IN_PART
    assert Answer({"a": False, "b": None}).status is Status.NO
    assert Answer({"a": None}).status is Status.OPEN


def test_the_ledger_of_data_is_whole() -> None:
    """46 claims, each with a rule or outside of what is run; each names studies and readings that there are."""
    each, known = claims(), {one.id for one in readings()}
    assert len(each) == len({one.id for one in each}) == 46
    assert {one.id for one in each if one.id not in RULES} == {"Z2"}
    assert set(RULES) <= {one.id for one in each}
    for one in each:
        assert set(one.studies) <= set(studies()), one.id
        assert bool(one.studies) == (one.id in RULES), one.id
        assert set(one.readings) <= known, one.id
    keys = [one.key for one in readings() if one.key]
    assert len(keys) == len(set(keys)) == len(usual()) == 8
    assert set().union(*({one.name, *one.parts} for one in studies().values())) >= set("12345678")


@pytest.mark.parametrize("name", RULES)
def test_no_rule_answers_without_a_result(name: str) -> None:
    """A number or status that no Result gives would be typed."""
    with pytest.raises(NotStoredError):
        RULES[name](Evidence(nothing), usual())


def test_a_typed_number_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The check above can fail."""
    monkeypatch.setitem(RULES, "F2", lambda seen, at: Answer({"typed": True}, {"order of u": 2.0}))
    assert entry(claims()[1], Evidence(nothing)).status is Status.HOLDS
    with pytest.raises(pytest.fail.Exception):
        test_no_rule_answers_without_a_result("F2")


def test_what_is_not_stored_is_not_run() -> None:
    each = Counter(one.status for one in ledger(Evidence(nothing)))
    assert each == {Status.NOT_RUN: 45, Status.OPEN: 1}
    assert not any(one.numbers or one.parts for one in ledger(Evidence(nothing)))


@pytest.mark.parametrize(
    ("name", "status", "number", "value"),
    [
        ("F1", "holds", "force of mpm over stress and area", 0.55),
        ("F7", "no", "order in rms", 2.0),
        ("F8", "no", "that fail", 2),
        ("F9", "in part", "order of MPM, 4 per cell, pair 1", -0.5),
        ("F14", "in part", "order of u", 2.0),
        ("F21", "no", "that pass", 4),
        ("C3", "open", "finest cell, mm", 9.05),
        ("C8", "in part", "front_99, 1 per cell [m]", 0.72),
        ("C12", "in part", "over the band, aspect 9", 0.0),
        ("C13", "holds", "front_99, 10 % damping [m]", 0.749),
        ("C14", "holds", "order at 5 %", 0.0),
        ("U6", "in part", "apart", -0.06 / 0.799),
    ],
)
def test_statuses_and_numbers_are_those_of_the_results(
    found: dict[str, Entry], name: str, status: str, number: str, value: float
) -> None:
    one = found[name]
    assert one.status == status, one
    if name == "C12":
        assert one.numbers[number] > one.numbers["over the band, aspect 3"]
    else:
        assert one.numbers[number] == pytest.approx(value, abs=1e-9), one.numbers


def test_direction_and_nearness_are_apart(found: dict[str, Entry]) -> None:
    assert found["U6"].parts == {"direction": True, "nearness": False}
    assert found["C12"].parts == {"direction": True, "nearness": False}


def test_crowded_runs_carry_their_warning(found: dict[str, Entry]) -> None:
    assert found["C8"].crowded == {"1 per cell": 2.0}
    assert not found["C13"].crowded
    assert "Warning" in writing.markdown("quick", [found["C8"]], [])


def test_a_reading_changes_what_hangs_on_it_and_nothing_else(found: dict[str, Entry], folder: Path) -> None:
    """Every rule is asked anew with one value changed: only those that look at it may change, and some do."""
    seen, of = below(folder), {one.key: one for one in readings() if one.key}
    for key, reading in of.items():
        changed = set()
        for value in reading.others:
            for name, rule in RULES.items():
                at = Chosen(usual() | {key: value})
                try:
                    now: Any = rule(seen, at)
                except NotStoredError:
                    now = replace(found[name], status=Status.NOT_RUN, parts={})
                if (now.status, now.parts) != (found[name].status, found[name].parts):
                    changed.add(name)
                    assert key in at.asked, name
                    assert reading.id in found[name].hangs, (name, value)
        assert changed, f"nothing hangs on {key}"
        assert changed == {name for name, one in found.items() if reading.id in one.hangs}


def test_readings_that_rules_look_at_are_written_down(found: dict[str, Entry]) -> None:
    ids = {one.key: one.id for one in readings() if one.key}
    for name, one in found.items():
        tried = {reading for reading in one.claim.readings if reading in ids.values()}
        assert {ids[key] for key in one.asked} == tried, name


def test_registered_rows(found: dict[str, Entry], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What is registered has not changed; a status, one under another reading, and a number may, each by itself."""
    monkeypatch.setattr(registered, "FOLDER", tmp_path)
    each = list(found.values())
    assert registered.registered("quick") == {}
    registered.register(each, "quick")
    rows = registered.registered("quick")
    assert registered.changes(each, rows, complete=True) == []

    def changed(name: str, **more: Any) -> list[tuple[str, str]]:
        now = [replace(one, **more) if one.claim.id == name else one for one in each]
        return [(one.claim, one.what) for one in registered.changes(now, rows, complete=True)]

    assert changed("F2", status=Status.NO) == [("F2", "status")]
    assert changed("F2", numbers={"order of u": 2.0 * (1 + 1e-5)}) == [("F2", "order of u")]
    assert changed("F2", numbers={"order of u": 2.0 * (1 + 1e-8)}) == []
    front = dict(found["C10"].numbers)
    assert changed("C10", numbers={name: value + 0.01 for name, value in front.items()}) == []
    assert changed("C10", numbers={name: value + 0.03 for name, value in front.items()}) == [("C10", *front)]
    assert changed("C10", numbers={}) == [("C10", *front)]
    assert changed("F13", numbers={"time of cpdi over MPM's": 100.0}) == []
    under = found["F19"].under
    assert changed("F19", under=(replace(under[0], status=Status.NO), *under[1:])) == [("F19", "status under R5 1 m")]
    gone = [replace(one, status=Status.NOT_RUN, numbers={}, under=()) for one in each]
    assert registered.changes(gone, rows, complete=False) == []
    assert len({one.claim for one in registered.changes(gone, rows, complete=True)}) == 46


def test_the_files(found: dict[str, Entry], tmp_path: Path) -> None:
    each = list(found.values())
    paths = writing.write(tmp_path, "quick", each, [registered.Change("F2", "status", "holds", "no")])
    data = json.loads((tmp_path / "ledger.json").read_text())
    assert [path.name for path in paths] == ["ledger.json", "ledger.csv", "ledger.md"]
    assert sum(data["counts"].values()) == len(data["claims"]) == 46
    lines = (tmp_path / "ledger.csv").read_text().splitlines()
    assert len(lines) == 47
    text = (tmp_path / "ledger.md").read_text()
    assert "F2, status: registered holds, found no" in text
    assert all(f"## {name}\n" in text for name in found)


def test_parts_of_the_paper() -> None:
    assert [one.name for one in chosen("8")] == ["figure8", "ubcsand"]
    assert [one.name for one in chosen("3, 2")] == ["figure2", "figure3"]
    assert len(chosen("")) == len(studies())
    with pytest.raises(ValueError, match=r"--only '9' is no part.*choose from 1, 2, 3"):
        chosen("9")


def test_a_run_that_another_study_holds_is_taken(folder: Path, tmp_path: Path) -> None:
    """The run of Figure 3 is one of Figure 4."""
    from mpm_verify.cases.harness.store import Store
    from mpm_verify.verify.paper_studies import shared

    shutil.copytree(folder / "figure4", tmp_path / "figure4")
    study = studies()["figure3"].build("quick", "verify paper")
    shared(study, tmp_path)
    mine = Store(tmp_path / "figure3", "column")
    assert mine.get(study.runs[0].digest) == Store(folder / "figure3", "column").get(study.runs[0].digest)
    assert len(mine.arrays(study.runs[0].digest)) > 4


def test_a_claim_without_a_rule_is_open(folder: Path) -> None:
    assert entry(Claim("X", "", "", ""), below(folder)).status is Status.OPEN


def test_a_study_that_changed_is_not_run(folder: Path, tmp_path: Path) -> None:
    """A Result that is gone takes its claims with it, and no others."""
    for name in ("figure2", "figure8"):
        shutil.copytree(folder / name, tmp_path / name)
    next((tmp_path / "figure8" / "runs").glob("*.json")).unlink()
    seen = {one.claim.id: one.status for one in ledger(below(tmp_path))}
    assert seen["F15"] is Status.HOLDS
    assert {seen[name] for name in ("U3", "U4", "U5", "U6", "U7")} == {Status.NOT_RUN}


def test_runs_that_failed_answer_nothing(tmp_path: Path) -> None:
    """Where every run ends early no claim holds but those that the failure itself answers, and no rule breaks."""
    fixtures_paper.store(tmp_path, fixtures_paper.failed)
    each = ledger(below(tmp_path))
    assert {one.status for one in each} <= {Status.OPEN, Status.NO}
    assert {one.claim.id for one in each if one.status is Status.NO} == {"F5", "F8"}
    text = writing.markdown("quick", each, [])
    assert "open**: the study figure4 has no runs that came to their end" in text


def test_exit_codes(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    """3 where nothing is registered, 0 as registered whatever holds, 1 where a stored number is another."""
    from mpm_verify.verify.commands.paper import told

    monkeypatch.setattr(registered, "FOLDER", tmp_path / "rows")
    shutil.copytree(folder / "rotation", tmp_path / "rotation")
    wanted = chosen("rotation")
    assert told(tmp_path, "quick", wanted, register=False, json_output=False) == 3
    assert "Nothing is registered" in capsys.readouterr().out
    assert told(tmp_path, "quick", wanted, register=True, json_output=False) == 0
    assert "Of 3 claims that are registered, none changed." in capsys.readouterr().out
    for path in (tmp_path / "rotation" / "runs").glob("*.json"):
        data = json.loads(path.read_text())
        data["errors"]["u"]["rms"] *= 1.5 if data["run"]["cells"] == 32 else 1.0
        path.write_text(json.dumps(data))
    assert told(tmp_path, "quick", wanted, register=False, json_output=True) == 1
    changed = json.loads(capsys.readouterr().out)["changes"]
    assert {(one["claim"], one["what"]) for one in changed} == {
        ("F2", "status"), ("F2", "order of u"), ("F4", "status"), ("F4", "order of u"),
    }  # fmt: skip
    page = (tmp_path / "index.html").read_text()
    assert "Changed against what is registered" in page


def test_the_page(folder: Path, found: dict[str, Entry], tmp_path: Path) -> None:
    """A card a claim, its warning, what it hangs on, and links only to pages that are there."""
    from mpm_verify.reports.pages._paper import page

    (tmp_path / "figure4").mkdir()
    (tmp_path / "figure4" / "report.html").write_text("")
    text = page(tmp_path, "quick", list(found.values()), []).read_text()
    assert all(f'id="{name}"' in text for name in (*found, *(one.id for one in readings())))
    assert text.count("<strong>Warning.</strong>") == sum(bool(one.crowded) for one in found.values()) > 2
    assert '<a href="figure4/report.html">' in text
    assert '<a href="figure5/report.html">' not in text
    assert '<a href="#R5">R5</a>' in text


@pytest.mark.slow
def test_a_small_part_runs_and_is_as_registered(tmp_path: Path) -> None:
    """The rows that ship are those of the installed solver; what is stored is not run again."""
    from mpm_verify.solver.source_hash import TOP

    command = [sys.executable, "-m", "mpm_verify", "paper", "--quick", "--only", "cell_crossing,rotation",
               "--jobs", "1", "--out", str(tmp_path)]  # fmt: skip
    first, again = (subprocess.run(command, capture_output=True, text=True, cwd=TOP, timeout=600) for _ in range(2))
    assert first.returncode == 0, first.stdout + first.stderr
    assert "cell_crossing, 2 to run, 0 stored" in first.stderr
    assert "Of 4 claims that are registered, none changed." in first.stdout
    assert "2 of 2, all stored: cell_crossing, 0 to run, 2 stored" in again.stderr
    assert again.stdout == first.stdout


def test_figures_are_as_wide_as_a_column_and_their_data_are_what_is_drawn(folder: Path, tmp_path: Path) -> None:
    """A narrow figure and a wide one; their PDF has TrueType letters, and its page is so wide."""
    import pandas as pd

    from mpm_verify.reports.figures.paper import FIGURES, write
    from mpm_verify.reports.frames import read

    for number, width in ((4, 84.0), (6, 174.0)):
        one = FIGURES[number - 1]
        record = read(folder / one.study)
        paths = write(one, record, tmp_path)
        assert [path.name for path in paths] == [f"figure{number}.{kind}" for kind in ("pdf", "svg", "png", "csv")]
        pdf = paths[0].read_bytes()
        box = re.search(rb"/MediaBox \[ ?0 0 ([0-9.]+)", pdf)
        assert box
        assert float(box[1]) / 72 * 25.4 == pytest.approx(width, abs=0.1)
        assert b"/Type3" not in pdf
        assert b"/TrueType" in pdf or b"/CIDFontType2" in pdf
        data = pd.read_csv(paths[3])
        assert data["series"].nunique() == len(record.study.runs)
    kinetic = data[data["series"] == "no damping"].iloc[:, -1].dropna()
    assert kinetic.max() == pytest.approx(100 / 480, rel=1e-6)


def test_a_figure_without_runs_that_ended_is_left_out(tmp_path: Path) -> None:
    from mpm_verify.cases.harness.store import Store
    from mpm_verify.reports.figures.paper import write_all

    study = studies()["figure8"].build("quick", "verify paper")
    into = Store(tmp_path / "figure8", "column")
    into.create(study)
    assert write_all(tmp_path, below(tmp_path)) == {}
    for run in study.runs:
        into.put(*fixtures_paper.failed(run))
    assert write_all(tmp_path, below(tmp_path)) == {}


def test_tables_are_the_parameters_that_runs_had(folder: Path, tmp_path: Path) -> None:
    first, second = writing.tables(tmp_path, below(folder))
    assert "\nphi,31.0\n" in first.read_text()
    assert "\nheight,0.6335\n" in first.read_text()
    assert second.read_text() == "parameter,value\nRf,0.77\n"
