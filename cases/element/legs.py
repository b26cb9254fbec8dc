"""Legs of a path from a file: of each component the strain is given at the end of a leg, or the stress.

What is given goes there in equal steps from where the leg begins. What is left is found by Newton's method on the
increments of all components (`Element.solve`), down to residuals of 1e-13 of the largest strain increment and of the
scale of stress. Where it ends earlier, up to 1e-10 is taken: at a corner of a yield surface, which the isotropic axis
is of UBCSAND, round-off decides on which side a step lies. On an edge of Mohr-Coulomb, where triaxial tests fail, the
stresses do not tell how two mechanisms divide the slip: lateral strains stay as alike as they were. What stays above
is a failure with what is left: so it says when a stress cannot be reached, as one beyond the strength.
"""

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from mpm_verify.cases.element.element import ALIKE, Element, ElementFailed, State
from mpm_verify.solver.state import Floats

STRESS = [0, 1, 3, 2]  # the stress xx, yy, xy, zz of each component of strain, in sigma xx, yy, zz, xy
PROBE = 1e-6  # strain by which the tangent is asked for; compression, which also soil without stress answers
LEAST = 1e-12  # scale of strains that are held


@dataclass(frozen=True)
class Wanted:
    """Target at a `fraction` of a leg that starts at `begin`: strains (n,) and stresses (n,) at its end.

    Either is not a number where it is not given.
    """

    strain: Floats
    stress: Floats
    begin: State
    fraction: float

    @property
    def strained(self) -> Floats:
        """Strain (n,) at the fraction, not a number where it is found."""
        at: Floats = self.begin.strain + (self.strain - self.begin.strain) * self.fraction
        return np.where(self.fraction == 1, self.strain, at)

    @property
    def stressed(self) -> Floats:
        """Stress (n,) at the fraction, not a number where it is found."""
        begin = stress(self.begin, len(self.strain))
        at: Floats = begin + (self.stress - begin) * self.fraction
        return np.where(self.fraction == 1, self.stress, at)


def stress(state: State, count: int) -> Floats:
    """Stress (n,) by component of strain; not a number for yx of a motion, which has none."""
    return np.append(state.sigma[STRESS], np.nan)[:count]


def reached(element: Element, last: State, wanted: Wanted, before: Floats | None, size: float) -> State:
    """State after one step of a leg: from the last increment, or from the tangent. Raises ElementFailed."""
    strain, target = wanted.strained, wanted.stressed
    given = np.isfinite(strain)
    increment = np.where(given, strain - last.strain, 0.0)
    if given.all():
        return element.step(last, increment[None])[0]

    def residuals(de: Floats, end: State) -> Floats:
        return np.where(given, de - increment, stress(end, len(de)) - target)

    guess = tangent(element, last, residuals(0 * increment, last), given)
    sizes = max(LEAST, *np.abs(increment), *np.abs(guess))
    scale = np.where(given, sizes, max(size, float(np.nanmax(np.abs(target)))))
    if before is not None:
        with suppress(ElementFailed):
            return element.solve(last, residuals, before, scale, corner=True)
    return element.solve(last, residuals, guess, scale, corner=True)


def tangent(element: Element, last: State, left: Floats, given: Floats) -> Floats:
    """Increment (n,) by the tangent at the start of the step, for residuals `left` (n,) without any."""
    moves = -PROBE * np.vstack([np.zeros(len(left)), np.eye(len(left))])
    ends = element.step(last, moves)
    rows = np.array([np.where(given, move, stress(end, len(left))) for move, end in zip(moves, ends, strict=True)])
    slopes = (rows[1:] - rows[0]).T / -PROBE
    return np.asarray(np.linalg.lstsq(slopes, -left, rcond=ALIKE)[0])
