"""`verify objectivity`: everything about frame indifference that needs no soil, as one Examination."""

from concurrent.futures import Executor

import numpy as np

from mpm_verify.cases.harness.checks import Check, Curves, Examination
from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.objectivity import block as full
from mpm_verify.cases.objectivity import rates as kinematic
from mpm_verify.cases.objectivity.exact import SIMPLE_SHEAR, ramped_column
from mpm_verify.cases.objectivity.findings import CONTROLS, ObjectivityRemark, findings
from mpm_verify.cases.objectivity.turning_block import Block
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, RATES, available
from mpm_verify.solver.state import Floats

MISS = 0.1  # of the stress: what a negative control has to miss by
COARSE = 4  # steps of the stretched turn at which a control of first order is told from a rate


def examine(block: Block, executor: Executor, command: str) -> Examination:
    """All parts; the runs go to the executor, and the rest is done meanwhile."""
    waiting = full.start(block, executor)
    rates = (*available(RATES), *available(NEGATIVE_CONTROLS))
    errors = {name: kinematic.order_errors(name) for name in rates}
    controls = {name: kinematic.figure2(block, name) for name in available(NEGATIVE_CONTROLS)}
    checks = [*kinematic.figure2_checks(block), *kinematic.order_checks(errors), *kinematic.shear_checks()]
    found = {name: future.result() for name, future in waiting.items()}
    checks = [*full.checks(block, found), *checks, *control_checks()]
    kept = curves(block, found, errors, controls)
    return Examination(
        "objectivity",
        "Frame indifference of the paper's rotated block",
        command,
        tuple(findings(block, checks, kept, errors)),
        tuple(checks),
        parameters(block),
        ORIGINS,
        environment(),
        kept,
    )


def control_checks() -> list[Check]:
    """In few steps along the stretched turn every negative control misses by a tenth of the stress, and no rate
    does."""
    checks = []
    for name in (*available(NEGATIVE_CONTROLS), *available(RATES)):
        miss = float(kinematic.order_errors(name, (COARSE,))[0])
        wrong = name in available(NEGATIVE_CONTROLS)
        source = "visible miss of a control" if wrong else "invisible miss of a rate"
        what = f"{name}: miss after {COARSE} steps"
        checks.append(Check(CONTROLS, what, miss, MISS, "at least" if wrong else "at most", source))
    return checks


def curves(block: Block, found: full.Found, errors: dict[str, Floats], controls: Curves) -> Curves:
    """What the page draws."""
    exact = kinematic.exact_figure2(block, np.linspace(0, 2, 401))
    kept: Curves = {"exact": exact}
    kept |= {f"run/{name}": run["mean"] for name, (run, _) in found.items() if run["mean"]["t"].size}
    t = np.linspace(0, 1, 201)
    kept["wave"] = {"t": t, "yy": ramped_column(t, block.law.wave_speed(), block.L)}
    kept |= {f"field/{name}": run["field"] for name, (run, _) in found.items()}
    kept |= {f"figure2/{name}": curve for name, curve in controls.items()}
    right = available(RATES)
    for name, error in errors.items():
        kept[f"errors/{name}"] = {
            "steps": np.array(kinematic.STEPS, float),
            "error": error,
            "right": np.full(len(error), float(name in right)),
        }
    for name, curve in controls.items():
        away = max(
            float(np.abs(curve[c] - kinematic.exact_figure2(block, curve["t"])[c]).max()) for c in ("xx", "yy", "xy")
        )
        run, failure = found[name]
        miss = np.inf if failure else full.misses(run["mean"], block).max()
        kept[f"control/{name}"] = {
            "kinematic": np.array([away]),
            "run": np.array([miss]),
            "stretched": errors[name][-1:],
        }
    gamma = np.linspace(0, 8, 161)
    marks = np.linspace(0, 8, 17)[1:]
    for name in right:
        stress = SIMPLE_SHEAR[name](gamma)
        kept[f"shear/{name}"] = {"gamma": gamma, "s11": stress[:, 0], "s12": stress[:, 2]}
        law_path = np.array([kinematic.simple_shear(name, g, int(50 * g)) for g in marks])
        kept[f"computed/{name}"] = {"gamma": marks, "s11": law_path[:, 0], "s12": law_path[:, 1]}
    return kept


def parameters(block: Block) -> dict[str, float | str]:
    """Parameters of the run; ORIGINS says which the paper does not give."""
    return {
        "E [Pa]": block.E,
        "nu": block.nu,
        "side of the block [m]": block.L,
        "gravity [m/s^2]": block.g,
        "density [kg/m^3]": block.rho0,
        "cells along the block": block.cells,
        "particles per cell": block.ppc,
        "time step [s]": 1 / block.steps,
        "Courant number": block.courant,
        "unit of stress [Pa]": abs(block.sigma_v),
        "inertial fraction w^2 L / g": block.share,
    }


ORIGINS: dict[str, str] = {
    "E [Pa]": ObjectivityRemark.PAPER,
    "nu": ObjectivityRemark.PAPER,
    "side of the block [m]": ObjectivityRemark.UNIT_SQUARE,
    "gravity [m/s^2]": ObjectivityRemark.GROWN,
    "density [kg/m^3]": ObjectivityRemark.TABLE_1,
    "cells along the block": ObjectivityRemark.NOT_GIVEN,
    "particles per cell": ObjectivityRemark.NOT_GIVEN,
    "unit of stress [Pa]": ObjectivityRemark.END_OF_RAMP,
    "inertial fraction w^2 L / g": ObjectivityRemark.OF_THE_SMALL,
}
