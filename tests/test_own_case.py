"""A case in a user's file: store, order rule, replicates, tables, page and JSON come with it, as with those here."""

import json
from math import pi
from pathlib import Path

import pytest
from fixtures_command import Call, caller, one_line

CASE = '''"""The midpoint rule for the integral of sin over a quarter of its period, which is 1."""

from dataclasses import dataclass
from math import pi, sin

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis
from mpm_verify.cases.judging.records import Expectation

QUANTITIES, NORMS, JUDGED = ("integral",), ("relative",), (("integral", "relative"),)
AXES = {"cells": (8, 16, 32, 64)}


@dataclass(frozen=True)
class Run(RunRecord):
    method: str = axis("midpoint", "The rule.")
    cells: int = axis(8, "Intervals.")
    ppc: int = axis(1, "Points an interval.")
    courant: float = axis(1.0, "Not used by a rule without time.")
    weight: float = axis(1.0, "Weight of the first interval.")
    offset: tuple[float, float] = axis((0.0, 0.0), "Not used.")

    def __str__(self):
        return f"{self.cells} cells"


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    run: Run


def title(runs):
    return "Midpoint rule"


def expectation(run, quantity, norm):
    return Expectation(2.0, source="the remainder of the midpoint rule")


def execute(run, tick):
    h = pi / 2 / run.cells
    values = [h * sin((k + 0.5) * h) for k in range(run.cells)]
    error = abs(sum(values) + (run.weight - 1) * values[0] - 1)
    return Result(run=run, digest=run.digest, status="finished", errors={"integral": {"relative": error}}), {}
'''


FILE = "midpoint.py"


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """The command, in the folder that has the file of the case."""
    (tmp_path / FILE).write_text(CASE)
    return caller(monkeypatch, capsys, tmp_path)


def test_judged_stored_and_shown(run: Call) -> None:
    code, out, _ = run("./midpoint.py", "--json")
    document = json.loads(out)
    assert (code, document["case"], document["outcome"]) == (0, "midpoint", "PASS")
    assert document["verdicts"][0]["observed"] == pytest.approx(2.0, abs=0.01)
    errors = [one["errors"]["integral"]["relative"] for one in document["runs"]]
    assert errors[0] == pytest.approx((pi / 16) ** 2 / 24, rel=0.01)
    folder = Path("results/midpoint-midpoint")
    assert len(list((folder / "runs").glob("*.json"))) == len(errors) == 5  # the finest with half the time step too
    assert run("report", str(folder))[0] == 0
    assert "Midpoint rule" in (folder / "report.html").read_text()


def test_any_field_is_an_axis(run: Call) -> None:
    """Without the first interval the error is h sin(h / 2), of first order in h^2 as well, and 12 times as large."""
    _, out, _ = run("./midpoint.py", "--weight", "1,0", "--json")
    runs = json.loads(out)["runs"]
    found = {(one["weight"], one["cells"]): one["errors"]["integral"]["relative"] for one in runs}
    assert found[0.0, 64] / found[1.0, 64] == pytest.approx(11, rel=0.01)  # h^2 / 2 - h^2 / 24


def test_an_edit_is_another_run(run: Call) -> None:
    run("./midpoint.py", "--json", "--out", "study")
    before = {path.name for path in Path("study/runs").glob("*.json")}
    Path(FILE).write_text(CASE.replace("k + 0.5", "k + 0.25"))
    code, out, _ = run("./midpoint.py", "--json", "--out", "study")
    after = {path.name for path in Path("study/runs").glob("*.json")}
    assert (len(before), len(after - before)) == (5, 5)
    assert (code, json.loads(out)["outcome"]) == (1, "FAIL")


def test_workers_take_it_too(run: Call) -> None:
    Path(FILE).write_text(CASE + "\n\nRun.cost = property(lambda run: 1e9)\n")
    assert run("./midpoint.py", "--json", "--jobs", "2")[0] == 0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x = 1\n", "has no Run, no Result, no title, no execute"),
        (CASE.replace("def title", "def other"), "has no title; a case has Run, Result, title and execute"),
        (CASE.replace("class Result(ResultRecord[Run])", "class Result"), "Result must be a class below ResultRecord"),
        ("from mpm_verify.cases.wave_bar.run import Run, Result\ntitle = execute = print\n", "defined in this file"),
        (CASE.replace("    ppc: int", "    points: int"), "refines, and its Run has no field ppc"),
        ("1 / 0\n", "line 1: ZeroDivisionError"),
    ],
)
def test_what_is_missing(run: Call, text: str, said: str) -> None:
    Path(FILE).write_text(text)
    assert said in one_line(run("./midpoint.py"))


def test_a_file_that_is_not_there(run: Call) -> None:
    assert "nowhere.py" in one_line(run("./nowhere.py"))


def test_what_it_raises_is_said_with_its_line(run: Call) -> None:
    Path(FILE).write_text(CASE.replace("    h = pi", "    h = 1 / 0\n    h = pi"))
    line = CASE[: CASE.index("    h = pi")].count("\n") + 1
    assert f"midpoint.py, line {line}: ZeroDivisionError" in one_line(run("./midpoint.py"))


def test_the_shipped_case_keeps_its_name(run: Call) -> None:
    from mpm_verify.cases.wave_bar.run import Run

    run("./midpoint.py", "--json")
    assert Run.case == "wave_bar"
