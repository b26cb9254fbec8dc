"""Examination of frame indifference: the CPDI runs of the block, rates and negative controls."""

from collections.abc import Mapping

import numpy as np

from mpm_verify.cases.harness.checks import Check, Curves, Examination, Remark
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
) -> Examination:
    """Examination of all parts of one block, by their names.

    `arrays` are the curves to draw; those of a part may be missing, and decide nothing.
    """
    known: tuple[Check, ...] = results[KINEMATIC].checks  # type: ignore[attr-defined]
    checks = [*full.checks(block, results), *known]
    return Examination(
        study.name,
        study.title,
        study.command,
        (*findings(block, checks, results), *unread(results, arrays)),
        tuple(checks),
        parameters(block),
        ORIGINS,
        results[KINEMATIC].environment,
        curves(block, results, arrays),
    )


def unread(results: Mapping[str, ResultRecord[Block]], arrays: Mapping[str, Curves]) -> list[Remark]:
    """Remark on the files of curves that cannot be read."""
    files = [f"runs/{result.digest}.npz" for name, result in results.items() if not arrays.get(name)]
    return [Remark(ObjectivityRemark.UNREAD, {"files": ", ".join(files)})] if files else []


def curves(block: Block, results: Mapping[str, ResultRecord[Block]], arrays: Mapping[str, Curves]) -> Curves:
    """Curves that the page draws, and `control/NAME`: what each negative control misses by."""
    runs = {name: found for name, found in arrays.items() if name != KINEMATIC and found}
    kept: Curves = {"exact": kinematic.exact_figure2(block, np.linspace(0, 2, 401))}
    kept |= {f"run/{name}": run["mean"] for name, run in runs.items() if run["mean"]["t"].size}
    t = np.linspace(0, 1, 201)
    kept["wave"] = {"t": t, "yy": ramped_column(t, block.material.wave_speed(), block.L)}
    kept |= {f"field/{name}": run["field"] for name, run in runs.items()}
    kept |= arrays.get(KINEMATIC, {})
    known = results[KINEMATIC].values
    for name in available(NEGATIVE_CONTROLS):
        kept[f"control/{name}"] = {
            "kinematic": np.array([known[f"figure2 {name}"]]),
            "run": np.array([results[name].values.get("miss", np.inf)]),
            "stretched": np.array([known[f"stretched {name}"]]),
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
