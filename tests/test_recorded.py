"""Recorded errors, small amplitudes and the separation by rotation, run anew."""

import pytest

from mpm_verify.cases.harness.runner import InProcess, run_study
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.verdicts import findings
from mpm_verify.cases.mms.execute import execute
from mpm_verify.cases.mms.methods import build_methods
from mpm_verify.cases.mms.recorded import table
from mpm_verify.cases.mms.recording import runs
from mpm_verify.cases.mms.run import Result, Run
from mpm_verify.solver.plugins import MATERIALS, METHODS, SOLUTIONS, available, canonical, create

pytestmark = pytest.mark.slow


def one(method: str, solution: str, cells: int, ppc: int = 4) -> Result:
    """A run as studies do it."""
    material = canonical(MATERIALS, create(SOLUTIONS, solution).material)
    return execute(Run(method, solution, material, cells, ppc, 0.4))[0]


AGAIN = [run for run in runs() if run.cells == 16 or (run.cells == 64 and run.method in ("cpdi", "cpdi2"))]


@pytest.mark.parametrize("run", AGAIN, ids=lambda run: f"{run} {run.method} {run.solution} {run.stress}")
def test_recorded_errors(run: Run) -> None:
    """Ten times as near as the order rule asks for."""
    result, rows = execute(run)[0], table().get((run.solution, run.method, str(run.ppc), run.stress), [])
    known = next((errors for cells, errors in rows if cells == run.cells), None)
    assert (known is None) == (result.status == "failed")
    for quantity, error in (known or {}).items():
        assert result.errors[quantity]["rms"] == pytest.approx(error, rel=1e-3), quantity


def test_each_run_of_the_table_is_one_that_is_made() -> None:
    made = {(run.solution, run.method, str(run.ppc), run.stress, run.cells) for run in runs()}
    stored = {(*key, cells) for key, rows in table().items() for cells, _ in rows}
    assert stored <= made
    assert len(stored) > 0.95 * len(made)  # what is missing are runs that fail


@pytest.mark.parametrize("solution", ["axis_aligned:A=1e-6", "clamped_shear:G=1e-6"])
def test_all_methods_are_of_second_order_while_nothing_crosses(solution: str, tmp_path) -> None:
    study = build_methods(available(METHODS), {solution: (16, 24, 32, 48, 64)}, (4,), "verify", "small")
    store = Store(tmp_path)
    store.create(study)
    results = run_study(study, store, InProcess(), 1)
    found = {f.plan.run.method: str(f.verdict.outcome) for f in findings(study, results) if f.plan.judged}
    assert found == dict.fromkeys(available(METHODS), "PASS")
    assert all(result.crossings == 0 for result in results.values())


def test_the_vortex_separates_cpdi_from_gimp() -> None:
    """On coarse grids their errors are alike; from 96 cells on GIMP stalls and CPDI goes on."""
    errors = {(m, n): one(m, "generalised_vortex", n).errors["u"]["rms"] for m in ("gimp", "cpdi") for n in (96, 128)}
    assert errors["gimp", 96] > errors["gimp", 128] * 0.7  # hardly falls, if at all
    assert errors["cpdi", 96] / errors["cpdi", 128] == pytest.approx((128 / 96) ** 2, rel=0.1)
    assert errors["gimp", 128] > 2 * errors["cpdi", 128]
