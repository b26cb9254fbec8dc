"""What other programs read: the document of --json, held against its schema, and the JUnit file."""

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import fixtures_study as fixtures
import pytest
from jsonschema import Draft202012Validator, ValidationError

from mpm_verify.cases.mms import execute as mms
from mpm_verify.cases.mms import expectations
from mpm_verify.cases.mms.run import NORMS, QUANTITIES, Result
from mpm_verify.reports.export.document import VERSION, schema
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.verify.main import main

Json = dict[str, Any]
Change = Callable[[Result], Result]


def no_constant(text: str) -> None:
    raise AssertionError(f"{text} is no JSON")  # Python reads NaN and Infinity, other programs do not


def parse(text: str) -> Json:
    document: Json = json.loads(text, parse_constant=no_constant)
    return document


def validate(document: Json) -> None:
    derived = schema("mms")
    Draft202012Validator.check_schema(derived)
    Draft202012Validator(derived).validate(document)


# ---- a real study in a process of its own


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> tuple[subprocess.CompletedProcess[str], Path]:
    """Classical MPM beside CPDI; with 1 per cell on 16 cells classical MPM ends with det F <= 0."""
    folder = tmp_path_factory.mktemp("real")
    command = [sys.executable, "-m", "mpm_verify", "mms", "--method", "mpm,cpdi", "--jobs", "1", "--page"]
    command += ["--cells", "8,16,32", "--ppc", "1,4", "--json", "--junit", "below/out.xml", "--out", "study"]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, timeout=120), folder


def test_standard_output_is_one_valid_document(real: tuple[subprocess.CompletedProcess[str], Path]) -> None:
    run, folder = real
    assert run.stderr == ""  # no progress bar either: standard error is no terminal here
    document = parse(run.stdout)
    validate(document)
    assert document["version"] == VERSION == 4
    assert (folder / document["report"]).is_file()
    assert run.returncode == 3  # three levels are too few for CPDI


def test_document_of_the_real_study(real: tuple[subprocess.CompletedProcess[str], Path]) -> None:
    document = parse(real[0].stdout)
    verdicts = {(v["method"], v["ppc"]): v for v in document["verdicts"]}
    assert verdicts.keys() == {("mpm", 4), ("cpdi", 4)}
    assert verdicts["mpm", 4]["expected"] == "diverges"
    assert verdicts["mpm", 4]["verdict"] == "PASS"
    assert verdicts["cpdi", 4]["expected"] == 2.0
    assert verdicts["cpdi", 4]["verdict"] == "INCONCLUSIVE"
    assert len(document["verdicts"]) + len(document["shown"]) == 2 * 2 * len(QUANTITIES) * len(NORMS)


def test_failed_runs_are_told(real: tuple[subprocess.CompletedProcess[str], Path]) -> None:
    runs = {(r["method"], r["cells"], r["ppc"], r["courant"]): r for r in parse(real[0].stdout)["runs"]}
    failed = {key for key, run in runs.items() if run["status"] == "failed"}
    assert failed == {("mpm", 16, 1, 0.4), ("mpm", 32, 1, 0.4)}
    for key, run in runs.items():
        assert (run["errors"] is None) == (key in failed)
        assert ((run["failure"] or {}).get("kind") == "inverted") == (key in failed)
        assert ("det F ≤ 0 at step" in run["reason"]) == (key in failed)
        assert run["particles"] == run["ppc"] * run["cells"] ** 2
    assert ("cpdi", 32, 4, 0.2) in runs  # with half the time step


def test_junit_of_the_real_study(real: tuple[subprocess.CompletedProcess[str], Path]) -> None:
    suite = ElementTree.parse(real[1] / "below" / "out.xml").getroot()
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("2", "1", "0")


# ---- known results in place of the solver: what the document says of each outcome


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Callable[..., Any]:
    """Call the command with results changed by a function; exit code, document, JUnit suite."""
    monkeypatch.chdir(tmp_path)

    def tell(change: Change = lambda result: result, *arguments: str) -> tuple[int, Json, ElementTree.Element]:
        monkeypatch.setattr(mms, "execute", lambda run, tick: (change(fixtures._result(run)), {}))
        monkeypatch.setattr(expectations, "recorded", lambda *key: ())  # those of the fixtures are made of those of u
        monkeypatch.setattr(sys, "argv", ["verify", "mms", *arguments, "--jobs", "1", "--json", "--junit", "out.xml"])
        with pytest.raises(SystemExit) as ended:
            main()
        document = parse(capsys.readouterr().out)
        validate(document)
        assert document["report"] is None  # nobody asked for a page
        assert document["exit_code"] == ended.value.code
        return ended.value.code, document, ElementTree.parse("out.xml").getroot()

    return tell


def lost(result: Result) -> Result:
    return replace(result, status="failed", errors={}, floor={}, failure=Failure(FailureKind.EMPTY_CELL, 3, 5, (1, 2)))


