"""Adapters of public codes, and the page made of what they gave: it is what the script makes of the stored results.

The adapters run where their program is: with the interpreter that ADAPTERS_PYTHON names, else with this one; `make
adapters` makes such an environment. Elsewhere they are skipped.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from math import log
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fixtures_command import TOP

from mpm_verify.cases.mms.external.execute import execute
from mpm_verify.cases.mms.run import Run
from mpm_verify.solver.plugins import MATERIALS, create

ADAPTERS = TOP / "examples" / "adapters"
PROGRAMS = {"kratos": "KratosMultiphysics.MPMApplication", "mpm99": "taichi", "newton": "newton"}
BUILT = {"sparkl": [ADAPTERS / "sparkl" / "built" / f"sparkl_{kind}.so" for kind in ("published", "f32", "f64")]}
PYTHON = os.environ.get("ADAPTERS_PYTHON", sys.executable)


@pytest.fixture(scope="module")
def scripts() -> Iterator[tuple[Any, Any]]:
    """The modules study and page."""
    sys.path.insert(0, str(ADAPTERS))
    yield import_module("study"), import_module("page")
    sys.path.remove(str(ADAPTERS))


# ---- the page


def test_the_page_is_made_of_the_stored_results(scripts: tuple[Any, Any]) -> None:
    _, page = scripts
    assert page.page() == page.PAGE.read_text(encoding="utf-8")


def test_a_changed_result_changes_the_page(scripts: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    study, page = scripts
    for name in study.studies():
        found = page.stored(name)
        found["runs"][0]["u"] *= 1.01
        with monkeypatch.context() as changed:
            changed.setattr(page, "stored", lambda one, name=name, found=found, stored=page.stored: (
                found if one == name else stored(one)
            ))  # fmt: skip
            assert page.page() != page.PAGE.read_text(encoding="utf-8"), name


def changed(page: Any, monkeypatch: pytest.MonkeyPatch, name: str, change: Callable[[dict[str, Any]], None]) -> None:
    """Let a stored result be read with a change."""
    usual, found = page.stored, page.stored(name)
    change(found)
    monkeypatch.setattr(page, "stored", lambda one: found if one == name else usual(one))


def test_what_refutes_another_quantity_is_told(scripts: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    _, page = scripts
    assert page.reasons("FAIL", "v", "F", "sigma") == "- none"

    def stay(found: dict[str, Any]) -> None:
        for row in found["runs"]:
            row["F"] = 1e-6

    changed(page, monkeypatch, "mpm99", stay)
    assert page.reasons("FAIL", "v", "F", "sigma").startswith("- 12, F: ")
    assert "| PASS, F FAIL |" in page.page()


def test_verdicts_are_those_of_the_rule_on_the_stored_errors(
    scripts: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """None is stored, and each follows from what is: errors, the floor, and half the time step."""
    study, page = scripts
    assert not any({"verdict", "refuted"} & page.stored(name).keys() for name in study.studies())
    one = study.studies()["kratos_usl"]

    def said(change: Callable[[dict[str, Any]], None]) -> str:
        found = page.stored("kratos_usl")
        change(found)
        outcome, reason = page.verdicts(one, found)["u"]
        return f"{outcome}: {reason}"

    def first_order(found: dict[str, Any]) -> None:
        for row in found["runs"]:
            row["u"] = 1e-6 / row["cells"]

    assert said(lambda found: None).startswith("PASS: order 2.02 (97.5 % interval 2.01 to 2.04, last pair 2.02)")
    assert said(first_order).startswith("FAIL: ")
    assert said(lambda found: found["half"].update(u=0.6 * found["half"]["u"])).startswith("INCONCLUSIVE: coupled")
    assert "round-off floor" in said(lambda found: found["runs"][-1]["floor"].update(u=1e-9))
    assert "small enough" in said(lambda found: found.update(half=None))


def test_orders_and_digits_of_the_page(scripts: tuple[Any, Any]) -> None:
    _, page = scripts
    runs = [{"cells": 8, "u": 4.0e-3}, {"cells": 16, "u": 1.0e-3}, {"cells": 24, "u": 1.5e-3}]
    assert page.orders(runs) == "2.00 -1.00"
    assert page.digits({"runs": runs}) == ""
    assert page.digits({"runs": runs, "reference": [4.0e-3, 1.0e-3, 1.5e-3]}) == "all 7"
    assert page.digits({"runs": runs, "reference": [4.0e-3, 1.001e-3, 1.5e-3]}) == "3.0"


def test_stored_results_are_those_of_the_studies(scripts: tuple[Any, Any]) -> None:
    """Levels, references, and the digits that the codes are known by."""
    study, page = scripts
    for name, one in study.studies().items():
        found = page.stored(name)
        assert [row["cells"] for row in found["runs"]] == one["cells"], name
        assert len(found.get("reference", [])) == (len(one["cells"]) if "reference" in one else 0)
        assert all(row.keys() - {"cells", "floor"} == row["floor"].keys() for row in found["runs"]), name
        if found["half"]:  # of the finest cells; none where the path of the time step is given, or none is needed
            assert found["half"]["cells"] == one["cells"][-1], name
        assert (ADAPTERS / one["code"] / one.get("script", "adapter.py")).is_file()
    assert {path.stem for path in study.RESULTS.glob("*.json")} == {
        *study.studies(), *study.COMPARED, "kratos_smallest", "newton_smallest", "sparkl_smallest",
    }  # fmt: skip
    assert page.level("kratos_usl", 8) == "7.253e-8"
    assert page.digits(page.stored("kratos_usl")) == "all 7"


# ---- the constitutive model of mpm99


def test_fixed_corotated_has_the_stress_of_its_energy() -> None:
    """Stress as dW/dF Fᵀ / J, by differences of the energy; zz too."""
    model: Any = create(MATERIALS, str(ADAPTERS / "mpm99" / "fixed_corotated.py"))
    F, h = np.array([[1.1, 0.2, 0.0], [-0.15, 0.9, 0.0], [0.0, 0.0, 1.0]]), 1e-6
    P = np.zeros((3, 3))
    for i, j in np.ndindex(3, 3):
        step = np.zeros((3, 3))
        step[i, j] = h
        ends = [model.energy((F + sign * step).tolist(), log) for sign in (1, -1)]
        P[i, j] = (ends[0] - ends[1]) / (2 * h)
    sigma = P @ F.T / np.linalg.det(F)
    particle = SimpleNamespace(F=F[None, :2, :2], sigma=np.zeros((1, 4)))
    model.update(particle, 0.0)
    assert particle.sigma[0] == pytest.approx(sigma[(0, 1, 2, 0), (0, 1, 2, 1)], rel=1e-7)
    assert abs(sigma[0, 1]) > 10


# ---- the codes themselves


def needs(code: str) -> None:
    """Skip what the interpreter has no program for, or what is not built."""
    if code in BUILT:
        if not all(file.is_file() for file in BUILT[code]):
            pytest.skip("sparkl2d is not built: run python examples/adapters/sparkl/build.py f32 f64 published")
        return
    probe = "import importlib.util as u, sys; sys.exit(u.find_spec(sys.argv[1]) is None)"
    if subprocess.run([PYTHON, "-c", probe, PROGRAMS[code]], capture_output=True).returncode:
        pytest.skip(f"{PYTHON} has no {PROGRAMS[code]}: run make adapters")


def rerun(study: Any, name: str, cells: int) -> dict[str, float]:
    """Errors of a level of a study, rms, run anew."""
    one = study.studies()[name]
    words = study.command(one, PYTHON)
    given = dict(zip(words[2::2], words[3::2], strict=True))
    run = Run(solver=given["--solver"], solution=one["solution"], material=one.get("material", "neo_hookean"),
              cells=cells, ppc=4, courant=float(given.get("--courant", study.COURANT)),
              precision=given.get("--precision", "double"), time_step=given.get("--time-step", "h"))  # fmt: skip
    result, _ = execute(run)
    assert result.status == "finished", (result.failure, result.log)
    return {quantity: norms["rms"] for quantity, norms in result.errors.items()}


# rounding grows over the steps; the last is in single precision
SAME = {"kratos": 1e-5, "mpm99": 1e-5, "sparkl": 1e-5, "newton": 1e-2}
LEVELS = [("kratos_usl", 8), ("kratos_usl", 12), ("kratos_usl_bump", 8), ("kratos_usl_axis_aligned", 8),
          ("kratos_musl", 8), ("kratos_usf", 8), ("kratos_central_difference", 8),
          ("kratos_central_difference_b_start", 8), ("kratos_newmark", 8), ("kratos_usl_large", 12),
          ("kratos_usl_large_tolerance", 12), ("mpm99", 8), ("mpm99_F_at_0", 8),
          ("sparkl", 8), ("sparkl_walls", 8), ("newton", 8)]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("name", "cells"), LEVELS)
def test_a_code_gives_what_is_stored(
    scripts: tuple[Any, Any], name: str, cells: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    study, page = scripts
    code = study.studies()[name]["code"]
    needs(code)
    monkeypatch.chdir(TOP)
    (kept,) = [row for row in page.stored(name)["runs"] if row["cells"] == cells]
    found = rerun(study, name, cells)
    assert found == pytest.approx({quantity: kept[quantity] for quantity in found}, rel=SAME[code])


@pytest.mark.slow
def test_the_tiny_solver_without_spin_gives_what_is_stored(
    scripts: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Program of ours that needs none of the others: u has the digits of the code that leaves the spin out."""
    study, page = scripts
    monkeypatch.setitem(globals(), "PYTHON", sys.executable)
    monkeypatch.chdir(TOP)
    found = rerun(study, "tiny_symmetric", 8)["u"]
    assert found == pytest.approx(page.stored("tiny_symmetric")["runs"][0]["u"], rel=1e-6)
    assert found == pytest.approx(page.stored("kratos_usl_large")["runs"][0]["u"], rel=1e-4)
    assert abs(found / page.stored("kratos_usl_large")["reference"][0] - 1) > 0.01


