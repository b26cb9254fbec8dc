"""`verify objectivity`: everything about frame indifference that needs no soil, as one Examination."""

from concurrent.futures import Executor

import numpy as np

from mpm_verify.cases.harness.checks import Check, Curves, Examination
from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.objectivity import block as full
from mpm_verify.cases.objectivity import rates as kinematic
from mpm_verify.cases.objectivity.exact import SIMPLE_SHEAR, ramped_column
from mpm_verify.cases.objectivity.turning_block import Block
from mpm_verify.cases.objectivity.words import words
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, RATES, available
from mpm_verify.solver.state import Floats

CONTROLS = "Negative controls"
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
        "Frame indifference: the paper's rotated block, and what it can show",
        command,
        lead(checks),
        tuple(checks),
        parameters(block),
        notes(block, kept),
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
        source = "a control has to be seen" if wrong else "a rate must not look like one"
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


def parameters(block: Block) -> dict[str, str]:
    """Of the run, and which the paper does not give."""
    return {
        "E": f"{block.E:g} Pa (paper)",
        "nu": f"{block.nu:g} (paper)",
        "side of the block": f"{block.L:g} m (paper: unit square), and a hundredth of it",
        "gravity": f"{block.g:g} m/s^2, grown from 0 in the first second (paper: its section 3)",
        "turn": "90 degrees in the second second, about the middle of the block, at a constant rate from its start",
        "density": f"{block.rho0:g} kg/m^3 (not given; that of the paper's Table 1)",
        "grid": f"{block.cells} cells along the block, {block.ppc} particles per cell (not given)",
        "time step": f"{1 / block.steps:.3g} s, Courant number {block.courant:g}",
        "unit of stress": f"mean vertical stress at the end of the ramp, rho0 g L / 2 = {abs(block.sigma_v):g} Pa",
        "inertial share w^2 L / g": f"{block.share:.3g}, and {block.share / 100:.3g} for the small block",
    }


def lead(checks: list[Check]) -> str:
    """What came out, in words."""
    missed = sum(check.outcome != "PASS" for check in checks)
    if missed:
        return f"{missed} of {len(checks)} checks did not pass; they stand first."
    return (
        "The stress of the block turns with it: horizontal and vertical stress swap, and the shear stress in the axes "
        "of the laboratory reaches 0.286 of the vertical stress at 45 degrees, as it must. Every wrong reading is "
        "seen, the formulas as printed in the paper among them; but not all of them in Figure 2."
    )


def notes(block: Block, kept: Curves) -> dict[str, tuple[str, ...]]:
    """What one should know of each part, with the numbers of this run."""
    names = [f"run/{name}" for name in (full.PRINTED, full.SMALL, full.REST)]
    if not all(name in kept for name in names):
        return {}
    return words(block, *(kept[name] for name in names))
