"""Tables of any code: the verdict is that of a study with the same numbers, and page, JSON and JUnit come with it."""

import json
from collections.abc import Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import fixtures_study as fixtures
import jsonschema
import pytest
from fixtures_command import TOP, Call, caller

import mpm_verify as mv
from mpm_verify.cases.any_code import reading, table
from mpm_verify.cases.any_code.case import examine
from mpm_verify.cases.any_code.execute import execute
from mpm_verify.cases.any_code.table import Expected
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.harness.verdicts import Finding, findings
from mpm_verify.cases.judging.records import Expectation, Outcome, ReasonCode
from mpm_verify.reports.export.document import schema
from mpm_verify.reports.frames import Record, read

CELLS = (8, 16, 32, 64)


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def judged(text: str, folder: Path, *, name: str = "errors.csv", **expected: Any) -> list[Finding]:
    """Findings of a table, in memory."""
    file = folder / name
    file.write_text(text)
    study, results = made(file, Expected(**expected))
    return findings(study, results)


def made(file: Path, expected: Expected) -> tuple[Study[Any], dict[str, Any]]:
    study = table.study(reading.read(file, expected.exact), expected, "verify judge", "t")
    return study, {run.digest: execute(run)[0] for run in study.runs}


def power(order: float, factor: float = 3.0, half: float = 1.001, cells: tuple[int, ...] = CELLS) -> str:
    """A table whose error is factor h^order, with the finest error at half the time step."""
    rows = [f"{n},{factor * n**-order!r},{half * factor * n**-order!r}" for n in cells]
    return "\n".join(["cells,error,half_dt_error", *rows])


# ---- the same verdict as a study


def of_study(record: Record, quantity: str, norm: str) -> tuple[list[Finding], str]:
    """Findings of a quantity where order 2 is expected of each refinement, and the same numbers as a table."""
    second, lines = Expectation(2.0), ["method;quantity;cells;replicate;error;half_dt_error"]
    plans = []
    for series in record.series:
        plans.append(replace(record.study.plans[0], run=series.first, quantity=quantity, norm=norm, judged=True,
                             expectation=second))  # fmt: skip
        for runs in series.replicates:
            for number, run in enumerate(runs):
                half = record.error(series.halved, quantity, norm) if series.halved and run == series.runs[-1] else None
                error = record.error(run, quantity, norm)
                numbers = ";".join((repr(error or float("nan")), repr(half) if half else ""))
                lines.append(f"{run.method} {run.ppc};{quantity};{run.cells};{number};{numbers}")
    return findings(replace(record.study, plans=tuple(plans)), record.results), "\n".join(lines)


def same(study: Finding, table: Finding) -> None:
    """Field by field; cells that fit a body are not a table's matter, nor what ended a run, which can be a FAIL."""
    a, b = study.verdict, table.verdict
    if a.reason.code is ReasonCode.RUN_ENDED:
        assert b.reason.code in (ReasonCode.LEVEL_MISSING, ReasonCode.FALLS_SHORT, ReasonCode.TOO_FEW_LEVELS)
        return
    assert (a.outcome, a.expected, a.observed, a.interval) == (b.outcome, b.expected, b.observed, b.interval)
    assert (a.local_orders, a.window, a.contamination) == (b.local_orders, b.window, b.contamination)
    assert (a.reason.code, a.reason.numbers, a.reason.wanted) == (b.reason.code, b.reason.numbers, b.reason.wanted)
    assert [end.h for end in a.reason.failed] == [end.h for end in b.reason.failed]
    assert [(level.h, level.errors) for level in study.levels] == [(level.h, level.errors) for level in table.levels]


@pytest.mark.parametrize(("quantity", "norm"), [*product(fixtures.SIZE, ("rms", "max", "final", "printed"))])
def test_recorded_errors_get_the_verdict_of_their_study(tmp_path: Path, quantity: str, norm: str) -> None:
    """CPDI and MPM with 1, 4 and 9 particles per cell on 8 to 128 cells, those that failed among them."""
    with fixtures.sources():
        record = read(fixtures.make(tmp_path / "study"))
        expected, text = of_study(record, quantity, norm)
    floor = max(result.floor.get(quantity, 0.0) for result in record.results.values())
    found = judged(text, tmp_path, order=2.0, floor=floor)
    assert len(found) == len(expected) == 6
    for one, other in zip(expected, found, strict=True):
        same(one, other)
    assert len({one.verdict.reason.code for one in found}) > 1 or norm != "rms"  # not all for want of anything


