"""Stored studies of the paper that were made up: every run of `verify paper --quick`, with numbers of simple formulas.

They are those of a world in which the ledger has claims of every status.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.cases.benchmark.case import Result as BenchmarkResult
from mpm_verify.cases.column.run import ColumnResult, ColumnRun
from mpm_verify.cases.element.run import PROPERTIES, ElementResult
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.mms.run import Result as MmsResult
from mpm_verify.cases.objectivity.axes import KINEMATIC
from mpm_verify.cases.objectivity.result import ObjectivityResult
from mpm_verify.reports.paper.studies import QUICK, studies
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, RATES, available

Made = tuple[Any, dict[str, Any]]
T = np.linspace(0.0, 1.4, 141)
ZERO = ("outside", "lost", "unbalanced", "misworked", "plastic_falls", "most_momentum_lost", "pooled", "unbooked",
        "most_mass_lost", "most_courant", "creep", "creep_fit")  # fmt: skip
ORDERS = {"cpdi": 2.0, "cpdi2": 2.0, "mpm": -0.5}  # over one period


def mms(run: Any) -> Made:
    """Errors of a power of the cell size; MPM converges over a short time alone."""
    order = 0.5 if (run.method, run.periods) == ("mpm", 0.125) else ORDERS.get(run.method, 1.0)
    order = 0.0 if run.damping else order
    error = 1e-2 * run.cells**-order / (run.ppc / 4) ** 0.1
    if run.time_step == "printed":
        failed = Failure(FailureKind.INVERTED, step=1)
        return MmsResult(run=run, digest=run.digest, status="failed", dt=0.1, failure=failed), {}
    steps = 100 * run.cells
    norms = {"rms": error, "max": error, "final": error, "printed": error * (steps * run.particles) ** -0.5}
    each = dict.fromkeys(("u", "v", "F", "sigma"), norms)
    return MmsResult(run=run, digest=run.digest, status="finished", steps=steps, particles=run.particles,
                     dt=0.1 / run.cells, errors=each, scale=dict.fromkeys(each, 1.0),
                     floor=dict.fromkeys(each, 1e-15), cpu_s=1.0), {}  # fmt: skip


def front_of(run: ColumnRun) -> float:
    """Front at rest, m."""
    front = 0.72 + 0.12 * (run.ppc - 1) / 8 if run.ppc < 9 else 0.84 + 0.001 * run.ppc
    front += 0.002 * (run.cells - 7) + 0.14 * (run.aspect - 7) + 0.01 * (run.method == "mpm")
    front -= (1.0 if run.damping_kind == "local" else 1e-3) * run.damping
    front += {"volumetric": 0.02, "volumetric:of=stress": 0.3, "deviatoric:of=stress": -0.1}.get(run.smoothing, 0.0)
    return front - 0.06 * run.material.startswith("ubcsand")


def column(run: ColumnRun) -> Made:
    """Front that grows linearly, energies of a simple shape; the toe is further by a sixth."""
    front, height = front_of(run), 0.1 + 0.004 * run.ppc
    ends = {"front_99": front, "front_999": 1.05 * front, "toe": 1.17 * front}
    curves = {name: 0.0905 + (end - 0.0905) * np.minimum(T / 0.8, 1.0) for name, end in ends.items()}
    curves |= {"t": T, "potential": np.maximum(480 - 400 * T / 0.8, 80 * (1 + run.damping)),
               "on_grid": 100 * (1 - 3 * run.damping) * np.exp(-(((T - 0.3) / 0.1) ** 2))}  # fmt: skip
    values = dict.fromkeys(ZERO, 0.0) | ends | {
        "height": height, "height_fit": 1.3 * height, "crowding": 1.05 if run.ppc > 1 else 2.0, "rest": 0.8,
        "mass": 1.0, "plastic": 380.0, "potential": 80.0, "booked": 1.0,
    }  # fmt: skip
    material = {"E": 840e3, "nu": 0.3, "phi": 31.0, "psi": 1.0, "rho0": 2650.0}
    result = ColumnResult(run=run, digest=run.digest, status="finished", steps=100, particles=run.particles,
                          cpu_s=1e-5 * run.particles * (2.0 if run.method == "cpdi" else 1.0), values=values,
                          parameters=material)  # fmt: skip
    return result, {f"curve_{name}": one for name, one in curves.items()}


def objectivity(run: Any) -> Made:
    """Block that turns as it should, a large one rings; half of the controls are seen."""
    if run.part == KINEMATIC:
        controls = available(NEGATIVE_CONTROLS)
        values = {f"figure2 {name}": 0.5 * (k % 2) for k, name in enumerate(sorted(controls))}
        values |= {f"stretched {name}": 0.1 for name in controls}
        values |= {f"order {name}": 2.0 if name in available(RATES) else 0.0 for name in (*available(RATES), *controls)}
        return ObjectivityResult(run=run, digest=run.digest, status="finished", values=values), {}
    ring = 0.05 if run.L > 0.5 else 0.0
    values = {"xx_ramp": -3 / 7, "yy_ramp": -1.0, "xx_end": -1.0, "yy_end": -3 / 7, "miss": ring, "peak": 0.28,
              "ripple": 0.0, "own_yy": 0.0, "own_xy": 0.0, "early": 0.01, "late": 0.002, "particle": 0.1}  # fmt: skip
    t = np.linspace(0, 2, 41)
    curves = {"t": t, "yy": -np.minimum(t, 1.0) + ring * np.sin(20 * t), "angle": t}
    curves |= dict.fromkeys(("xx", "xy", "own_xy", "own_yy", "shear"), np.zeros(41))
    return (ObjectivityResult(run=run, digest=run.digest, status="finished", values=values),
            {f"mean/{name}": one for name, one in curves.items()})  # fmt: skip


def benchmark(run: Any) -> Made:
    """Spurious force of points alone."""
    force = 0.55 if run.method == "mpm" else 1e-15
    values = {"spurious_force": force, "off_formula": 0.0}
    return BenchmarkResult(run=run, digest=run.digest, status="finished", values=values), {}


def element(run: Any) -> Made:
    """Known values alone, which are met."""
    check = Check("Returns", "made up", 1.0, 1.0, "absolute", "", 0.1)
    known = (check,) if run.test == PROPERTIES else ()
    return ElementResult(run=run, digest=run.digest, status="finished", counts=(1600,), step_errors=(1e-12,),
                         checks=known, parameters={"material Rf": 0.77}), {}  # fmt: skip


MADE: dict[str, Callable[[Any], Made]] = {
    "mms": mms, "column": column, "objectivity": objectivity, "benchmark": benchmark, "element": element,
}  # fmt: skip


def failed(run: Any) -> Made:
    """Run that ends in the first step."""
    result = MADE[run.case](run)[0]
    why = Failure(FailureKind.INVERTED, step=1)
    return replace(result, status="failed", failure=why, errors={}, values={}), {}


@cache
def built() -> dict[str, Study[Any]]:
    """All studies of the quick mode."""
    return {name: one.build(QUICK, f"verify paper --quick --only {name}") for name, one in studies().items()}


def store(folder: Path, make: Callable[[Any], Made] = lambda run: MADE[run.case](run)) -> dict[str, Study[Any]]:
    """Store all studies of the quick mode below the folder."""
    found = built()
    for name, study in found.items():
        into = Store(folder / name, study.case)
        into.create(study)
        for run in study.runs:
            into.put(*make(run))
    return found
