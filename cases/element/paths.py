"""Element tests as data: conditions on strains and stresses, three in plane strain and four with zz, and a length.

A strain condition gives the increment of a combination of xx, yy, xy (tensor) and zz, a stress condition holds one
where it was. Compression is along y. A path of one's own comes from a CSV file (path_file.py, legs.py); a motion is a
path of F (motion.py).
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from mpm_verify.cases.element.element import Element, ElementFailed, ElementFailure, State, finite
from mpm_verify.cases.element.legs import STRESS, Wanted, reached
from mpm_verify.solver.state import Floats

CYCLES = 3


@dataclass(frozen=True)
class Condition:
    """Condition on a combination with `weights` of xx, yy, xy, and of zz in a test that strains it.

    Of the strain, which goes through `fraction` of the length of the path; or of the stress, which stays.
    """

    of: Literal["strain", "stress"]
    weights: tuple[float, ...]
    fraction: float = 0.0


XX, YY, XY = (Condition("strain", w) for w in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))


def given(weights: tuple[float, ...], fraction: float) -> Condition:
    """Condition that gives a strain."""
    return Condition("strain", weights, fraction)


def held(*weights: float) -> Condition:
    """Condition that holds a stress."""
    return Condition("stress", weights)


@dataclass(frozen=True)
class PathSource:
    """Content of the file of a path: columns that are `used`, and those that are not strains.

    Strains out of the plane are `zero` in every row; `largest` is the largest strain component. `lines` are those of
    the rows, `stresses` the columns that control a stress, `motion` the word for how F came about, if it did.
    """

    name: str
    used: tuple[str, ...]
    unused: tuple[str, ...] = ()
    zero: tuple[str, ...] = ()
    largest: float = 0.0
    lines: tuple[int, ...] = ()
    stresses: tuple[str, ...] = ()
    motion: str = ""


@dataclass(frozen=True)
class ElementTest:
    """Element test, with the `length` of its path in strain.

    `shear`: its curves are of xy; `closed`: the volume is kept; `cyclic`: to either side CYCLES times and back to the
    middle; `loose`: it starts at this fraction of the stress; `axial`: lateral stresses or strains are equal, so that q
    is drawn; `motion`: its points are F: xx, yy, xy, zz, yx. Of a path from a file `points` are the strains at the
    corners (R,n), and `targets` the stresses (R,n), each not a number where it is not given.
    """

    name: str
    title: str
    conditions: tuple[Condition, ...]
    length: float
    shear: bool = False
    closed: bool = False
    cyclic: bool = False
    loose: float = 1.0
    axial: bool = False
    motion: bool = False
    points: Floats = field(default_factory=lambda: np.zeros((0, 3)), compare=False)
    targets: Floats = field(default_factory=lambda: np.zeros((0, 3)), compare=False)
    source: PathSource | None = field(default=None, compare=False)

    @property
    def size(self) -> int:
        """Number of its components of strain: 3 in plane strain, 4 with zz, 5 of a motion."""
        return self.points.shape[1] if len(self.points) else len(self.conditions)

    @property
    def mixed(self) -> bool:
        """Whether stresses are given in a path from a file."""
        return len(self.targets) > 0

    @property
    def legs(self) -> int:
        """Number of straight pieces: a number of steps is a multiple of it, so that no step goes around a corner."""
        return max(1, len(self.points) - 1, 4 * CYCLES * self.cyclic)

    def steps(self, least: int) -> int:
        """Smallest number of steps from `least` on that is the same on each piece."""
        return -(-least // self.legs) * self.legs

    def gone(self, steps: int) -> Floats:
        """Strain (steps+1,) by which the path has gone along its conditions, there and back."""
        fraction = np.linspace(0, 1, steps + 1)
        if not self.cyclic:
            return fraction * self.length
        corners = np.concatenate([[0.0], np.tile([1.0, 0.0, -1.0, 0.0], CYCLES)])
        there: Floats = np.interp(fraction * self.legs, np.arange(self.legs + 1), corners) * self.length
        return there


CELL = (held(1, 0, 0, 0), held(0, 0, 0, 1), given((0, 0, 1, 0), 0))  # the pressure of a triaxial cell stays
TESTS = {
    test.name: test
    for test in (
        ElementTest(
            "isotropic", "Isotropic compression", (given((1, 0, 0), -0.5), given((0, 1, 0), -0.5), XY), 0.01
        ),
        ElementTest("oedometric", "Oedometric compression", (XX, given((0, 1, 0), -1), XY), 0.01, loose=0.01),
        ElementTest("biaxial", "Drained biaxial compression", (held(1, 0, 0), given((0, 1, 0), -1), XY), 0.055),
        ElementTest(
            "constant_s", "Shear at constant mean stress", (given((1, -1, 0), 1), held(0.5, 0.5, 0), XY), 0.07
        ),
        ElementTest(
            "shear_stress", "Simple shear at constant vertical stress",
            (XX, held(0, 1, 0), given((0, 0, 1), 0.5)), 0.05, shear=True,
        ),
        ElementTest(
            "shear_volume", "Simple shear at constant volume", (XX, YY, given((0, 0, 1), 0.5)), 0.02,
            shear=True, closed=True,
        ),
        ElementTest(
            "undrained", "Undrained biaxial compression", (given((1, 0, 0), 1), given((0, 1, 0), -1), XY), 0.01,
            closed=True,
        ),
        ElementTest(
            "cyclic_shear", "Cyclic simple shear at constant vertical stress",
            (XX, held(0, 1, 0), given((0, 0, 1), 0.5)), 0.02, shear=True, cyclic=True,
        ),
        ElementTest("triaxial_compression", "Drained triaxial compression", (*CELL, given((0, 1, 0, 0), -1)), 0.05,
                    axial=True),
        ElementTest("triaxial_extension", "Drained triaxial extension", (*CELL, given((0, 1, 0, 0), 1)), 0.025,
                    axial=True),
        ElementTest(
            "triaxial_undrained", "Undrained triaxial compression",
            (given((1, 0, 0, 0), 0.5), given((0, 0, 0, 1), 0.5), given((0, 1, 0, 0), -1), given((0, 0, 1, 0), 0)), 0.02,
            closed=True, axial=True,
        ),
        ElementTest(
            "finite_shear", "Simple shear of F to 5", (), 5.0, shear=True, closed=True, motion=True,
            points=np.array([[1.0, 1.0, 0.0, 1.0, 0.0], [1.0, 1.0, 5.0, 1.0, 0.0]]),
        ),
    )
}  # fmt: skip


@dataclass(frozen=True)
class Stopped:
    """Early end of a test: why, what was left of the residual, and at which of how many steps."""

    cause: ElementFailure
    left: float
    step: int
    steps: int
    line: int = 0  # of the file, in which its leg ends


@dataclass(frozen=True)
class Followed:
    """Path of a test: strain (N+1,n), sigma (N+1,4), history (N+1,H); `failed` where it ends before the last step."""

    strain: Floats
    sigma: Floats
    history: Floats
    failed: Stopped | None = None


def follow(element: Element, test: ElementTest, steps: int, start: Floats | State) -> Followed:
    """Follow the test in equal steps from a stress (4,) or a state; what cannot go on ends there and says why."""
    begin = element.start(start) if isinstance(start, np.ndarray) else start
    states, failed = [replace(begin, strain=origin(test))], None
    size, before, per = scale_of(element, states[0]), np.zeros(test.size), steps // test.legs
    free = any(condition.of == "stress" for condition in test.conditions)
    given = np.full((steps, test.size), np.nan) if test.mixed else moves(test, steps)
    for number, move in enumerate(given, 1):
        last = states[-1]
        try:
            if test.mixed:
                end = next_of_leg(element, test, states, number, per, size)
            elif free:
                kept = states[0] if test.axial else last  # so that what is left of a cell pressure does not add up
                end = solved(element, test, kept, last, move, before, size)
                before = end.strain - last.strain
            else:
                end = finite(element.step(last, move[None])[0])
            states.append(end)
        except ElementFailed as error:
            failed = Stopped(error.cause, error.left, number, steps, line_of(test, (number - 1) // per))
            break
    strain, sigma, history = (np.array([getattr(s, name) for s in states]) for name in ("strain", "sigma", "history"))
    return Followed(strain, sigma, history, failed)


def origin(test: ElementTest) -> Floats:
    """Strain (n,) at the start; of a motion the F of its first row."""
    return test.points[0].copy() if test.motion else np.zeros(test.size)


def line_of(test: ElementTest, leg: int) -> int:
    """Line of the file in which a leg ends; 0 of a path of no file."""
    return test.source.lines[leg + 1] if test.source and test.source.lines else 0


def next_of_leg(element: Element, test: ElementTest, states: list[State], number: int, per: int, size: float) -> State:
    """State after step `number` of a path from a file, `per` steps to a leg. Raises ElementFailed."""
    leg, done = divmod(number - 1, per)
    last, begin = states[-1], states[leg * per]
    wanted = Wanted(test.points[leg + 1], test.targets[leg + 1], begin, (done + 1) / per)
    before = last.strain - states[-2].strain if done else None
    return finite(reached(element, last, wanted, before, size))


def solved(
    element: Element, test: ElementTest, kept: State, last: State, move: Floats, before: Floats, size: float
) -> State:
    """Solve for the next state, with the stresses of `kept`: from the last increment, or from what is given alone.

    Raises ElementFailed.
    """
    residuals, sizes = control(test, kept, move), scales(test, move, size)
    if before @ move > 0:
        with suppress(ElementFailed):
            return element.solve(last, residuals, before, sizes, test.axial)
    return element.solve(last, residuals, move, sizes, test.axial)


def scale_of(element: Element, state: State) -> float:
    """Scale of stress: that at the start, or what a small strain makes of nothing."""
    probe = element.step(state, np.array([[-1e-3, -2e-3, *np.zeros(len(state.strain) - 2)]]))[0]
    return float(max(np.abs(state.sigma).max(), np.abs(probe.sigma).max()))


def moves(test: ElementTest, steps: int) -> Floats:
    """Strain increments (steps,n) as far as they are given: least squares of the conditions on strains."""
    if len(test.points):
        line = np.linspace(0, test.legs, steps + 1)
        return np.diff([np.interp(line, np.arange(test.legs + 1), column) for column in test.points.T], axis=1).T
    strains = [condition for condition in test.conditions if condition.of == "strain"]
    weights = np.array([condition.weights for condition in strains])
    unit = np.linalg.lstsq(weights, np.array([condition.fraction for condition in strains]), rcond=None)[0]
    increments: Floats = np.diff(test.gone(steps))[:, None] * unit
    return increments


def control(test: ElementTest, before: State, move: Floats) -> Callable[[Floats, State], Floats]:
    """Residuals of one step, as a function of its strain increment and of the state at its end."""
    weights = np.array([condition.weights for condition in test.conditions])
    strains = np.array([condition.of == "strain" for condition in test.conditions])
    wanted = weights @ move

    def residuals(de: Floats, end: State) -> Floats:
        stress = weights @ (end.sigma - before.sigma)[STRESS[: len(de)]]
        return np.where(strains, weights @ de - wanted, stress)

    return residuals


def scales(test: ElementTest, move: Floats, size: float) -> Floats:
    """Scales of the residuals."""
    return np.array([np.abs(move).max() if condition.of == "strain" else size for condition in test.conditions])