def test_a_study_that_was_run_gets_its_verdict(tmp_path: Path) -> None:
    """Replicates and the run with half the time step, as the solver gave them."""
    done = mv.study("wave_bar", method=["cpdi", "mpm"], cells=[8, 16, 32, 64], replicates=2, out=tmp_path / "study")
    expected, text = of_study(done.record, "frequency", "relative")
    floor = max(result.floor["frequency"] for result in done.record.results.values())
    found = judged(text, tmp_path, order=2.0, floor=floor)
    assert [len(level.errors) for level in found[0].levels] == [2] * 4
    for one, other in zip(expected, found, strict=True):
        same(one, other)
    assert "PASS" in {str(one.verdict.outcome) for one in found}


def test_another_number_is_another_verdict(tmp_path: Path) -> None:
    """The comparison above can fail: one error changed in its sixth digit."""
    text = power(2.0)
    (one,), (other,) = (
        judged(text, tmp_path, order=2.0),
        judged(text.replace("0.0117", "0.0117001"), tmp_path, order=2.0),
    )
    assert one.verdict.outcome == other.verdict.outcome == Outcome.PASS
    with pytest.raises(AssertionError):
        same(one, other)


@pytest.mark.parametrize("order", [1.0, 1.5, 2.0, 3.0, 4.0])
def test_a_power_law_has_its_order(tmp_path: Path, order: float) -> None:
    (found,) = judged(power(order), tmp_path, order=order)
    assert found.verdict.outcome is Outcome.PASS
    assert found.verdict.observed == pytest.approx(order, rel=1e-12)
    assert judged(power(order - 0.7), tmp_path, order=order)[0].verdict.reason.code is ReasonCode.ORDER_BELOW


@pytest.mark.parametrize("unit", [1.0, 1e3, 2.54e-2])
def test_units_and_the_way_sizes_are_written_change_nothing(tmp_path: Path, unit: float) -> None:
    """Cells, cell sizes in any unit, and any order of the rows; the errors in any unit too."""
    (cells,) = judged(power(1.9), tmp_path, order=2.0)
    rows = [f"{unit / n!r},{7 * unit * 3.0 * n**-1.9!r},{7 * unit * 3.003 * n**-1.9!r}" for n in reversed(CELLS)]
    (sizes,) = judged("\n".join(["h,error,half_dt_error", *rows]), tmp_path, order=2.0)
    assert sizes.verdict.outcome is cells.verdict.outcome
    assert sizes.verdict.reason.code is cells.verdict.reason.code
    assert sizes.verdict.observed == pytest.approx(cells.verdict.observed, rel=1e-12)
    assert [level.h for level in sizes.levels] == pytest.approx([unit / n for n in CELLS], rel=1e-14)


@pytest.mark.parametrize(("order", "half"), [(2.0, 1.001), (1.0, 1.001), (2.0, 1.2), (2.0, None)])
def test_the_python_api_says_the_same(tmp_path: Path, order: float, half: float | None) -> None:
    errors = [3.0 * n**-order for n in CELLS]
    api = mv.judge(CELLS, errors, order=2, dt_halved=None if half is None else half * errors[-1])
    text = power(order, half=half or 1.0)
    text = text if half else text.replace("half_dt_error", "not read")
    (found,) = judged(text, tmp_path, order=2.0)
    assert (str(found.verdict.outcome), found.verdict.observed, found.verdict.interval) == (
        api.outcome, api.order, api.interval,
    )  # fmt: skip
    assert found.verdict.local_orders == api.local_orders


def test_a_table_in_python(tmp_path: Path) -> None:
    (tmp_path / "errors.csv").write_text(power(2.0))
    done = mv.judge_table(tmp_path / "errors.csv", 2, out=tmp_path / "study")
    assert (done.outcome, done.exit_code) == ("PASS", 0)
    assert list(done.frames()["levels"]["cells"]) == list(CELLS)
    assert mv.load(tmp_path / "study").verdicts == done.verdicts
    with pytest.raises(ValueError, match="has no column value"):
        mv.judge_table(tmp_path / "errors.csv", 2, exact=False)


# ---- what is expected


