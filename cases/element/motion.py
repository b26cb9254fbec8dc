"""One element along a motion: F is given, turns and all, so that the objective rate of a material counts.

F is xx, yy, xy, zz, yx (5,), so that the first four stand as those of strain do and pair with the same stresses. A
material in rate form is integrated as in the solver: its rate takes stress and strain into the frame of the material
and back. The step is that of F, of second order in its length with every rate: so the number of steps matters, more so
the more F turns and stretches in one. A material with a stress from F is asked for it.
"""

from functools import cached_property
from typing import Any

import numpy as np

from mpm_verify.cases.element.element import Element, State
from mpm_verify.cases.element.space import plane
from mpm_verify.cases.element.space import respond as respond_in_space
from mpm_verify.solver.rate_material import objective
from mpm_verify.solver.state import Floats, Particles

FLAT = [0, 2, 4, 1]  # xx, xy, yx, yy of F
UNIT = np.array([1.0, 1.0, 0.0, 1.0, 0.0])


class Motion(Element):
    """Element whose states hold F, see above."""

    @cached_property
    def frame(self) -> Any:
        """Rate of the material, None of a stress from F."""
        return None if self.material.respond is None else objective(self.material.rate)

    def start(self, sigma: Floats) -> State:
        """State under the stress sigma (4,), undeformed."""
        begin = super().start(sigma)
        return State(UNIT.copy(), begin.sigma, begin.history)

    def step(self, state: State, increments: Floats) -> list[State]:
        """States after each of the increments of F (n,5), all from the same state."""
        ends = state.strain + increments
        if self.frame is None:
            sigma, history = self.of_F(ends), np.zeros((len(ends), 0))
        else:
            sigma, history = self.integrated(state, ends)
        return [State(*parts) for parts in zip(ends, sigma, history, strict=True)]

    def of_F(self, ends: Floats) -> Floats:
        """Stress (n,4) of F (n,5), in plane strain."""
        count = len(ends)
        p = Particles(np.zeros((count, 2)), np.ones(count), np.ones(count), np.zeros((count, 0)))
        p.F = np.ascontiguousarray(matrices(ends)[:, :2, :2])
        self.material.update(p, 1.0)
        return p.sigma

    def integrated(self, state: State, ends: Floats) -> tuple[Floats, Floats]:
        """Stress (n,4) and history (n,H) of a material in rate form at F (n,5)."""
        count = len(ends)
        old, new = (np.ascontiguousarray(F[:, FLAT]).ravel() for F in (np.tile(state.strain, (count, 1)), ends))
        flat, de = np.tile(self.weight(state.strain) * state.sigma, count), np.empty(3 * count)
        self.frame.unrotate(old, new, flat, de)
        sigma, history = flat.reshape(count, 4), np.tile(state.history, (count, 1))
        zz = 2 * (ends[:, 3] - state.strain[3]) / (ends[:, 3] + state.strain[3])
        increments = np.column_stack([de.reshape(count, 3), zz])
        respond = respond_in_space if zz.any() else plane
        respond(self.material, self.constants, sigma, increments, history)
        flat = np.ascontiguousarray(sigma).ravel()
        self.frame.rotate(old, new, flat)
        return flat.reshape(count, 4) / self.weight(ends)[:, None], history

    def volume(self, strain: Floats) -> Floats:
        """Determinant of F (...,5)."""
        xx, yy, xy, zz, yx = np.moveaxis(strain, -1, 0)
        J: Floats = (xx * yy - xy * yx) * zz
        return J


def matrices(F: Floats) -> Floats:
    """F (n,3,3) of its components xx, yy, xy, zz, yx (n,5)."""
    full = np.zeros((len(F), 3, 3))
    full[:, 0, 0], full[:, 1, 1], full[:, 0, 1], full[:, 2, 2], full[:, 1, 0] = F.T
    return full


def stretches(F: Floats) -> Floats:
    """Larger and smaller logarithmic stretch (n,2) in the plane of F (n,5)."""
    logs: Floats = np.log(np.linalg.svd(matrices(F)[:, :2, :2], compute_uv=False))
    return logs
