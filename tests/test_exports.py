"""What a study leaves for other programs: summaries, times, differences, schemas, and tables of all shipped studies."""

import csv
import json
from dataclasses import fields, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast
from xml.etree import ElementTree

import fixtures_study as fixtures
import pytest
from fixtures_command import Call, caller, one_line
from jsonschema import Draft202012Validator, ValidationError

from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.shipped import shipped
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study_file import read
from mpm_verify.cases.mms import execute as mms
from mpm_verify.cases.mms import expectations
from mpm_verify.reports.export.column_files import tables
from mpm_verify.reports.export.document import schema
from mpm_verify.reports.frames import joined


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


@pytest.fixture
def made_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Known results in place of the solver."""
    monkeypatch.setattr(mms, "execute", lambda run, tick: (fixtures._result(run), {}))
    monkeypatch.setattr(expectations, "recorded", lambda *key: ())  # those of the fixtures are made of those of u
    monkeypatch.setattr("mpm_verify.verify.run.SMALL", float("inf"))  # worker processes would run the solver


STUDY = ("mms", "--method", "cpdi,mpm", "--ppc", "4", "--no-page", "--out", "study")


# ---- summaries and times


def test_a_summary_of_a_study(verify: Call, made_up: None, tmp_path: Path) -> None:
    """Appended, as CI servers want it: a heading, a row a verdict."""
    file = tmp_path / "below" / "summary.md"
    for _ in range(2):
        assert verify(*STUDY, "--summary", str(file))[0] == 0
    text = file.read_text()
    assert text.count("### ✅ PASS: CPDI and MPM against the manufactured solution axis_aligned\n") == 2
    assert text.count("`verify mms --method cpdi,mpm --ppc 4`\n") == 2
    rows = [line.split(" | ") for line in text.splitlines() if "per cell |" in line]
    assert [row[0] for row in rows] == 2 * ["| ✅ PASS", "| 🔷 diverges, as registered"]
    assert [row[1] for row in rows[:2]] == ["CPDI, 4 per cell", "MPM, 4 per cell"]
    assert [row[4] for row in rows[:2]] == ["2.00 (1.80 to 2.30)", "diverges"]


def test_the_summary_of_a_ci_job(verify: Call, made_up: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(tmp_path / "job.md"))
    assert verify(*STUDY)[0] == 0
    assert (tmp_path / "job.md").read_text().startswith("### ✅ PASS: ")
    assert verify(*STUDY, "--summary", "mine.md")[0] == 0
    assert (tmp_path / "mine.md").read_text() == (tmp_path / "job.md").read_text()


def test_a_summary_that_cannot_be_written(verify: Call, made_up: None, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert "--summary file/below.md" in one_line(verify(*STUDY, "--summary", "file/below.md"))
    assert not (tmp_path / "study").exists()


def test_times_in_junit(verify: Call, made_up: None, tmp_path: Path) -> None:
    """Times of a verdict are those of its runs, of the suite those of all."""
    assert verify(*STUDY, "--junit", "out.xml")[0] == 0
    store = Store(tmp_path / "study")
    results = [store.get(run.digest) for run in store.study().runs]
    times = {
        method: sum(r.wall_s for r in results if r.run.method == method and r.run.courant == 0.4)
        for method in ("cpdi", "mpm")
    }
    suite = ElementTree.parse(tmp_path / "out.xml").getroot()
    told = {case.get("classname", "").split(".")[1]: float(case.get("time", "nan")) for case in suite.iter("testcase")}
    assert told == pytest.approx(times, abs=5e-4)
    assert float(suite.get("time", "nan")) == pytest.approx(sum(r.wall_s for r in results), abs=5e-4)
    assert min(told.values()) > 1


# ---- differences


@pytest.fixture
def pair(tmp_path: Path) -> tuple[Path, Path]:
    return fixtures.make(tmp_path / "a", largest=0), fixtures.make(tmp_path / "b", largest=0)


def altered(folder: Path, **changes: Any) -> str:
    """Another result of the first run; what it is called."""
    with fixtures.sources():
        store = Store(folder)
        result = store.get(store.study().runs[0].digest)
        store.put(replace(result, **changes), {})
        return str(result.run)


def test_no_difference(verify: Call, pair: tuple[Path, Path]) -> None:
    with fixtures.sources():
        assert verify("diff", *map(str, pair)) == (0, "0 changes in 32 runs that both have\n", "")


def test_a_difference_of_a_number(verify: Call, pair: tuple[Path, Path]) -> None:
    """Told with its ratio, unless it is within the tolerance."""
    with fixtures.sources():
        store = Store(pair[1])
        result = store.get(store.study().runs[0].digest)
        errors = {**result.errors, "u": {**result.errors["u"], "final": result.errors["u"]["final"] * 1.001}}
        name = altered(pair[1], errors=errors)
        code, out, _ = verify("diff", *map(str, pair))
        assert code == 1
        _, first, last = out.splitlines()
        assert f" {name}, " in first
        assert first.startswith("u final ")
        assert " 1.001 times " in first
        assert last == "1 changes in 32 runs that both have"
        assert verify("diff", *map(str, pair), "--tolerance", "0.01")[0] == 0
        found = json.loads(verify("diff", *map(str, pair), "--json")[1])
        assert found["compared"] == 32
        assert [one["what"] for one in found["changes"]] == ["u final"]


def test_a_difference_of_an_end(verify: Call, pair: tuple[Path, Path]) -> None:
    with fixtures.sources():
        altered(pair[1], status="failed", errors={}, failure=fixtures.Failure(fixtures.FailureKind.INVERTED, 3))
        code, out, _ = verify("diff", *map(str, pair))
    assert code == 1
    assert ["status", "finished", "failed"] in [line.split()[:3] for line in out.splitlines()]


def test_what_cannot_be_compared(verify: Call, pair: tuple[Path, Path], tmp_path: Path) -> None:
    assert "--tolerance -1" in one_line(verify("diff", *map(str, pair), "--tolerance", "-1"))
    assert "not a study folder" in one_line(verify("diff", str(pair[0]), str(tmp_path / "none")))


# ---- schemas


SMALL = {
    "box": [
        "--cells",
        "2",
        "--aspect",
        "3.5",
        "--ppc",
        "4",
        "--drop",
        "0",
        "--duration",
        "0.02",
        "--control",
        "no,yes",
    ],
    "column": ["--cells", "2", "--aspect", "2", "--channel", "4", "--duration", "0.01", "--ppc", "1,4"],
    "element": ["linear_elastic", "--test", "isotropic,biaxial", "--steps", "2"],
    "bench": ["--method", "mpm", "--cells", "4,6", "--ppc", "1", "--pairs", "3"],
    "wave_bar": ["--cells", "4,8", "--ppc", "1"],
    "objectivity": ["--cells", "4", "--ppc", "1"],
}
NAMES = {"element": "material"}
SLOW = {"objectivity": [pytest.mark.slow]}  # half a minute


@pytest.mark.parametrize("case", [pytest.param(case, marks=SLOW.get(case, ())) for case in SMALL])
def test_documents_are_as_their_schema_says(verify: Call, case: str) -> None:
    """Documents of real runs. A key too many and one too few are seen."""
    code, out, err = verify(NAMES.get(case, case), *SMALL[case], "--json", "--jobs", "1", "--out", "study")
    assert code in (0, 1, 3)
    assert err == ""
    document = json.loads(out)
    derived = json.loads(verify("schema", case)[1])
    assert derived == schema(case)
    Draft202012Validator.check_schema(derived)
    validator = Draft202012Validator(derived)
    validator.validate(document)
    assert document["case"] == case
    names = {item.name for item in fields(case_named(case).Run)}
    row = document["runs"][0]
    assert names <= row.keys()
    for key in [*row]:
        value = row.pop(key)
        with pytest.raises(ValidationError):
            validator.validate(document)
        row[key] = value
    document["another"] = 1
    with pytest.raises(ValidationError, match="another"):
        validator.validate(document)


# ---- tables


@pytest.fixture(scope="module")
def real() -> tuple[Any, dict[str, Any]]:
    """A column of eight particles: what a run measures, by its names."""
    run = ColumnRun(cells=2, aspect=2.0, channel=4.0, duration=0.01, ppc=1)
    found: tuple[Any, dict[str, Any]] = case_named("column").execute(run, lambda share: None)
    return found


@pytest.mark.parametrize("name", shipped())
def test_each_axis_is_a_column_with_its_values(name: str, real: tuple[Any, dict[str, Any]], tmp_path: Path) -> None:
    """Whatever a run measures, runs.csv of every shipped study holds what was swept."""
    study, (result, arrays) = read(name, f"verify sweep {name}"), real
    assert study.case == "column"
    store = Store(tmp_path, "column")
    store.create(study)
    results = {run.digest: replace(result, run=run, digest=run.digest) for run in study.runs}
    for one in results.values():
        store.put(one, arrays)
    (tmp_path / "tables").mkdir()
    tables(cast("Any", SimpleNamespace(study=study, results=results)), store, tmp_path / "tables")
    with (tmp_path / "tables" / "runs.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["digest"] for row in rows] == [run.digest for run in study.runs]
    assert study.axes or len(study.runs) == 1
    for axis in study.axes:
        for row, run in zip(rows, study.runs, strict=True):
            value = getattr(run, axis)
            told = (row[f"{axis}_x"], row[f"{axis}_y"]) if isinstance(value, tuple) else row[axis]
            assert parsed(told, value) == value, axis
    header = (tmp_path / "tables" / "runs.csv").read_text().partition("\n")[0].split(",")
    assert len(header) == len(set(header)) > len(study.axes) + len(result.values)
    curves = (tmp_path / "tables" / "curves.csv").read_text().partition("\n")[0].split(",")
    assert len(curves) == len(set(curves)) > len(study.axes)


def parsed(told: Any, value: Any) -> Any:
    """A cell of the table as a value of that kind."""
    if isinstance(value, tuple):
        return tuple(float(one) for one in told)
    return told == "True" if isinstance(value, bool) else type(value)(told)


def test_two_columns_of_one_name_are_an_error() -> None:
    with pytest.raises(ValueError, match="two columns of a table have the name 'damping'"):
        joined({"digest": "a"}, {"damping": 0.1}, {"damping": 3.0})


@pytest.mark.parametrize("case", ["mms", "bench", "box", "column", "element", "objectivity", "wave_bar"])
def test_every_case_has_a_table_of_runs(case: str, tmp_path: Path) -> None:
    """No field of a run has the name of what is measured of it."""
    from mpm_verify.cases.harness.study import ResultRecord, Study
    from mpm_verify.reports.frames import Record
    from mpm_verify.reports.tables.mms import runs

    run = case_named(case).Run()
    result: ResultRecord[Any] = ResultRecord(run=run, digest=run.digest, status="finished", steps=7, particles=3)
    study: Study[Any] = Study("t", "t", "", (run,), case=case)
    (row,) = runs(Record(Store(tmp_path, case), study, {run.digest: result}, earlier=False))
    assert (row["time_steps"], row["particles"], row["status"]) == (7, 3, "finished")
    for item in fields(run):
        value = getattr(run, item.name)
        names = [f"{item.name}_x", f"{item.name}_y"] if isinstance(value, tuple) else [item.name]
        assert [row[name] for name in names] == (list(value) if isinstance(value, tuple) else [value])
