"""`verify methods` and `verify graded`, from the command to the page."""

import json
import re
from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from mpm_verify.solver.plugins import METHODS, available
from mpm_verify.verify.main import application


def run(*arguments: str) -> tuple[int, str]:
    """Exit code and what is printed."""
    done = CliRunner().invoke(application(), list(arguments), standalone_mode=False)
    return (done.return_value if done.exception is None else 2), done.output


@pytest.mark.slow
def test_all_methods_on_the_bar(tmp_path: Path) -> None:
    """Each does what is registered; CPDI beats what stalls at the same cost, and the table says so."""
    code, text = run("methods", "--quick", "--page", "--out", str(tmp_path), "--jobs", "1")
    assert code == 0
    count = len(available(METHODS))
    assert f"{count} of {count} judged quantities PASS, 4 of them as a registered non-convergence." in text
    assert (tmp_path / "figures" / "cost.pdf").stat().st_size > 5000
    cost = pd.read_csv(tmp_path / "tables" / "cost.csv").set_index("method")
    assert set(cost.index) == set(available(METHODS))
    assert cost.updates.nunique() == 1  # the same particles and steps for all
    assert cost.relative_error["cpdi"] < 0.05 * cost.relative_error["gimp"] < 0.05 * cost.relative_error["mpm"]
    assert cost.loc["cpdi", "updates_at_0.01"] < cost.updates["cpdi"]
    assert pd.isna(cost.loc["mpm", "updates_at_0.01"])
    page = (tmp_path / "report.html").read_text()
    assert "Methods compared: error against cost" in page
    code, text = run("methods", "--quick", "--out", str(tmp_path), "--json")
    assert code == 0
    assert {v["verdict"] for v in json.loads(text)["verdicts"]} == {"PASS"}


@pytest.mark.slow
def test_the_vortex_tells_rotation(tmp_path: Path) -> None:
    """On one grid: CPDI and CPDI2 go on, domains that do not turn cannot, and classical MPM loses its det F."""
    methods = [part for name in ("mpm", "cpgimp", "gimp", "cpdi", "cpdi2") for part in ("--method", name)]
    code, text = run("mms", *methods, "--solution", "generalised_vortex", "--cells", "48", "--ppc", "4",
                     "--out", str(tmp_path), "--json")  # fmt: skip
    assert code == 3  # one grid decides nothing
    runs = {r["method"]: r for r in json.loads(text)["runs"]}
    assert {m for m, r in runs.items() if r["status"] == "finished"} == {"gimp", "cpdi", "cpdi2"}
    assert runs["cpgimp"]["failure"]["kind"] == "domain_too_wide"
    assert "wider than two cells" in runs["cpgimp"]["reason"]
    assert runs["mpm"]["failure"]["kind"] == "inverted"
    gaps = {m: runs[m]["gap"] for m in ("gimp", "cpdi", "cpdi2")}
    assert gaps["gimp"] > 2 * gaps["cpdi"] > 2 * gaps["cpdi2"] * 0.9
    assert runs["cpdi"]["errors"]["u"]["rms"] == pytest.approx(1.99e-2, rel=0.05)


def test_graded_against_uniform(tmp_path: Path) -> None:
    code, text = run("graded", "--method", "cpdi", "--solution", "localised", "--cells", "8,16", "--ppc", "4",
                     "--out", str(tmp_path))  # fmt: skip
    assert code == 3  # nothing is registered of layouts
    assert re.search(r"localised +CPDI +thinned +u +0\.5", text)
    assert "Graded layouts: error against cost" in (tmp_path / "report.html").read_text()
    code, text = run("graded", "--solution", "expanding_ring", "--out", str(tmp_path / "ring"))
    assert code == 2
