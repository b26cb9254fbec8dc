"""What a material in rate form is: one kernel that responds to strain increments, and an objective rate around it."""

from dataclasses import dataclass
from functools import cache
from typing import ClassVar, cast

import numpy as np

from mpm_verify.solver._jit import Function
from mpm_verify.solver.material_model import Material
from mpm_verify.solver.objective import Rate, integrate
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, RATES, USUAL_RATE, available, load
from mpm_verify.solver.state import Floats, Particles


@dataclass(frozen=True)
class RateMaterial(Material):
    """`rate`: the objective rate, a file of solver/rates; raises ValueError for another.

    A subclass has `respond`, a kernel of solver.objective.RESPOND, its `constants` (k,), and in `memory` the names of
    what it keeps of the path, one column of Particles.history each. Negative controls (solver/negative_controls) are
    taken as a rate too: they are there to be seen failing.
    """

    rate: str = USUAL_RATE
    respond: ClassVar[Function]

    def __post_init__(self) -> None:
        objective(self.rate)

    def constants(self) -> Floats:
        """What the kernel reads."""
        raise NotImplementedError

    def initial(self, sigma: Floats) -> Floats:
        """History (P,H) of particles under the stress sigma (P,4) that have seen nothing yet."""
        return np.zeros((len(sigma), len(self.memory)))

    def start(self, particles: Particles) -> None:
        """F at the start of the first step, and the history, unless it goes on from an earlier run."""
        if not particles.F_old.size:
            particles.F_old = particles.F.reshape(-1, 4).copy()
            particles.history = self.initial(particles.sigma)
            particles.work = np.zeros((len(particles), 2))

    def update(self, particles: Particles, dt: float, F_smoothed: Floats | None = None) -> None:
        """Write particles.sigma, history and work, from F_old and the new F; the step's length does not matter.

        The strain is that of the way from F_old to `F_smoothed` (P,2,2), if it is given, and the rotation that of F.
        Raises ValueError for particles that the material has not started: there is no F to go on from.
        """
        frame, p = objective(self.rate), particles
        if p.F_old.shape[1:] != (4,) or p.history.shape[1:] != (len(self.memory),):
            raise ValueError(f"{type(self).__name__} must start the particles before it updates them")
        F_smoothed = p.F if F_smoothed is None else F_smoothed
        integrate(
            frame.unrotate, frame.rotate, self.respond, self.constants(), p.F_old, F_smoothed, p.F, p.sigma,
            p.history, p.work
        )  # fmt: skip


@cache
def objective(name: str) -> type[Rate]:
    """The plug-in of a rate, looked for once a process. Raises ValueError that lists the rates for another name."""
    return cast("type[Rate]", load(NEGATIVE_CONTROLS if name in available(NEGATIVE_CONTROLS) else RATES, name))
