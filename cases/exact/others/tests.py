"""Tests of somebody else's solver by name, with the motion of each; light, for whoever shows what is stored."""

from dataclasses import dataclass
from enum import StrEnum

from mpm_verify.cases.exact.others.motion import Matrix, Motion, Vector


class Cause(StrEnum):
    """Part of a solver of somebody else that a test points to."""

    OWN_TIME = "own_time"  # dt, the number of steps, which step is written
    OWN_FORCE = "own_force"  # and the level of v at the start
    OWN_SUMS = "own_sums"
    OWN_FLIP = "own_flip"
    OWN_INNER = "own_inner"  # forces of the stress
    OWN_GRADIENT = "own_gradient"  # of the velocity, and the update of F
    OWN_STRESS = "own_stress"
    OWN_VOLUME = "own_volume"
    OWN_NUMBERS = "own_numbers"  # of particles


class Left(StrEnum):
    """Reason for which a quantity is not asked."""

    NO_COLUMN = "own_no_column"
    LEVEL = "own_level"  # of another time level than that which is exact
    STRESS_FIRST = "own_stress_first"
    NO_FLIP = "own_no_flip"
    NOT_AFFINE = "own_not_affine"  # stress of this material in such states


@dataclass(frozen=True)
class Case:
    """Case: its group, its motion, and which state is put on the particles."""

    group: str
    motion: Motion
    state: str = ""


STRAINED: Matrix = ((1.06, 0.17), (-0.08, 0.97))
RATE: Matrix = ((0.008, 0.012), (-0.009, -0.005))
DRIFT: Vector = (0.03, 0.02)
PULL: Vector = (0.0113, -0.0297)
ANGLE = 0.012  # of the turn in a step
FEW = (6, 5)  # cells of a body of which all particles are judged


def product(one: Matrix, other: Matrix) -> Matrix:
    """Product of two matrices."""
    (a, b), (c, d) = one
    (e, f), (g, h) = other
    return (a * e + b * g, a * f + b * h), (c * e + d * g, c * f + d * h)


SPIN: Matrix = ((0.0, -ANGLE), (ANGLE, 0.0))
TURNING = product(SPIN, STRAINED)
CASES = {
    "translate": Case("rigid", Motion(V=(0.3137, -0.2293), cells=FEW, steps=12)),
    "throw": Case("rigid", Motion(V=(0.2137, -0.1193), G=PULL, cells=FEW, steps=12)),
    "throw_growing": Case("rigid", Motion(V=(0.2137, -0.1193), G=PULL, J=(0.004, 0.006), cells=FEW, steps=12)),
    "sums": Case("rigid", Motion(F=STRAINED, V=DRIFT, G=PULL, cells=FEW, steps=8), "shaken"),
    "keep": Case("rigid", Motion(V=DRIFT, cells=FEW), "kept"),
    "rest": Case("affine", Motion(F=STRAINED)),
    "affine_unstrained": Case("affine", Motion(M=RATE, V=DRIFT)),
    "affine_strained": Case("affine", Motion(F=STRAINED, M=RATE, V=DRIFT)),
    "turn": Case("affine", Motion(F=STRAINED, M=TURNING, A=product(SPIN, TURNING), V=DRIFT)),
    "force": Case("affine", Motion(F=STRAINED, A=((0.006, 0.01), (-0.008, 0.004)), G=PULL)),
    "divergence_x": Case("affine", Motion(), "graded_x"),
    "divergence_y": Case("affine", Motion(), "graded_y"),
    "path_shear": Case("path", Motion(F=((1.0, 0.6), (0.0, 1.0)), M=RATE)),
    "path_press": Case("path", Motion(F=((0.57, -0.58), (0.48, 0.69)), M=RATE)),
    "path_stretch": Case("path", Motion(F=((0.64, 1.13), (-1.25, 0.21)), M=RATE)),
}
GROUPS = tuple(dict.fromkeys(case.group for case in CASES.values()))
