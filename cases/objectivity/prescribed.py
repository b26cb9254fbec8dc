"""Execution of the rates and negative controls along prescribed motions, which need no grid."""

from collections.abc import Callable

import numpy as np

from mpm_verify.cases.harness.checks import Check, Curves
from mpm_verify.cases.harness.stopwatch import Stopwatch
from mpm_verify.cases.harness.study import Arrays, parameters
from mpm_verify.cases.objectivity import rates as kinematic
from mpm_verify.cases.objectivity.axes import Block
from mpm_verify.cases.objectivity.result import ObjectivityResult
from mpm_verify.mms.constitutive.simple_shear import SIMPLE_SHEAR
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, RATES, available

MISS = 0.1  # of the stress: what a negative control has to miss by
COARSE = 4  # steps of the stretched turn at which a control of first order is told from a rate


def execute(run: Block, tick: Callable[[float], None] = lambda fraction: None) -> tuple[ObjectivityResult, Arrays]:
    """Follow all motions."""
    stopwatch = Stopwatch()
    curves, checks, values = prescribed(run)
    result = ObjectivityResult(
        run=run, digest=run.digest, status="finished", checks=checks, values=values, particles=run.particles,
        dt=1 / run.steps, parameters=parameters("material", run.material), **stopwatch.told(),
    )  # fmt: skip
    return result, {f"{name}/{key}": values for name, curve in curves.items() for key, values in curve.items()}


def prescribed(run: Block) -> tuple[Curves, tuple[Check, ...], dict[str, float]]:
    """Rates and negative controls along prescribed motions: `errors/NAME`, `figure2/NAME`, `computed/NAME`."""
    rates = (*available(RATES), *available(NEGATIVE_CONTROLS))
    errors = {name: kinematic.order_errors(name) for name in rates}
    checks = [*kinematic.figure2_checks(run), *kinematic.order_checks(errors), *kinematic.shear_checks()]
    kept: Curves = {f"figure2/{name}": kinematic.figure2(run, name) for name in available(NEGATIVE_CONTROLS)}
    values = {f"order {name}": kinematic.slope(error) for name, error in errors.items()}
    for name in available(NEGATIVE_CONTROLS):
        values[f"figure2 {name}"] = kinematic.distance(run, kept[f"figure2/{name}"])
        values[f"stretched {name}"] = float(errors[name][-1])
    for name, error in errors.items():
        right = np.full(len(error), float(name in available(RATES)))
        kept[f"errors/{name}"] = {"steps": np.array(kinematic.STEPS, float), "error": error, "right": right}
    gamma, marks = np.linspace(0, 8, 161), np.linspace(0, 8, 17)[1:]
    for name in available(RATES):
        stress = SIMPLE_SHEAR[name](gamma)
        path = np.array([kinematic.simple_shear(name, g, int(50 * g)) for g in marks])
        kept[f"shear/{name}"] = {"gamma": gamma, "s11": stress[:, 0], "s12": stress[:, 2]}
        kept[f"computed/{name}"] = {"gamma": marks, "s11": path[:, 0], "s12": path[:, 1]}
    return kept, (*checks, *control_checks()), values


def control_checks() -> list[Check]:
    """Checks that negative controls, and no rates, miss by a tenth of the stress in few steps of the stretched turn."""
    checks = []
    for name in (*available(NEGATIVE_CONTROLS), *available(RATES)):
        miss = float(kinematic.order_errors(name, (COARSE,))[0])
        wrong = name in available(NEGATIVE_CONTROLS)
        source = "a control has to be seen" if wrong else "a rate must not look like one"
        what = f"{name}: miss after {COARSE} steps"
        checks.append(Check(kinematic.CONTROLS, what, miss, MISS, "at_least" if wrong else "at_most", source))
    return checks
