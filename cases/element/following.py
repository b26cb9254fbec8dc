"""Element tests followed step by step, from a stress or state to their end or to where they cannot go on."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from mpm_verify.cases.element.element import Element, ElementFailed, ElementFailure, State, finite
from mpm_verify.cases.element.legs import STRESS, Wanted, reached
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.solver.state import Floats


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
