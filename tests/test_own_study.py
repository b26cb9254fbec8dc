"""A study of a user's own solution: what is expected of it, which cells and time steps fit, how it is named."""

import itertools
import json
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.runner import Ticker
from mpm_verify.cases.mms.deviations import SHOWN
from mpm_verify.cases.mms.execute import execute
from mpm_verify.cases.mms.expectations import expected, promised
from mpm_verify.cases.mms.stability import rounded, speed_parameter
from mpm_verify.mms.cells import check_cells, fits, fitting, ratios, unit
from mpm_verify.reports.sentences import commands
from mpm_verify.solver.plugins import SOLUTIONS, create, label
from mpm_verify.verify.main import main

EXAMPLE = "tests/own_solution.py"
TEXT = """
import sympy as sp
def displacement(X, t, A=0.02, c0=100.0):
    x, y = X
    return A * sp.sin(sp.pi * x / {width}) * sp.sin(sp.pi * y / sp.nsimplify({height})) * sp.sin(sp.pi * c0 * t) \\
        * sp.Matrix([1, 1])
def domain({speed}):
    return {{"lower": (0, 0), "upper": ({width}, {height}), "duration": 0.02, "speed": {c0}{more}}}
"""
USUAL, QUICK = (8, 16, 32, 64, 128), (8, 12, 16, 24, 32)


def write(folder: Path, width: str = "1", height: str = "1", c0: str = "c0", more: str = "") -> str:
    """A clamped rectangle that starts with a velocity; `c0` as a number is no parameter of its speed."""
    path = folder / "own.py"
    path.write_text(TEXT.format(width=width, height=height, c0=c0, more=more, speed="c0=100.0" if c0 == "c0" else ""))
    return str(path)


def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["verify", *words])
    with pytest.raises(SystemExit) as end:
        main()
    said = capsys.readouterr()
    return int(end.value.code or 0), said.out, said.err


# ---- what is expected


def test_the_order_that_a_method_promises() -> None:
    """Where particles cross cells only the CPDI family keeps its order; where none does, all do."""
    kept = {m for m in SHOWN if promised(m, crossing=True) is not None}
    assert kept == {"cpdi", "cpdi2"}
    still = [promised(m, crossing=False) for m in SHOWN]
    assert [found.order for found in still if found] == [2.0] * len(SHOWN)


def test_what_is_expected_of_a_file(tmp_path: Path) -> None:
    """An order of u in rms alone; the file's own order comes first."""
    found = expected("cpdi", EXAMPLE, "neo_hookean", 4, "u", "rms")
    assert found is not None
    assert (found.order, found.source) == (2.0, "declared by the method")
    assert expected("gimp", EXAMPLE, "neo_hookean", 4, "u", "rms") is None
    assert expected("cpdi", EXAMPLE, "neo_hookean", 4, "v", "rms") is None
    assert expected("cpdi", EXAMPLE, "neo_hookean", 1, "u", "rms") is None
    found = expected("gimp", write(tmp_path, more=', "order": 1.5'), "neo_hookean", 4, "u", "rms")
    assert found is not None
    assert (found.order, found.source) == (1.5, "declared in the solution's file")


@pytest.mark.slow
def test_the_example_of_the_readme_passes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The example names no order; it has its file's name; its path stands on the page once, and with each run."""
    out = tmp_path / "out"
    words = ("mms", "--quick", "--page", "--solution", EXAMPLE, "--jobs", "1", "--out", str(out))
    code, said, err = verify(monkeypatch, capsys, *words)
    assert (code, err) == (0, "")
    assert "PASS  cpdi, 4 per cell, u in rms, order 2 expected" in said
    assert "manufactured solution own_solution\n" in said
    page = (out / "report.html").read_text()
    runs = 6  # each has a card with its command
    assert page.count(str(Path(EXAMPLE).resolve())) == 1 + runs
    assert "declared by the method" in page


# ---- cells


def box(width: float, height: float) -> Any:
    return SimpleNamespace(lower=np.array([1.0, -1.0]), upper=np.array([1.0 + width, -1.0 + height]))


