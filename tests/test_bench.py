"""The benchmark of speed: its numbers from given times, its bits, its table, and the page of the documentation."""

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fixtures_command import Call, caller, one_line
from numba.core.config import NUMBA_NUM_THREADS

from mpm_verify.cases.bench.case import examine
from mpm_verify.cases.bench.execute import STEPS, body, differ, execute, turn, values
from mpm_verify.cases.bench.run import AXES, Result, Run
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.reports.sentences.bench import statement
from mpm_verify.reports.tables.bench import markdown
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.verify.run import SMALL

SMALLEST = Run(cells=6, ppc=1, pairs=3)
DOCS = Path(__file__).resolve().parent.parent / "docs"


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def rows_of(table: Path) -> list[dict[str, str]]:
    with table.open() as file:
        return list(csv.DictReader(file))


def test_numbers_of_given_times() -> None:
    """Twice the time in each turn is a ratio of two, whatever the machine does meanwhile; one odd turn changes none."""
    one, several = (body(SMALLEST, "mpm") for _ in range(2))
    slow = np.array([1.0, 3.0, 1.5, 2.0, 40.0])
    spent = np.stack([np.stack([2e-3 * slow, 2e-3 * slow], axis=1), np.stack([2e-3 * slow, 5e-4 * slow], axis=1),
                      np.stack([1e-3 * slow, 1e-3 * slow], axis=1)], axis=1)  # fmt: skip
    found = values(spent, one, several)
    assert [found[name] for name in ("ratio", "low", "high", "parallel")] == pytest.approx([2.0, 2.0, 2.0, 4.0])
    assert found["ns"] == pytest.approx(1e9 * 4e-3 / STEPS / 36)
    spent[0, 0, 0] *= 10
    assert values(spent, one, several)["ratio"] == pytest.approx(2.0)
    assert values(spent, one, several)["high"] > 2.5


def test_a_bit_that_differs_is_counted() -> None:
    one, other = (body(SMALLEST, "cpdi") for _ in range(2))
    assert differ(one, other) == 0
    other.particles.v[3, 1] = np.nextafter(other.particles.v[3, 1], 1.0)
    other.particles.sigma[0, 2] = -0.0
    assert differ(one, other) == 2
    turn(one, 1)
    assert one.steps == STEPS
    assert differ(one, other) > 36


@pytest.mark.parametrize("method", AXES["method"])
def test_a_run(method: str) -> None:
    """Turns of the same length, the same bits, times above zero; what moves is the body and not a still one."""
    result, arrays = execute(replace(SMALLEST, method=method))
    assert result.status == "finished"
    assert result.steps == STEPS * (SMALLEST.pairs + 1)
    assert result.values["differ"] == 0.0
    assert arrays["times"].shape == (SMALLEST.pairs, 3, 2)
    assert min(result.values[name] for name in ("ns", "ratio", "low", "high", "parallel", "threads")) > 0
    moved = body(SMALLEST, method)
    turn(moved, 1)
    assert np.abs(moved.particles.x - moved.particles.X).max() > 1e-6 * moved.grid.dx
    assert result.environment["architecture"]


def test_bits_that_differ_fail() -> None:
    def outcomes(change: dict[str, Any]) -> list[str]:
        result = Result(**{"run": SMALLEST, "digest": SMALLEST.digest, "status": "finished"} | change)
        study: Study[Run] = Study("t", "t", "", (SMALLEST,), case="bench")
        return [str(c.outcome) for c in examine(study, {SMALLEST.digest: result}, Store(Path("none"), "bench")).checks]

    failed = {"status": "failed", "failure": Failure(FailureKind.INVERTED, 3)}
    numbers = [{"values": {"differ": differ, "threads": threads}} for differ in (0.0, 1.0) for threads in (2.0, 1.0)]
    assert [outcomes(one) for one in (*numbers, failed)] == [
        ["PASS"], ["INCONCLUSIVE"], ["FAIL"], ["INCONCLUSIVE"], ["ERROR"]
    ]  # fmt: skip


def test_one_thread_judges_nothing(verify: Call, tmp_path: Path) -> None:
    """One thread alone: INCONCLUSIVE with the reason, on the terminal and on the page, which tells its sizes."""
    options = ("--method", "mpm", "--cells", "6", "--ppc", "1,4", "--pairs", "3", "--parallel", "1")
    code, out, _ = verify("bench", *options, "--page", "--out", "study")
    assert code == 3
    assert "give --parallel 2" in " ".join(out.split())
    assert "1 thread\n" in out
    page = (tmp_path / "study/report.html").read_text()
    assert "give --parallel 2" in page
    assert "Here: 6 cells along a side with 1 per cell, 6 cells along a side with 4 per cell." in page
    assert "128" not in " ".join(statement([SMALLEST]))


def test_runs_are_done_one_at_a_time() -> None:
    """Several at once would time one another: what decides on worker processes is their cost."""
    assert 1000 * Run().cost < SMALL < Run().updates


def test_a_command(verify: Call, tmp_path: Path) -> None:
    code, out, _ = verify("bench", "--method", "mpm,cpdi", "--cells", "6", "--pairs", "3", "--page", "--out", "study")
    several = NUMBA_NUM_THREADS > 1
    assert code == (0 if several else 3)
    assert "time over mpm" in out
    assert "Measured on" in out
    row = rows_of(tmp_path / "study/tables/speed.csv")[1]
    assert (row["method"], row["nodes"]) == ("cpdi", "16")
    assert markdown([row]).splitlines()[2].startswith("| cpdi | 16 | ")
    assert "Measured on" in (tmp_path / "study/report.html").read_text()
    code, out, _ = verify("bench", "--method", "mpm,cpdi", "--cells", "6", "--pairs", "3", "--json", "--out", "study")
    assert json.loads(out)["outcome"] == ("PASS" if several else "INCONCLUSIVE")


@pytest.mark.parametrize(
    ("options", "said"),
    [(["--cells", "3"], "cells = 3 cannot be timed"), (["--pairs", "1"], "pairs = 1"), (["--ppc", "2"], "not a square"),
     (["--parallel", "0"], "parallel = 0"), (["--smoothing", "deviatoric"], "fbar")],
)  # fmt: skip
def test_what_cannot_be_timed(verify: Call, options: list[str], said: str) -> None:
    assert said in one_line(verify("bench", *options))


def test_the_page_holds_the_table_of_its_runs() -> None:
    """docs/speed.md has the table that docs/speed.csv makes, and names the processor of each row."""
    rows = rows_of(DOCS / "speed.csv")
    text = (DOCS / "speed.md").read_text()
    assert {row["method"] for row in rows} >= {"mpm", "cpdi", "bspline2"}
    assert markdown(rows) in text
    assert {row["processor"] for row in rows} <= set(text.replace("\n", " ").split("*"))
    assert markdown([rows[0] | {"ratio": "9.9"}, *rows[1:]]) not in text
