"""Examination of frame indifference: the CPDI runs of the block, rates and negative controls."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from mpm_verify.cases.harness.checks import Check, Curves, Examination
from mpm_verify.cases.harness.study import ResultRecord, Study
from mpm_verify.cases.objectivity import block as full
from mpm_verify.cases.objectivity import rates as kinematic
from mpm_verify.cases.objectivity.axes import KINEMATIC, Block
from mpm_verify.cases.objectivity.exact import ramped_column
from mpm_verify.cases.objectivity.findings import ObjectivityRemark, findings
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, available


def examination(
    study: Study[Block],
    block: Block,
    results: Mapping[str, ResultRecord[Block]],
    arrays: Mapping[str, Curves],
    before: str = "",
) -> Examination:
    """Examination of all parts of one block, by their names; `before` is put before the names of groups."""
    found = {name: (arrays[name], results[name].failure) for name in arrays if name != KINEMATIC}
    kept = curves(block, found, arrays[KINEMATIC])
    known: tuple[Check, ...] = results[KINEMATIC].checks  # type: ignore[attr-defined]
    checks = [*full.checks(block, found), *known]
    errors = {name[7:]: curve["error"] for name, curve in kept.items() if name.startswith("errors/")}
    return Examination(
        study.name,
        study.title,
        study.command,
        tuple(findings(block, checks, kept, errors)),
        tuple(replace(check, group=before + check.group) for check in checks),
        parameters(block),
        ORIGINS,
        results[KINEMATIC].environment,
        kept,
    )


def curves(block: Block, found: full.Found, prescribed: Curves) -> Curves:
    """Curves that the page draws."""
    kept: Curves = {"exact": kinematic.exact_figure2(block, np.linspace(0, 2, 401))}
    kept |= {f"run/{name}": run["mean"] for name, (run, _) in found.items() if run["mean"]["t"].size}
    t = np.linspace(0, 1, 201)
    kept["wave"] = {"t": t, "yy": ramped_column(t, block.material.wave_speed(), block.L)}
    kept |= {f"field/{name}": run["field"] for name, (run, _) in found.items()}
    kept |= prescribed
    for name in available(NEGATIVE_CONTROLS):
        curve = prescribed[f"figure2/{name}"]
        away = max(
            float(np.abs(curve[c] - kinematic.exact_figure2(block, curve["t"])[c]).max()) for c in ("xx", "yy", "xy")
        )
        run, failure = found[name]
        miss = np.inf if failure else full.misses(run["mean"], block).max()
        kept[f"control/{name}"] = {
            "kinematic": np.array([away]),
            "run": np.array([miss]),
            "stretched": prescribed[f"errors/{name}"]["error"][-1:],
        }
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
        "inertial fraction w^2 L / g": block.inertial_fraction,
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