@pytest.mark.parametrize("usual", [USUAL, QUICK, (16,), (16, 32, 64)])
def test_cells_that_fit(usual: tuple[int, ...]) -> None:
    """As many levels, each fills the body, near the usual ones; untouched where they fit."""
    for width, height in itertools.product((1, 2, 3, 0.3), (1, 0.7, 0.5, 1 / 3, 0.1, 1.3, 4)):
        body = box(width, height)
        cells, sides = fitting(body, usual), ratios(body)
        assert sides is not None
        assert len(cells) == len(usual)
        assert all(a < b for a, b in itertools.pairwise(cells))
        assert all(fits(count, sides) for count in cells)
        assert 0.85 * usual[0] <= cells[0]
        assert cells[-1] <= max(4 * usual[-1], 5 * 2 * unit(sides))
        assert cells == usual or not all(fits(count, sides) for count in usual)
        assert cells[0] * min(sides) >= 2
        check_cells("own", body, cells)


@pytest.mark.parametrize(
    ("width", "height", "usual", "quick"),
    [
        (2, 1, USUAL, QUICK),
        (1, 0.7, (10, 20, 40, 80, 160), (20, 30, 40, 60, 80)),
        (3, 1, (9, 18, 36, 72, 144), (12, 18, 24, 36, 48)),
        (1, 0.98, (50, 100, 150, 200, 250), (50, 100, 150, 200, 250)),
        (1, 3.14159265, USUAL, QUICK),
    ],
)
def test_which_cells(width: float, height: float, usual: tuple[int, ...], quick: tuple[int, ...]) -> None:
    assert fitting(box(width, height), USUAL) == usual
    assert fitting(box(width, height), QUICK) == quick


def test_cells_that_do_not_fit_are_refused_with_some_that_do() -> None:
    with pytest.raises(ValueError, match=r"8 cells over .* multiples of 10: --cells 10,20,40$") as told:
        check_cells("own.py", box(1, 0.7), (8, 16, 32))
    check_cells("own.py", box(1, 0.7), tuple(map(int, str(told.value).split("--cells ")[1].split(","))))
    with pytest.raises(ValueError, match=r"no square cells fill .* whole numbers up to 64"):
        check_cells("own.py", box(1, 3.14159265), (8,))


@pytest.mark.slow
def test_the_command_chooses_cells_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path, height="0.7")
    words = ("mms", "--solution", path, "--ppc", "1", "--quick", "--out", str(tmp_path / "out"), "--jobs", "1")
    _, said, err = verify(monkeypatch, capsys, *words, "--json")
    assert err == "cells chosen: 20,30,40,60,80, which fill the body as 8,12,16,24,32 do not; --cells takes others\n"
    assert {run["cells"] for run in json.loads(said)["runs"]} == {20, 30, 40, 60, 80}
    code, said, err = verify(monkeypatch, capsys, *words, "--cells", "8,12,16")
    assert (code, said) == (2, "")
    assert err.endswith(": --cells 20,30,40\n")


# ---- time steps


def swept(**axes: Any) -> Any:
    """The study of these axes: one value of each, or a tuple."""
    asked = {key: list(value) if isinstance(value, tuple) else [value] for key, value in axes.items()}
    return build(Asked("mms", asked), "", "t")


def refused(**axes: Any) -> str:
    with pytest.raises(ValueError, match="stability limit") as told:
        swept(**axes)
    assert "\n" not in str(told.value)
    return str(told.value)


def advised(text: str, option: str) -> str:
    return text.split(f"{option} ")[1].split(",")[0].split(";")[0]


