"""Records of what a study of the column is held against: finished runs, their lengths by several measures, claims.

Fronts and heights are measured in several ways (MEASURES), the usual one first: a claim is answered by that, and by the
others beside it. The front of 99 % of the mass is usual: numbers are recorded by it, no particle alone moves it, and it
is the least of the three, so that what is too far by it is too far by the others. In a triangle it is at 0.9 of the
toe, the front of 99.9 % at 0.968: what an experiment sees is nearer to the toe.
"""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from mpm_verify.cases.column.experiment import Experiment
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.solver.state import Floats

MEASURES = {"front": ("front_99", "front_999", "toe"), "height": ("height", "height_fit")}  # the usual one first
CREEP = {"height": "creep", "height_fit": "creep_fit"}


class ClaimCode(StrEnum):
    """A sentence of the paper, by the axis that it is about."""

    FRONT_OVER = "front_over"  # ppc, Figure 4
    HEIGHT_RISES = "height_rises"
    HEIGHT_UNDER_WITH_ONE = "height_under_with_one"
    HEIGHT_NEAR_WITH_MORE = "height_near_with_more"
    FRONT_FALLS = "front_falls"  # damping, Figures 5 and 6
    FRONT_CLOSER = "front_closer"
    POTENTIAL_KEPT = "potential_kept"
    KINETIC_CHANGED = "kinetic_changed"
    VOLUMETRIC_FRONT = "volumetric_front"  # smoothing, Figure 7
    VOLUMETRIC_HEIGHT = "volumetric_height"
    DEVIATORIC_FRONT = "deviatoric_front"
    MATERIALS_CLOSE = "materials_close"  # material, Figure 8
    SAND_STIFFER = "sand_stiffer"
    BOTH_NEAR = "both_near"
    SAND_EARLY = "sand_early"
    SAND_LATE = "sand_late"


HANGS = {  # on which length the answer of a claim hangs; those on energies have none
    "front": {ClaimCode.FRONT_OVER, ClaimCode.FRONT_FALLS, ClaimCode.FRONT_CLOSER, ClaimCode.VOLUMETRIC_FRONT,
              ClaimCode.DEVIATORIC_FRONT, ClaimCode.MATERIALS_CLOSE, ClaimCode.SAND_STIFFER, ClaimCode.BOTH_NEAR,
              ClaimCode.SAND_LATE},
    "height": {ClaimCode.HEIGHT_RISES, ClaimCode.HEIGHT_UNDER_WITH_ONE, ClaimCode.HEIGHT_NEAR_WITH_MORE,
               ClaimCode.VOLUMETRIC_HEIGHT},
}  # fmt: skip


@dataclass(frozen=True)
class FinishedRun:
    """A run that came to its end, its numbers and its curves; without them where they cannot be read.

    `front_by`, `height_by`: names of the measures that its front and height are read by.
    """

    run: ColumnRun
    values: dict[str, float]
    curves: dict[str, Floats]
    front_by: str = MEASURES["front"][0]
    height_by: str = MEASURES["height"][0]

    @property
    def front(self) -> float:
        """Front at the end, m."""
        return self.values[self.front_by]

    @property
    def height(self) -> float:
        """Height at the wall at the end, m."""
        return self.values[self.height_by]

    @property
    def creep(self) -> float:
        """Fraction of its height by which it still fell in the last fifth of the time."""
        return self.values[CREEP[self.height_by]]

    @property
    def lengths(self) -> dict[str, float]:
        """Front and height [m] by every measure that the run has."""
        return {name: self.values[name] for of in MEASURES.values() for name in of if name in self.values}


@dataclass(frozen=True)
class Compared:
    """A run that a claim compares: its value on the axis, its front and its height at the end [m], its crowding.

    `lengths`: front and height by every measure.
    """

    value: Any
    front: float
    height: float
    crowding: float
    lengths: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper, whether runs reproduce it, and with what numbers.

    `runs`: those that are compared, in the order of the sentence; `known`: the experiment; `numbers`: what was measured
    beside fronts and heights, and the bounds it was held against; `shared`: values of the runs on the other axes; `by`:
    the answer by each measure of the length that it hangs on, the usual one first.
    """

    code: ClaimCode
    axis: str
    reproduced: bool | None
    runs: tuple[Compared, ...]
    known: Experiment
    numbers: dict[str, float] = field(default_factory=dict)
    shared: dict[str, Any] = field(default_factory=dict)
    by: dict[str, bool | None] = field(default_factory=dict)

    @property
    def hangs(self) -> bool:
        """Whether another measure gives another answer."""
        return any(answer is not self.reproduced for answer in self.by.values())
