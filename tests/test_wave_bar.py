"""The wave bar: its measure and closed form, and that store, rule, replicates and exports come with it."""

import json
import sys
from dataclasses import replace
from math import log2, pi
from pathlib import Path
from xml.etree import ElementTree

import jsonschema
import numpy as np
import pytest

from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.wave_bar import execute as runs
from mpm_verify.cases.wave_bar.execute import execute, frequency
from mpm_verify.cases.wave_bar.run import Run
from mpm_verify.reports.export.document import schema
from mpm_verify.solver.failure import FailureKind
from mpm_verify.verify.main import main


def error(**axes: object) -> float:
    return execute(Run(**axes))[0].errors["frequency"]["relative"]  # type: ignore[arg-type]


@pytest.mark.parametrize("omega", [1.0, 3.7, 40.0])
def test_the_frequency_of_a_sine_is_measured(omega: float) -> None:
    """The miss falls with the cube of the step at least."""
    t = [np.linspace(0, 13.0 / omega, n) for n in (101, 201)]
    coarse, fine = (abs(frequency(x, np.sin(omega * x)) / omega - 1) for x in t)
    assert coarse < 1e-4
    assert fine < coarse / 6
    assert np.isnan(frequency(t[0], np.ones(101)))  # no zero, no frequency


@pytest.mark.slow
@pytest.mark.parametrize("method", ["mpm", "cpdi", "gimp"])
@pytest.mark.parametrize("courant", [0.1, 0.4, 0.6])
def test_the_error_is_that_of_the_closed_form(method: str, courant: float) -> None:
    """(pi h / L)^2 ((1 - C^2) / 24 + 3/32) with particles at the quarter points, up to the next order in h."""
    for cells in (32, 64):
        exact = (pi / cells) ** 2 * ((1 - courant**2) / 24 + 3 / 32)
        assert error(method=method, cells=cells, courant=courant) == pytest.approx(exact, rel=4 / cells)


@pytest.mark.parametrize(("method", "low"), [("cpdi", 1.97), ("bspline2", 1.93), ("bspline3", 1.88)])
def test_second_order(method: str, low: float) -> None:
    found = [error(method=method, cells=n) for n in (8, 16, 32)]
    assert low < log2(found[0] / found[1]) < log2(found[1] / found[2]) < 2.02


def test_other_materials_have_their_own_wave() -> None:
    """The error does not depend on the stiffness or the density: only the wave does."""
    usual = error(cells=16)
    for material in ("neo_hookean:E=3e5,nu=0.1", "linear_elastic:rho0=7"):
        assert error(cells=16, material=material) == pytest.approx(usual, rel=1e-5)


def verify(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["verify", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


QUICK = ("wave_bar", "--quick", "--jobs", "1", "--out", "study")


def test_the_command_judges_and_stores(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert verify(monkeypatch, *QUICK, "--json", "--junit", "out.xml") == 0
    document = json.loads(capsys.readouterr().out)
    jsonschema.validate(document, schema("wave_bar"))
    (verdict,) = document["verdicts"]
    assert (verdict["verdict"], verdict["expected"], verdict["quantity"]) == ("PASS", 2.0, "frequency")
    suite = ElementTree.parse("out.xml").getroot()
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("1", "0", "0")
    stored = {file: file.read_bytes() for file in Path("study/runs").iterdir()}
    assert verify(monkeypatch, *QUICK, "--page") == 0  # nothing is run again, and the page is drawn
    assert {file: file.read_bytes() for file in Path("study/runs").iterdir()} == stored
    assert "PASS" in Path("study/report.html").read_text()
    assert verify(monkeypatch, "list") == 0
    assert "First axial mode of an elastic bar" in capsys.readouterr().out


def test_a_wrong_modulus_is_seen(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Half a per cent of stiffness: the error stops falling, and stays away from the recorded one."""
    monkeypatch.chdir(tmp_path)
    right = runs.setup

    def wrong(run: Run) -> object:
        model, omega, steps = right(run)
        model.material = replace(model.material, E=1.005 * model.material.E)  # type: ignore[type-var, attr-defined]
        return model, omega, steps

    monkeypatch.setattr(runs, "setup", wrong)
    assert verify(monkeypatch, *QUICK, "--no-page", "--cells", "8,16,32,64") == 1


def test_an_unstable_step_is_a_failed_run() -> None:
    result, _ = execute(Run(courant=1.2))
    assert result.failure
    assert result.failure.kind is FailureKind.UNSTABLE_STEP
    assert result.errors == {}


def test_axes_and_replicates() -> None:
    asked = Asked("wave_bar", {"method": ["cpdi", "mpm"], "cells": [8, 16], "ppc": [4]}, replicates=3)
    study = build(asked, "verify wave_bar")
    table = [run for run in study.runs if run.offset == (0, 0) and run.courant == 0.4]
    assert [(run.method, run.cells) for run in table] == [("cpdi", 8), ("cpdi", 16), ("mpm", 8), ("mpm", 16)]
    assert sum(run.offset != (0, 0) for run in study.runs) == 2 * len(table)
    assert sum(run.courant == 0.2 for run in study.runs) == 2  # half the time step on the finest cells
    assert len(study.plans) == 2
    assert case_named("wave_bar").expectation(replace(table[0], transfer="pic"), "frequency", "relative") is None
