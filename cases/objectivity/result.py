"""Outcome of one part of the study of frame indifference."""

from dataclasses import dataclass

from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.study import ResultRecord
from mpm_verify.cases.objectivity.axes import Block


@dataclass(frozen=True, kw_only=True)
class ObjectivityResult(ResultRecord[Block]):
    """Outcome of one part: curves to draw in the arrays as `curve/column`, and of the kinematic part the checks.

    `values` are those of block.numbers, or of the kinematic part `figure2 NAME`, the distance of a negative control
    from the closed form, `stretched NAME`, its error in the finest stretched turn, and `order NAME` of each rate.
    """

    run: Block
    checks: tuple[Check, ...] = ()
