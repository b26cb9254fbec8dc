"""Findings on frame indifference, as codes with the numbers of the runs; the words are in reports/sentences.

Numbers of stresses are fractions of the mean vertical stress at the end of the ramp.
"""

from collections.abc import Mapping
from enum import StrEnum

import numpy as np

from mpm_verify.cases.harness.checks import Check, Curves, Remark
from mpm_verify.cases.objectivity import block as full
from mpm_verify.cases.objectivity.axes import Block
from mpm_verify.cases.objectivity.exact import SIMPLE_SHEAR
from mpm_verify.cases.objectivity.rates import ORDERS, SHEAR, slope
from mpm_verify.cases.objectivity.turning_block import RAMP
from mpm_verify.solver.plugins import RATES, available
from mpm_verify.solver.state import Floats

CONTROLS, INERTIA = "Negative controls", "Inertial fraction"
UNSEEN = 1e-6  # of the stress: a miss in Figure 2 below which it cannot tell a negative control from a rate
MODERATE = 0.5  # shear up to which the rates hardly differ
Curve = Mapping[str, Floats]


class ObjectivityRemark(StrEnum):
    """Remarks on what came out, on each part, and on where parameters come from."""

    TURNS = "objectivity.turns"  # all checks pass: the stress turns with the block
    MISSED = "objectivity.missed"
    SWAP = "objectivity.swap"  # of horizontal and vertical stress
    CO_ROTATED = "objectivity.co_rotated"  # shear stresses that dissipate
    INERTIA = "objectivity.inertia"  # what the mean vertical stress misses
    RIPPLE = "objectivity.ripple"  # the block's own vibration
    PARTICLES = "objectivity.particles"  # shear stresses of single particles
    CONTROLS = "objectivity.controls"  # those that Figure 2 cannot see
    PRINTED = "objectivity.printed"  # the formulas as printed in the paper
    ORDERS = "objectivity.orders"  # of rates and controls in a turn with strain
    INCREMENT = "objectivity.increment"  # of the strain, and what F0 alone would do
    NOT_UNIQUE = "objectivity.not_unique"  # rates in simple shear
    PAPER = "objectivity.paper"
    UNIT_SQUARE = "objectivity.unit_square"
    GROWN = "objectivity.grown"
    TABLE_1 = "objectivity.table_1"
    NOT_GIVEN = "objectivity.not_given"
    END_OF_RAMP = "objectivity.end_of_ramp"
    OF_THE_SMALL = "objectivity.of_the_small"


def findings(block: Block, checks: list[Check], curves: Curves, errors: Mapping[str, Floats]) -> list[Remark]:
    """Remarks; notes on the CPDI runs only where all three came to their end."""
    unseen = [name for name, curve in of_controls(curves).items() if curve["kinematic"][0] < UNSEEN]
    found = [lead(block, checks, curves, unseen)]
    names = [f"run/{name}" for name in (full.PRINTED, full.SMALL, full.REST)]
    if all(name in curves for name in names):
        found += of_runs(block, *(curves[name] for name in names))
    return [*found, *of_controls_and_rates(curves, errors, unseen)]


def of_controls(curves: Curves) -> Curves:
    """Misses of the negative controls by name."""
    return {name.partition("/")[2]: curve for name, curve in curves.items() if name.startswith("control/")}


def lead(block: Block, checks: list[Check], curves: Curves, unseen: list[str]) -> Remark:
    """Remark on how many checks missed; where none did, the largest shear stress, and what Figure 2 misses."""
    missed = sum(check.outcome != "PASS" for check in checks)
    if missed:
        return Remark(ObjectivityRemark.MISSED, {"missed": missed, "checks": len(checks)})
    peak, controls = float(curves[f"run/{full.SMALL}"]["xy"].max()), len(of_controls(curves))
    numbers = {"peak": peak, "exact": largest_shear(block), "controls": controls, "unseen": len(unseen)}
    return Remark(ObjectivityRemark.TURNS, numbers)


def largest_shear(block: Block) -> float:
    """Shear stress of the closed form at 45 degrees."""
    return 0.5 * (1 - block.nu / (1 - block.nu))


def of_runs(block: Block, printed: Curve, small: Curve, rest: Curve) -> list[Remark]:
    """Remarks on the block as printed, of the small one, and of the one that is not turned."""
    late = {name: curve["t"] > RAMP for name, curve in (("printed", printed), ("small", small), ("rest", rest))}
    quarter = max(1, int(late["printed"].sum()) // 4)
    own = abs(printed["own_xy"][late["printed"]])
    local = max(float(small["shear"][late["small"]].max()), float(printed["shear"][late["printed"]].max()))
    away = {
        name: float(curve["own_yy"][late[name]].mean()) + 1
        for name, curve in (("printed", printed), ("rest", rest), ("small", small))
    }
    inertia = {
        "L": block.L,
        "fraction": block.inertial_fraction,
        "small_fraction": block.inertial_fraction / 100,
        **away,
    }
    return [
        Remark(ObjectivityRemark.SWAP, {"exact": largest_shear(block), "peak": float(small["xy"].max())}, full.GROUP),
        Remark(ObjectivityRemark.CO_ROTATED,
               {"early": float(own[:quarter].max()), "end": float(own[-quarter:].max())}, full.GROUP),
        Remark(ObjectivityRemark.INERTIA, inertia, INERTIA),
        Remark(ObjectivityRemark.RIPPLE, {"L": block.L, "period": 4 * block.L / block.material.wave_speed()}, INERTIA),
        Remark(ObjectivityRemark.PARTICLES, {"largest": local}, INERTIA),
    ]  # fmt: skip


def of_controls_and_rates(curves: Curves, errors: Mapping[str, Floats], unseen: list[str]) -> list[Remark]:
    """Remarks on controls that Figure 2 cannot see, on orders, and on how near rates are in simple shear."""
    orders = {name: slope(error) for name, error in errors.items()}
    right = [orders[name] for name in available(RATES)]
    printed = float(of_controls(curves)["printed"]["kinematic"][0])
    shear = [float(SIMPLE_SHEAR[rate](np.array([MODERATE]))[0, 2]) for rate in available(RATES)]
    spread = {"shear": MODERATE, "spread": max(shear) / min(shear) - 1, "rates": len(shear)}
    return [
        Remark(ObjectivityRemark.CONTROLS, {name: orders[name] for name in unseen}, CONTROLS),
        Remark(ObjectivityRemark.PRINTED, {"miss": printed}, CONTROLS),
        Remark(ObjectivityRemark.ORDERS, {"least": min(right), "most": max(right)}, ORDERS),
        Remark(ObjectivityRemark.INCREMENT, {}, ORDERS),
        Remark(ObjectivityRemark.NOT_UNIQUE, spread, SHEAR),
    ]
