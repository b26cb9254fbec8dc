"""One element of a material without a grid: strains or stresses are given, the rest is found, step by step.

The material works in its own frame, so no rotation is involved. Strains are logarithmic, tensor components xx, yy, xy,
tension positive; zz is a fourth where it is strained, and zero in plane strain. A material in rate form is asked by its
kernel; one with a stress from F by F = exp(strain). What turns has a motion instead of strains: motion.py.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from math import inf
from typing import Any

import numpy as np

from mpm_verify.cases.element.space import plane
from mpm_verify.cases.element.space import respond as respond_in_space
from mpm_verify.solver.state import Floats, Particles

TOLERANCE, ENOUGH = 1e-13, 1e-12  # of the residuals' scales: where Newton ends, and what round-off may leave
ATTEMPTS, NUDGE = 60, 1e-7
CORNER, ALIKE = 1e-10, 1e-7  # on an edge: what round-off may leave, and a stiffness that is none, as a fraction
PLANE, SPACE, MOTION = 3, 4, 5  # components of strain in the plane, with zz, and of the F of a motion


class ElementFailure(StrEnum):
    """Kinds of failure of a step."""

    NOT_FINITE = "not_finite"  # a stress that is not finite
    NO_STRAIN = "no_strain"  # no strain leads to what is asked


class ElementFailed(Exception):  # noqa: N818 - what cannot go on is a result
    """Error of a step that cannot be solved: why, and the largest residual that is left, as a fraction of its scale."""

    def __init__(self, cause: ElementFailure, left: float = inf) -> None:
        super().__init__(cause, left)
        self.cause, self.left = cause, left


@dataclass(frozen=True)
class State:
    """State of an element: strain (3,): xx, yy, xy, or (4,) with zz; sigma (4,): xx, yy, zz, xy; history (H,).

    Of a motion `strain` is F (5,): xx, yy, xy, zz, yx.
    """

    strain: Floats
    sigma: Floats
    history: Floats


# Residuals of a step, zero where it is as asked: of the strain increment, as many, and of the state at its end.
Control = Callable[[Floats, State], Floats]


@dataclass(frozen=True)
class Element:
    """Material as a function of states."""

    material: Any

    @cached_property
    def constants(self) -> Floats:
        """Constants that the kernel of a material in rate form reads."""
        constants: Floats = self.material.constants()
        return constants

    def start(self, sigma: Floats) -> State:
        """State under the stress sigma (4,); a material with a stress from F starts undeformed whatever it is."""
        if self.material.respond is not None:
            return State(np.zeros(3), sigma.copy(), self.material.initial(sigma[None])[0])
        return State(np.zeros(3), np.zeros(4), np.zeros(0))

    def step(self, state: State, increments: Floats) -> list[State]:
        """States after each of the strain increments (n,3) or (n,4), all from the same state."""
        count = len(increments)
        strains = state.strain + increments
        if self.material.respond is not None:
            rows = np.tile(state.sigma * self.weight(state.strain), (count, 1))
            memories = np.tile(state.history, (count, 1))
            respond = plane if increments.shape[1] == PLANE else respond_in_space
            respond(self.material, self.constants, rows, increments, memories)
            rows /= self.weight(strains)[:, None]
        else:
            p = Particles(np.zeros((count, 2)), np.ones(count), np.ones(count), np.zeros((count, 0)))
            p.F = np.ascontiguousarray(stretch(strains))
            self.material.update(p, 1.0)
            rows, memories = p.sigma, np.zeros((count, 0))
        return [State(*parts) for parts in zip(strains, rows, memories, strict=True)]

    def weight(self, strain: Floats) -> Floats:
        """Stress that the kernel of a material in rate form sees, over the Cauchy stress, at strains (...,n)."""
        return self.volume(strain) if self.material.kirchhoff else np.ones(strain.shape[:-1])

    def volume(self, strain: Floats) -> Floats:
        """Volume over the initial one at strains (...,3 or 4)."""
        return np.asarray(np.exp(strain[..., 0] + strain[..., 1] + strain[..., PLANE:].sum(axis=-1)))

    def solve(self, state: State, control: Control, guess: Floats, scale: Floats, corner: bool = False) -> State:
        """State after one step under a control; `scale` is the size of its residuals. Raises ElementFailed.

        With `corner` stresses may lie on an edge of a yield surface: strains that they do not tell apart stay as in the
        guess, and round-off may leave CORNER.

        Newton with a tangent by differences, and half the step where that does not bring the residual down: a corner
        of a yield surface has a tangent on either side. It ends at round-off: where no shorter step is better.
        """
        nudge = NUDGE * max(1e-6, float(np.abs(guess).max()))
        x, best = guess.copy(), np.inf
        for _ in range(ATTEMPTS):
            moves = x + nudge * np.vstack([np.zeros(len(x)), np.eye(len(x))])
            ends = self.step(state, moves)
            residuals = np.array([control(move, end) / scale for move, end in zip(moves, ends, strict=True)])
            best = float(np.abs(residuals[0]).max())
            if not np.isfinite(residuals).all():
                raise ElementFailed(ElementFailure.NOT_FINITE)
            if best < TOLERANCE:
                return ends[0]
            # Least squares: perfect plasticity may leave a tangent without an inverse on the way.
            newton = np.linalg.lstsq(
                (residuals[1:] - residuals[0]).T / nudge, -residuals[0], rcond=ALIKE if corner else 1e-13
            )[0]
            better = self._shorten(state, control, x, newton, scale, best)
            if better is None:
                break
            x = better
        if best < (CORNER if corner else ENOUGH):
            return self.step(state, x[None])[0]
        raise ElementFailed(ElementFailure.NO_STRAIN, best)

    def _shorten(
        self, state: State, control: Control, x: Floats, move: Floats, scale: Floats, best: float
    ) -> Floats | None:
        """Strain increment after the longest of the halved moves that lessens the residual; None where none does."""
        for halvings in (range(1), range(1, 12)):  # the whole move is mostly right
            tried = x + move * 0.5 ** np.array(halvings)[:, None]
            for candidate, end in zip(tried, self.step(state, tried), strict=True):
                if float(np.abs(control(candidate, end) / scale).max()) < best:
                    return np.asarray(candidate)
        return None


def finite(state: State) -> State:
    """Give the state back; ElementFailed where its stress is not finite."""
    if not np.isfinite(state.sigma).all():
        raise ElementFailed(ElementFailure.NOT_FINITE)
    return state


def stretch(strain: Floats) -> Floats:
    """Stretch exp(strain) of strains xx, yy, xy (...,3) as (...,2,2): e^m (cosh r I + sinh r / r dev)."""
    m, half, xy = (strain[..., 0] + strain[..., 1]) / 2, (strain[..., 0] - strain[..., 1]) / 2, strain[..., 2]
    r = np.hypot(half, xy)
    even, odd = np.exp(m) * np.cosh(r), np.exp(m) * np.sinc(1j * r / np.pi).real
    rows = [[even + odd * half, odd * xy], [odd * xy, even - odd * half]]
    stretched: Floats = np.moveaxis(np.array(rows), (0, 1), (-2, -1))
    return stretched
