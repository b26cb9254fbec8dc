"""Names of the tests of somebody else's solver, and what they point to; light, for help and for what is stored."""

from enum import StrEnum

TESTS = {  # with their groups
    "translate": "rigid",
    "throw": "rigid",
    "throw_growing": "rigid",
    "sums": "rigid",
    "keep": "rigid",
    "rest": "affine",
    "affine_unstrained": "affine",
    "affine_strained": "affine",
    "turn": "affine",
    "force": "affine",
    "divergence_x": "affine",
    "divergence_y": "affine",
    "path_shear": "path",
    "path_press": "path",
    "path_stretch": "path",
}


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