def test_nothing_is_judged_without_an_order(verify: Call) -> None:
    """The observed order is said, and the exit code is that of a study without an expectation."""
    Path("errors.csv").write_text(power(2.0))
    code, out, err = verify("judge", "errors.csv", "--no-page")
    assert (code, err) == (3, "")
    assert "PASS" not in out
    assert "code, error: observed order 2.00 (interval 2.00 to 2.00, local orders 2.00 2.00 2.00)" in " ".join(
        out.split()
    )


@pytest.mark.parametrize("quantity", ["u", "v", "F", "sigma"])
@pytest.mark.parametrize("words", [[], ["--json"], ["--no-exact"]])
def test_a_quantity_may_have_any_name(verify: Call, quantity: str, words: list[str]) -> None:
    """Those of a manufactured solution too, which have norms there."""
    name = "value" if words == ["--no-exact"] else "error"
    rows = "".join(f"{n},{quantity},{1 / n**2 + (name == 'value')!r}\n" for n in (8, 16, 32, 64, 128))
    Path("u.csv").write_text(f"cells,quantity,{name}\n{rows}")
    code, out, err = verify("judge", "u.csv", "--order", "2", "--steady", "--no-page", *words)
    assert (code, err) == (0, "")
    assert "PASS" in out


def test_the_band_and_the_floor_count(tmp_path: Path) -> None:
    text = power(1.7)
    assert judged(text, tmp_path, order=2.0)[0].verdict.outcome is Outcome.FAIL
    assert judged(text, tmp_path, order=1.7, above=0.6)[0].verdict.outcome is Outcome.PASS
    near = judged(power(2.0), tmp_path, order=2.0, floor=1e-4)[0].verdict.reason
    assert (near.code, near.numbers["floor"]) == (ReasonCode.NEAR_ROUND_OFF, 1e-4)


STEPS: Mapping[str, tuple[str, dict[str, Any], ReasonCode]] = {
    "not there": ("", {}, ReasonCode.TIME_STEP_UNKNOWN),
    "fine": ("1.05", {}, ReasonCode.AS_EXPECTED),
    "coupled": ("1.2", {}, ReasonCode.TIME_STEP_COUPLED),
    "none": ("", {"steady": True}, ReasonCode.AS_EXPECTED),
    "it failed": ("nan", {}, ReasonCode.TIME_STEP_UNKNOWN),
}


@pytest.mark.parametrize("name", STEPS)
def test_half_the_time_step(tmp_path: Path, name: str) -> None:
    """Only the finest level has to have it."""
    factor, more, code = STEPS[name]
    half = {"": "", "nan": "nan"}.get(factor) if factor in ("", "nan") else repr(float(factor) / 64**2)
    head = "cells,error" if more else "cells,error,half_dt_error"
    rows = [f"{n},{n**-2.0!r}" + ("" if more else f",{half if n == 64 else ''}") for n in CELLS]
    assert judged("\n".join([head, *rows]), tmp_path, order=2.0, **more)[0].verdict.reason.code is code


@pytest.mark.parametrize("bad", ["nan", "inf", "NaN", "Infinity", "-nan", "-nan(ind)"])
@pytest.mark.parametrize("at", range(4))
def test_an_error_that_is_not_finite_is_a_failed_level(tmp_path: Path, bad: str, at: int) -> None:
    lines = power(2.0).splitlines()
    lines[1 + at] = f"{CELLS[at]},{bad},"
    (found,) = judged("\n".join(lines), tmp_path, order=2.0)
    assert (found.verdict.outcome, found.verdict.reason.code) == (Outcome.INCONCLUSIVE, ReasonCode.LEVEL_MISSING)
    assert found.verdict.reason.failed[0].h == 1 / CELLS[at]


def test_all_failed_is_an_error_with_a_page(verify: Call) -> None:
    Path("errors.csv").write_text("h,error\n" + "".join(f"{1 / n},nan\n" for n in CELLS))
    code, out, _ = verify("judge", "errors.csv", "--order", "2", "--page")
    assert code == 4
    assert "no level finished" in out
    assert Path("results/judge-errors/report.html").is_file()


# ---- what would decide is a row, not an option


