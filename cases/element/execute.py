"""Execution of one element test: with once to sixteen times the steps, or the checks of the material beside curves."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mpm_verify.cases.element.checks import material_checks
from mpm_verify.cases.element.path_file import from_file
from mpm_verify.cases.element.paths import TESTS, ElementTest
from mpm_verify.cases.element.run import PATH, PROPERTIES, ElementResult, ElementRun
from mpm_verify.cases.element.study import study
from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.harness.study import Arrays, parameters
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.plugins import MATERIALS, create


def test_of(run: ElementRun) -> ElementTest:
    """Test of a run. Raises ValueError for a file that does not hold a path."""
    return from_file(Path(run.path), run.units, run.motion) if run.test == PATH else TESTS[run.test]


def execute(run: ElementRun, tick: Callable[[float], None] = lambda fraction: None) -> tuple[ElementResult, Arrays]:
    """Run one test; one that cannot go on says where, and why."""
    use_threads(1)  # four rows at a time
    started, used = time.perf_counter(), time.process_time()
    material = create(MATERIALS, run.material)
    arrays: Arrays = {}
    found: dict[str, Any] = {}
    if run.test == PROPERTIES:
        found = {"checks": tuple(material_checks(material))}
    else:
        test = test_of(run)
        one = study(material, test, run.stress, run.steps, run.start)
        found = {"source": one.source, "stopped": one.failed, "counts": one.steps, "step_errors": one.errors,
                 "read": test.source}  # fmt: skip
        arrays = {f"curve/{name}": values for name, values in one.curve.items()}
        arrays |= {f"exact/{name}": values for name, values in (one.truth or {}).items()}
    result = ElementResult(
        run=run, digest=run.digest, status="finished", environment=environment(),
        parameters=parameters("material", material), wall_s=time.perf_counter() - started,
        cpu_s=time.process_time() - used, **found,
    )  # fmt: skip
    return result, arrays
