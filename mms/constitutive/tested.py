"""Outcome of one exact test: its residual, the bound that round-off gives it, and the part of the solver it points to.

Residuals have no unit: a distance over the scale of what is compared, largest component. Bounds are
MARGIN * EPS * operations: `operations` is how many roundings follow one another on the way to the number, steps times
the support nodes that are summed in each, and MARGIN two decades for their constants and the condition of the state.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite
from typing import TYPE_CHECKING, ClassVar, TypeAlias

from mpm_verify.solver.failure import RunFailed

if TYPE_CHECKING:
    from numpy.typing import ArrayLike  # what a command completes and helps with imports no numpy

EPS = 2.0**-52
MARGIN = 100.0
Pairs: TypeAlias = "list[tuple[ArrayLike, ArrayLike, float]]"
FAILED = 1e99  # residual of what ended, or is not a number


class Part(StrEnum):
    """Part of the solver that a test points to."""

    WEIGHTS = "weights"
    DOMAINS = "domains"
    TO_GRID = "to_grid"
    MOTION = "motion"
    TO_PARTICLES = "to_particles"
    STEP = "step"
    SYMMETRY = "symmetry"
    WALLS = "walls"
    FRICTION = "friction"
    DAMPING = "damping"
    STRESS = "stress"
    RATE = "rate"
    HISTORY = "history"
    CUT_OFF = "cut_off"
    SMOOTHING = "smoothing"
    STATE = "state"
    TIME_STEP = "time_step"
    ENDS = "ends"
    ROWS = "rows"
    BUDGET = "budget"
    EDGES = "edges"


class Reason(StrEnum):
    """Reason for which a method or material does not promise a test, by construction."""

    BLENDS = "blends"  # particles take the mean velocity of the grid
    NEGATIVE = "negative"  # a basis with negative weights
    NO_DOMAINS = "no_domains"  # weights of a point
    NOT_FOLLOWED = "not_followed"  # domains that do not turn and shear with the body
    CUT = "cut"  # a limit cuts the domains
    NO_RATE_FORM = "no_rate_form"  # a stress from F alone
    NO_ENERGY = "no_energy"  # in rate form
    IN_STEPS = "in_steps"  # in rate form: the stress of its energy after many steps alone
    NO_MODULI = "no_moduli"  # the material does not state them
    STRETCHED = "stretched"  # the rate carries the stress by the stretch too
    NO_FRICTION = "no_friction"
    NO_CUT_OFF = "no_cut_off"  # neither an apex nor a tension cut-off
    IN_SPACE = "in_space"  # a yield surface of all three principal stresses
    NO_SURFACES = "no_surfaces"  # perfectly plastic with surfaces that the battery does not know, or not so
    NO_HARDENING = "no_hardening"  # no sand that hardens
    NO_VOID = "no_void"  # no void strain, or it parts with a stress
    OPENED = "opened"  # strain that opens and closes voids is neither elastic nor plastic
    NO_SUMS = "no_sums"  # no memory that is a sum
    OWN_AXES = "own_axes"  # the material tells its axes apart
    FILTER = "filter"  # a filter, applied twice, filters twice
    FILTERED = "filtered"  # velocities are filtered after the reaction is taken
    BUDGET = "budget"  # the energy budget is that of update-stress-last, and of positions that move with the nodes
    POINTS = "points"  # forces on the edge act through points
    REFERENCE = "reference"  # weights of the reference positions
    OTHER_RATE = "other_rate"  # smoothing does not take this rate


@dataclass(frozen=True)
class Tested:
    """Outcome of one test.

    Parameters
    ----------
    name
        Test, and after a blank which transfer, stress update or else it was run with.
    residual
        Largest distance from what is exact, over its scale; FAILED where the run ended.
    bound
        What round-off can make of it.
    points_to
        A Part of the solver.
    reason
        A Reason, of a test that is not promised and was not run; empty of one that was.
    """

    name: str
    residual: float
    bound: float
    points_to: str
    reason: str = ""
    __test__: ClassVar[bool] = False  # no class of tests, whatever pytest makes of its name

    @property
    def passed(self) -> bool:
        """Whether the residual is within its bound; a residual that is not finite is not."""
        return bool(self.reason) or self.residual <= self.bound

    @property
    def over(self) -> float:
        """Residual over its bound; of a bound of zero, whether there is a residual."""
        return self.residual / self.bound if self.bound else FAILED * bool(self.residual)

    @property
    def test(self) -> str:
        """Name of the test without what it was run with."""
        return self.name.partition(" ")[0]


def bound(operations: float) -> float:
    """Bound of a residual after so many roundings."""
    return MARGIN * EPS * operations


def off(found: "ArrayLike", expected: "ArrayLike", scale: float) -> float:
    """Largest distance of two arrays over a scale; FAILED where one is not finite."""
    import numpy as np

    with np.errstate(all="ignore"):
        distance = np.abs(np.asarray(found) - np.asarray(expected))
    worst = float(distance.max(initial=0.0)) / scale
    return worst if isfinite(worst) else FAILED


def farthest(pairs: Pairs) -> float:
    """Largest of the distances of pairs, each with its scale."""
    return max(off(*pair) for pair in pairs)


def attempt(name: str, part: Part, test: Callable[[], "Tested | list[Tested]"]) -> "list[Tested]":
    """Outcomes of a test, or one that has failed where its run came to an end or its numbers to none."""
    try:
        found = test()
    except (RunFailed, ArithmeticError, ValueError):
        return [Tested(name, FAILED, 0.0, part)]
    return found if isinstance(found, list) else [found]


def not_asked(name: str, part: Part, reason: Reason) -> Tested:
    """Test that is not promised, with its reason."""
    return Tested(name, 0.0, 0.0, part, reason)