@pytest.mark.slow
def test_a_speed_below_that_of_the_waves(tmp_path: Path) -> None:
    """Both ways out are taken as they are typed, run, and are the limit: a little more is refused."""
    path, cells = write(tmp_path), (8, 12)
    text = refused(solution=f"{path}:A=0.03,c0=40", cells=cells, ppc=4)
    assert text.startswith("own:A=0.03,c0=40: with waves at 116")
    assert f"--solution {path}:A=0.03,c0=" in text
    assert text.endswith("; --force runs it all the same")
    courant, c0 = float(advised(text, "--courant")), float(text.split(",c0=")[-1].split(";")[0])
    assert 0.3 < courant < 0.35
    assert 46 < c0 < 50
    slower = swept(solution=f"{path}:A=0.03,c0=40", cells=cells, ppc=4, courant=courant)
    faster = swept(solution=f"{path}:A=0.03,c0={c0:g}", cells=cells, ppc=4)
    for study in (slower, faster):
        assert execute(study.runs[0], Ticker(""))[0].status == "finished"
    refused(solution=f"{path}:A=0.03,c0=40", cells=64, courant=courant * 1.02)
    refused(solution=f"{path}:A=0.03,c0={c0 * 0.98:g}", cells=64)
    swept(solution=f"{path}:A=0.03,c0=40", cells=cells, force=True)


def test_a_speed_that_is_no_parameter(tmp_path: Path) -> None:
    text = refused(solution=write(tmp_path, c0="20"), cells=64)
    least = float(text.split('"speed": ')[1].split(" in domain()")[0])
    swept(solution=write(tmp_path, c0=f"{least:g}"), cells=64)


@pytest.mark.slow
@pytest.mark.parametrize("solution", ["axis_aligned", "swirl:A=0.01", "bar:n=2", "expanding_ring"])
def test_solutions_of_the_library(solution: str) -> None:
    """A stiff material makes the waves fast: the same advice, taken as it is typed."""
    stiff = "neo_hookean:E=1e6"
    text = refused(solution=solution, material=stiff, cells=64)
    courant = float(advised(text, "--courant"))
    swept(solution=solution, material=stiff, cells=64, courant=courant)
    faster = text.split("--solution ")[1].split("; --force")[0]
    swept(solution=faster, material=stiff, cells=64)
    swept(solution=solution, cells=USUAL)


def test_smaller_courant_numbers_stay_in_the_advice() -> None:
    text = refused(material="neo_hookean:E=1e6", cells=64, courant=(0.4, 0.05, 0.01))
    assert "--courant 0.0845,0.05,0.01, or" in text


def test_where_no_courant_number_will_do() -> None:
    """Below 0.001 none is taken, and none is advised."""
    text = refused(material="neo_hookean:E=1e12", cells=64)
    assert "--courant" not in text
    assert "take --solution axis_aligned:C=" in text


def test_a_study_without_end_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, more=', "order": 2')
    Path(path).write_text(Path(path).read_text().replace('"duration": 0.02', '"duration": 1e4'))
    with pytest.raises(ValueError, match=r"own: a run would take 1\.6e\+08 time steps to fill the duration of 10000;"):
        swept(solution=path, cells=64)


BAR = "; mpm has nothing registered on bar1d with 2 per cell: type --order 2, or --solution bar1d:A=1e-6"


@pytest.mark.parametrize(("method", "says"), [("mpm", BAR), ("", "; say what is expected: --order 2, or --as METHOD")])
def test_where_nothing_is_registered_of_the_method_that_was_typed(method: str, says: str) -> None:
    asked = {"solver": [f"{sys.executable} {{case}} {{out}}"], "solution": ["bar1d"], "cells": [8]}
    study = build(Asked("mms", asked | ({"method": [method]} if method else {})), "")
    assert not any(plan.judged for plan in study.plans)
    assert commands.unregistered(study) == says
    assert commands.unregistered(build(Asked("mms", {"method": ["mpm"], "cells": [8]}), "")) == ""


def test_words(tmp_path: Path) -> None:
    assert speed_parameter(create(SOLUTIONS, write(tmp_path))) == "c0"
    assert speed_parameter(create(SOLUTIONS, "axis_aligned:phase=100")) == "C"
    assert label("a/b/own.py:A=1,B=2") == "own:A=1,B=2"
    assert label("axis_aligned:A=1") == "axis_aligned:A=1"
    assert rounded(0.12345, np.floor) == 0.123
    assert rounded(1234.5, np.ceil) == 1240