ADVICE = {
    "a level": ("cells,error\n8,1\n16,0.25\n32,0.0625\n", "add a row of 64 cells"),
    "two levels": ("cells,error\n8,1\n16,0.25\n", "add rows of 32, 64 cells"),
    "one level": ("cells,error\n8,1\n", "add rows of 16, 32, 64 cells"),
    "sizes": ("h,error\n0.1,1\n0.05,0.25\n0.025,0.06\n", "add a row of h = 0.0125"),
    "sizes of any unit": ("h,error\n3.5,1\n1.75,0.25\n", "add rows of finer levels down to h = 0.4375"),
    "another size": ("h,error\n12,1\n6,0.25\n3,0.06\n", "add a row of h = 1.5"),
    "half the time step": (power(2.0).replace(",half_dt_error", ",x"), "add a column half_dt_error, the error"),
    "a coupled one": (power(2.0, half=1.3), "run all levels with half the time step, and judge that table"),
    "a failed one": (power(2.0).replace("64,0.000732421875", "64,nan"), "that row needs an error that is finite"),
    "round-off": (power(2.0, 1e-14), "take the finest level out, and add a row of 4 cells"),
}  # fmt: skip


@pytest.mark.parametrize("name", ADVICE)
def test_advice_is_for_the_table(verify: Call, name: str) -> None:
    text, advice = ADVICE[name]
    Path("errors.csv").write_text(text)
    code, out, _ = verify("judge", "errors.csv", "--order", "2", "--floor", "1e-18", "--json")
    (verdict,) = json.loads(out)["verdicts"]
    assert code == 3
    assert advice in verdict["reason"]
    assert "--cells" not in out
    assert "--courant" not in out


# ---- what comes with it


TABLE = "cells,method,quantity,replicate,error\n" + "".join(
    f"{n},{method},{quantity},{replicate},{(1 + 0.01 * replicate) * n**-order!r}\n"
    for method, quantity, order in (("fem", "u", 2.0), ("fem", "p", 1.0), ("fv", "u", 2.0))
    for n in CELLS
    for replicate in (1, 2, 3)
)


def test_all_outputs_of_a_study(verify: Call, tmp_path: Path) -> None:
    Path("errors.csv").write_text(TABLE)
    options = ("--order", "2", "--steady")
    code, out, err = verify(
        "judge", "errors.csv", *options, "--json", "--junit", "j.xml", "--summary", "s.md", "--page"
    )
    document = json.loads(out)
    assert (code, err, document["outcome"], document["case"]) == (1, "", "FAIL", "any_code")
    jsonschema.validate(document, schema("any_code"))
    assert [(v["method"], v["quantity"], v["verdict"]) for v in document["verdicts"]] == [
        ("fem", "u", "PASS"), ("fem", "p", "FAIL"), ("fv", "u", "PASS"),
    ]  # fmt: skip
    assert len(document["runs"]) == 36
    suite = ElementTree.parse("j.xml").getroot()
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("3", "1", "0")
    assert [(test.get("classname"), test.get("name")) for test in suite] == [
        ("judge-errors.fem", "u"), ("judge-errors.fem", "p"), ("judge-errors.fv", "u"),
    ]  # fmt: skip
    assert "❌ FAIL | fem | p |" in Path("s.md").read_text()
    folder = Path("results/judge-errors")
    page = (folder / "report.html").read_text()
    assert all(
        word in page for word in ("Refinement in errors.csv", "2 of 3 judged quantities PASS, 1 FAIL", "Rows of the")
    )
    assert {file.name for file in (folder / "figures").glob("*.png")} == {"error_p_error.png", "error_u_error.png"}
    assert {file.stem for file in (folder / "tables").glob("*.csv")} == {"runs", "levels", "verdicts"}
    assert verify("report", str(folder))[0] == 0
    assert (folder / "report.html").read_text() == page


def test_a_table_has_no_field(verify: Call) -> None:
    Path("errors.csv").write_text(power(2.0))
    verify("judge", "errors.csv", "--no-page")
    assert "the case any_code has no error field" in verify("report", "results/judge-errors", "--field", "16,4")[2]


def test_a_million_cells_are_written_out(verify: Call) -> None:
    Path("errors.csv").write_text("cells,error\n1048576,1\n2097152,0.25\n")
    _, out, _ = verify("judge", "errors.csv", "--order", "2", "--page")
    assert " 1048576  1.000e+00" in out
    assert "add rows of 4194304, 8388608 cells" in out
    assert "1048576" in Path("results/judge-errors/report.html").read_text()


def test_a_stored_table_needs_its_file_no_more(verify: Call) -> None:
    Path("errors.csv").write_text(TABLE)
    verify("judge", "errors.csv", "--order", "2", "--steady", "--no-page")
    Path("errors.csv").unlink()
    assert mv.load("results/judge-errors").outcome == "FAIL"
    assert verify("report", "results/judge-errors")[0] == 0


