"""Run-out against aspect: forms of the scaling by their quoted numbers, which runs make a line, figure and table."""

import json
from pathlib import Path
from typing import Any

import pytest
from fixtures_command import process

from mpm_verify.cases.column.aspect import ENOUGH, lines, scaling
from mpm_verify.cases.column.records import FinishedRun
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.reports.figures.aspect import run_out

WIDTH = ColumnRun().width


def ended(front: float = 0.5, **chosen: Any) -> FinishedRun:
    return FinishedRun(ColumnRun(**chosen), {"front_99": front, "toe": 1.1 * front, "crowding": 1.0}, {})


@pytest.mark.parametrize(
    ("aspect", "low", "high"),
    [(0.5, 0.6, 0.8), (1.0, 1.2, 1.6), (2.0, 2.4, 3.492), (4.0, 4.788, 5.544), (7.0, 6.953, 8.050)],
)
def test_band_holds_all_that_the_law_is_quoted_as(aspect: float, low: float, high: float) -> None:
    """Numbers of the table of quoted forms; both scalings where one goes over into the other."""
    assert scaling(aspect) == pytest.approx((low, high), rel=1e-3)


def test_a_line_has_runs_that_differ_in_aspect_and_in_cells() -> None:
    ran = [ended(WIDTH * (1 + a), aspect=a, cells=c, ppc=p) for p in (4, 9) for a, c in ((7.0, 6), (0.5, 24), (2.0, 6))]
    found = lines(ran, ("aspect", "cells", "ppc"))
    assert [line.shared for line in found] == [{"ppc": 4}, {"ppc": 9}]
    assert [(at.aspect, at.cells) for at in found[0].points] == [(0.5, 12), (2.0, 12), (7.0, 42)]
    assert [at.run_out for at in found[1].points] == pytest.approx([0.5, 2.0, 7.0])
    assert [at.by["toe"] for at in found[1].points] == pytest.approx([0.65, 2.3, 7.8])


def test_what_is_no_line() -> None:
    ran = [ended(aspect=a, cells=6) for a in (1.0, 2.0)]
    assert lines(ran, ("aspect",)) == []  # two points
    assert lines([*ran, ended(aspect=7.0, cells=6)], ("cells",)) == []  # of another study


def test_figure_holds_every_run_even_one_that_does_not_run_out() -> None:
    ran = [ended(front, aspect=a, cells=6) for a, front in ((1.0, 0.5 * WIDTH), (2.0, 0.3), (7.0, 0.8))]
    figure = run_out(lines(ran, ("aspect",)), ["here"])
    low, high = figure.axes[0].get_ylim()
    assert 0 < low < high
    assert len(figure.axes[0].get_lines()[-1].get_xdata()) == 3


@pytest.mark.slow
def test_page_shows_run_out_against_aspect(tmp_path: Path) -> None:
    """A study of squat columns of few cells, told as that."""
    study = tmp_path / "aspect.toml"
    study.write_text("[run]\ncells = 4\nppc = 4\nduration = 0.2\n[sweep]\naspect = [0.5, 1.0, 2.0]\n")
    done = process("sweep", str(study), "--out", str(tmp_path / "out"))
    text = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "Run-out against aspect" in text, done.err
    assert f"fewer than {ENOUGH} cells of the height" in text
    assert "(few)" in text
    assert json.loads((tmp_path / "out" / "study.json").read_text())["runs"]