def leaking(result: Result) -> Result:
    """An error of first order where second is expected."""
    errors = {q: dict.fromkeys(NORMS, 0.02 / result.run.cells) for q in QUANTITIES}
    return replace(result, errors=errors)


def finest_lost(result: Result) -> Result:
    return lost(result) if result.run.cells == 128 else result


@pytest.mark.parametrize(
    ("change", "code", "outcomes"),
    [
        (lambda result: result, 0, {"PASS"}),
        (leaking, 1, {"FAIL"}),
        (lost, 4, {"ERROR"}),
        (finest_lost, 3, {"INCONCLUSIVE"}),
    ],
    ids=["pass", "fail", "error", "inconclusive"],
)
def test_each_outcome(told: Callable[..., Any], change: Change, code: int, outcomes: set[str]) -> None:
    exit_code, document, suite = told(change)
    assert exit_code == code
    assert {verdict["verdict"] for verdict in document["verdicts"]} == outcomes
    assert all(verdict["reason"] for verdict in document["verdicts"])
    count = 8 if code == 1 else 2  # v, F and sigma fail too, and count then
    assert len(suite.findall("testcase")) == len(document["verdicts"]) == count
    counted = [suite.get(name) for name in ("tests", "failures", "errors")]
    assert counted == [str(count), {1: "8", 3: "2"}.get(code, "0"), "2" if code == 4 else "0"]
    assert len(suite.findall("testcase/failure")) == int(counted[1] or 0)
    assert len(suite.findall("testcase/error")) == int(counted[2] or 0)


def test_expected_divergence_passes_in_words(told: Callable[..., Any]) -> None:
    exit_code, document, suite = told(lambda result: result, "--method", "mpm")
    assert exit_code == 0
    assert {(v["expected"], v["verdict"]) for v in document["verdicts"]} == {("diverges", "PASS")}
    assert {v["code"] for v in document["verdicts"]} == {"diverges"}
    assert all("does not converge, as expected" in v["reason"] for v in document["verdicts"])
    for told_of, case in zip(document["verdicts"], suite.iter("testcase"), strict=True):
        assert told_of["stall"]["named"] == ["cell_crossings"]
        assert told_of["stall"]["where"] in (case.findtext("system-out") or "")
    assert suite.get("failures") == "0"


def test_junit_has_a_case_a_judged_quantity(told: Callable[..., Any]) -> None:
    _, document, suite = told(leaking, "--method", "cpdi", "--method", "mpm")
    names = [(case.get("classname"), case.get("name")) for case in suite.iter("testcase")]
    assert names == [
        (f"{document['study']}.{v['method']}.{v['solution']}", f"{v['quantity']} {v['norm']}, {v['ppc']} per cell")
        for v in document["verdicts"]
    ]
    failures = [failure.get("message") for failure in suite.iter("failure")]
    assert failures == [v["reason"] for v in document["verdicts"] if v["verdict"] != "PASS"]


def test_nothing_judged(told: Callable[..., Any]) -> None:
    exit_code, document, suite = told(lambda result: result, "--ppc", "1")
    assert (exit_code, document["verdicts"], suite.get("tests")) == (3, [], "0")
    assert document["shown"]


@pytest.mark.parametrize("cells", ["8", "8,16", "8,16,32"])
def test_too_few_levels_for_an_interval(told: Callable[..., Any], cells: str) -> None:
    """One or two levels have no slope with an interval: null, never NaN or Infinity."""
    _, document, _ = told(lambda result: result, "--cells", cells)
    levels = cells.count(",") + 1
    for verdict in document["verdicts"] + document["shown"]:
        assert len(verdict["local_orders"]) == levels - 1
        assert (verdict["interval"] is None) == (levels < 3)


# ---- the schema


@pytest.fixture
def document(told: Callable[..., Any]) -> Json:
    found: Json = told(finest_lost)[1]
    return found


def items(document: Json) -> list[Json]:
    """Every object of the document."""
    runs = [run for run in document["runs"] if run["errors"]]
    found = [document, document["verdicts"][0], document["shown"][0], runs[0], runs[0]["errors"]]
    return [*found, runs[0]["errors"]["u"]]


@pytest.mark.slow
@pytest.mark.parametrize("number", range(6))
def test_schema_forbids_unknown_and_missing_keys(document: Json, number: int) -> None:
    item = items(document)[number]
    item["another"] = 1
    with pytest.raises(ValidationError, match="another"):
        validate(document)
    del item["another"]
    validate(document)
    for key in list(item):
        value = item.pop(key)
        with pytest.raises(ValidationError):
            validate(document)
        item[key] = value


def test_schema_is_of_this_version(document: Json) -> None:
    document["version"] = VERSION + 1
    with pytest.raises(ValidationError):
        validate(document)


def test_schema_of_a_command(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """It is derived from the records that are printed, and printed itself."""
    monkeypatch.setattr(sys, "argv", ["verify", "schema", "mms"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 0
    assert parse(capsys.readouterr().out) == schema("mms")