def test_two_tables_are_compared(verify: Call) -> None:
    """Rows at the same point are the same run, whatever the number; a table against itself has no change."""
    Path("a.csv").write_text(power(2.0))
    Path("b.csv").write_text(power(2.0).replace("\n64,0.000732421875", "\n64,0.0015"))
    for name in "ab":
        verify("judge", f"{name}.csv", "--order", "2", "--no-page", "--out", name)
    code, out, _ = verify("diff", "a", "b")
    assert code == 1
    rows = [line.split() for line in out.splitlines()]
    assert ["error", "error", "0.000732422", "0.0015", "2.048", "times"] in [row[:6] for row in rows]
    assert ["verdict", "PASS", "INCONCLUSIVE"] in [row[:3] for row in rows]
    assert [row[:2] for row in rows if "order" in row] == [["observed", "order"]]
    assert "changes in 8 runs that both have" in out
    assert verify("diff", "a", "a")[0] == 0


def test_a_number_that_was_corrected_is_read_anew(verify: Call) -> None:
    """Also where it is changed back: what is stored for a row is told apart by its number."""
    for text, code in ((power(2.0), 0), (power(1.0), 1), (power(2.0), 0)):
        Path("errors.csv").write_text(text)
        assert verify("judge", "errors.csv", "--order", "2", "--no-page")[0] == code
    with pytest.MonkeyPatch.context() as patch:  # another version of the code that reads a table
        from mpm_verify.cases.harness import identity

        sources = identity.sources
        patch.setattr(identity, "sources", lambda *given: sources(*given) + "later")
        record = read(Path("results/judge-errors"))
        assert record.earlier
        assert str(record.analysis.outcome) == "PASS"


def test_columns_that_were_read_are_told(verify: Call) -> None:
    Path("errors.csv").write_text("N,L2 error,time\n8,1,3\n16,0.25,3\n")
    code, out, _ = verify("judge", "errors.csv", "--order", "2", "--no-page")
    assert code == 3
    assert "Columns of errors.csv that were read: N as cells, L2 error as error. Not read: time." in out
    assert "code    L2 error" in out


def test_numbers_of_a_table_are_no_axes(verify: Call) -> None:
    Path("own.toml").write_text('case = "any_code"\n[sweep]\ncells = [8.0, 16.0]\n')
    code, _, err = verify("sweep", "own.toml")
    assert code == 2
    assert "verify judge FILE" in err


def test_of_errors_nothing_is_extrapolated(tmp_path: Path) -> None:
    (tmp_path / "errors.csv").write_text(power(2.0))
    study, results = made(tmp_path / "errors.csv", Expected(2.0))
    assert examine(study, results, None).extrapolated == ()


def test_the_transcript_of_the_page(verify: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each command on docs/judge.md prints what stands below it."""
    monkeypatch.setenv("COLUMNS", "100")
    for name in ("errors.csv", "drag.csv"):
        Path(name).write_text((TOP / "docs" / "examples" / name).read_text())
    page = (TOP / "docs" / "judge.md").read_text()
    shown = [part.partition("```")[0] for part in page.split("```text\n")[1:]]
    assert len(shown) == 2
    for text in shown:
        prompt, _, rest = text.partition("\n")
        _, out, err = verify(*prompt.removeprefix("$ verify ").split())
        assert err == ""
        assert [line.rstrip() for line in out.strip().splitlines()] == [
            line.rstrip() for line in rest.strip().splitlines()
        ]


def test_local_orders_of_json_run_over_the_pairs_of_levels(verify: Call) -> None:
    """Null on both sides of an error of zero and of a level that failed, so that the k-th is of levels k and k + 1."""
    for middle, k in (("0", 1), ("nan", 2)):
        errors = ["1e-2", "4e-3", "1e-3", "2.5e-4", "6.25e-5"]
        errors[k] = middle
        lines = [f"{4 * 2**level},{error}" for level, error in enumerate(errors)]
        Path("errors.csv").write_text("\n".join(["cells,error", *lines]))
        _, out, _ = verify("judge", "errors.csv", "--order", "2", "--json", "--no-page")
        (row,) = json.loads(out)["verdicts"]
        assert [order is None for order in row["local_orders"]] == [n in (k - 1, k) for n in range(4)]
        assert row["local_orders"][3] == pytest.approx(2.0)
