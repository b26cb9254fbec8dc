"""Findings on frame indifference, as codes with the numbers of the runs; the words are in reports/sentences.

Numbers of stresses are fractions of the mean vertical stress at the end of the ramp.
"""

from collections.abc import Mapping
from enum import StrEnum

import numpy as np

from mpm_verify.cases.harness.checks import Check, Remark
from mpm_verify.cases.harness.study import ResultRecord
from mpm_verify.cases.objectivity import block as full
from mpm_verify.cases.objectivity.axes import KINEMATIC, Block
from mpm_verify.cases.objectivity.rates import CONTROLS, ORDERS, SHEAR
from mpm_verify.mms.constitutive.simple_shear import SIMPLE_SHEAR
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, RATES, available

INERTIA = "Inertial fraction"
UNSEEN = 1e-6  # of the stress: a miss in Figure 2 below which it cannot tell a negative control from a rate
MODERATE = 0.5  # shear up to which the rates hardly differ
Numbers = Mapping[str, float]


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
    UNREAD = "objectivity.unread"  # files of curves that cannot be read
    PAPER = "objectivity.paper"
    UNIT_SQUARE = "objectivity.unit_square"
    GROWN = "objectivity.grown"
    TABLE_1 = "objectivity.table_1"
    NOT_GIVEN = "objectivity.not_given"
    END_OF_RAMP = "objectivity.end_of_ramp"
    OF_THE_SMALL = "objectivity.of_the_small"


def findings(block: Block, checks: list[Check], results: Mapping[str, ResultRecord[Block]]) -> list[Remark]:
    """Remarks from the numbers of all parts; notes on the CPDI runs only where all three came to their end."""
    known = results[KINEMATIC].values
    unseen = [name for name in available(NEGATIVE_CONTROLS) if known[f"figure2 {name}"] < UNSEEN]
    runs = [results[name].values for name in (full.PRINTED, full.SMALL, full.REST)]
    found = [lead(block, checks, runs[1], unseen)]
    if all(runs):
        found += of_runs(block, *runs)
    return [*found, *of_controls_and_rates(known, unseen)]


def lead(block: Block, checks: list[Check], small: Numbers, unseen: list[str]) -> Remark:
    """Remark on how many checks missed; where none did, the largest shear stress, and what Figure 2 misses."""
    missed = sum(check.outcome != "PASS" for check in checks)
    if missed:
        return Remark(ObjectivityRemark.MISSED, {"missed": missed, "checks": len(checks)})
    numbers = {"peak": small["peak"], "exact": largest_shear(block)}
    return Remark(
        ObjectivityRemark.TURNS, numbers | {"controls": len(available(NEGATIVE_CONTROLS)), "unseen": len(unseen)}
    )


def largest_shear(block: Block) -> float:
    """Shear stress of the closed form at 45 degrees."""
    return 0.5 * (1 - block.nu / (1 - block.nu))


def of_runs(block: Block, printed: Numbers, small: Numbers, rest: Numbers) -> list[Remark]:
    """Remarks on the block as printed, of the small one, and of the one that is not turned."""
    away = {"printed": printed["own_yy"], "rest": rest["own_yy"], "small": small["own_yy"]}
    inertia = {
        "L": block.L,
        "fraction": block.inertial_fraction,
        "small_fraction": block.inertial_fraction / 100,
        **away,
    }
    largest = max(small["particle"], printed["particle"])
    return [
        Remark(ObjectivityRemark.SWAP, {"exact": largest_shear(block), "peak": small["peak"]}, full.GROUP),
        Remark(ObjectivityRemark.CO_ROTATED, {"early": printed["early"], "end": printed["late"]}, full.GROUP),
        Remark(ObjectivityRemark.INERTIA, inertia, INERTIA),
        Remark(ObjectivityRemark.RIPPLE, {"L": block.L, "period": 4 * block.L / block.material.wave_speed()}, INERTIA),
        Remark(ObjectivityRemark.PARTICLES, {"largest": largest}, INERTIA),
    ]


def of_controls_and_rates(known: Numbers, unseen: list[str]) -> list[Remark]:
    """Remarks on controls that Figure 2 cannot see, on orders, and on how near rates are in simple shear."""
    right = [known[f"order {name}"] for name in available(RATES)]
    shear = [float(SIMPLE_SHEAR[rate](np.array([MODERATE]))[0, 2]) for rate in available(RATES)]
    spread = {"shear": MODERATE, "spread": max(shear) / min(shear) - 1, "rates": len(shear)}
    return [
        Remark(ObjectivityRemark.CONTROLS, {name: known[f"order {name}"] for name in unseen}, CONTROLS),
        Remark(ObjectivityRemark.PRINTED, {"miss": known["figure2 printed"]}, CONTROLS),
        Remark(ObjectivityRemark.ORDERS, {"least": min(right), "most": max(right)}, ORDERS),
        Remark(ObjectivityRemark.INCREMENT, {}, ORDERS),
        Remark(ObjectivityRemark.NOT_UNIQUE, spread, SHEAR),
    ]