def test_a_comparison_says_where_a_code_parts_from_the_reference(scripts: tuple[Any, Any]) -> None:
    """Second digit of u: 7.608e-3 where hats have 7.501e-3."""
    study, page = scripts
    (found,) = (page.stored(name) for name in study.COMPARED)
    assert found["outcome"] == "parts"
    assert {one["quantity"]: (one["frame"], one["particle"]) for one in found["partings"]} == {
        "u": (1, 153),
        "v": (1, 153),
    }
    assert all(sentence in page.page() for sentence in found["sentences"])


@pytest.mark.slow
def test_a_comparison_gives_what_is_stored(scripts: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    study, page = scripts
    needs("kratos")
    monkeypatch.chdir(TOP)
    for name in study.COMPARED:
        assert study.compared(name, PYTHON)["partings"] == page.stored(name)["partings"]


@pytest.mark.slow
@pytest.mark.parametrize("code", ["kratos", "newton", "sparkl"])
def test_the_smallest_experiments_give_what_is_stored(scripts: tuple[Any, Any], code: str) -> None:
    _, page = scripts
    needs(code)
    done = subprocess.run([PYTHON, str(ADAPTERS / code / "smallest.py")], capture_output=True, text=True, check=True)
    found = json.loads(done.stdout[done.stdout.index("\n{\n") if not done.stdout.startswith("{") else 0 :])
    kept = page.stored(f"{code}_smallest")
    assert list(flat(found)) == pytest.approx(list(flat(kept)), rel=1e-5, abs=1e-12)


def flat(tree: Any) -> Iterator[float]:
    """Numbers of a document in their order; a text counts by its characters."""
    if isinstance(tree, dict | list):
        for part in tree.values() if isinstance(tree, dict) else tree:
            yield from flat(part)
    else:
        yield from [float(tree)] if isinstance(tree, int | float) else map(float, tree.encode())
