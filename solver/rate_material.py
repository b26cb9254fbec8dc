"""Contract of a material in rate form: one kernel that responds to strain increments, an objective rate around it."""

from contextlib import nullcontext
from dataclasses import dataclass
from functools import cache
from typing import ClassVar, cast

import numpy as np

from mpm_verify.solver._jit import Function
from mpm_verify.solver.kirchhoff import weighted
from mpm_verify.solver.material_model import Material
from mpm_verify.solver.objective import Rate, integrate
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, RATES, USUAL_RATE, available, load
from mpm_verify.solver.state import Floats, Ints, Particles


@dataclass(frozen=True)
class RateMaterial(Material):
    """Material in rate form.

    A subclass has `respond`, a kernel of signature solver.objective.RESPOND, its `constants` (k,), and in `memory` the
    names of what it keeps of the path, one column of Particles.history each.

    Parameters
    ----------
    rate
        Objective rate, a file of solver/rates; negative controls (solver/negative_controls) are taken too: they are
        there to be seen failing.

    Raises
    ------
    ValueError
        For another rate.
    """

    rate: str = USUAL_RATE
    respond: ClassVar[Function]

    def __post_init__(self) -> None:
        objective(self.rate)

    def constants(self) -> Floats:
        """Constants (k,) that the kernel reads."""
        raise NotImplementedError

    def initial(self, sigma: Floats) -> Floats:
        """History (P,H) of particles under the stress sigma (P,4) that have seen nothing yet."""
        return np.zeros((len(sigma), len(self.memory)))

    def renew(self, particles: Particles, rows: Ints) -> None:
        """Write the history of particles in `rows` that pooling opened or closed: nothing, unless stress decides it."""

    def mobilise(self, particles: Particles) -> None:
        """Write the history that the stress of particles has at least: nothing, unless it is of the stress."""

    def start(self, particles: Particles) -> None:
        """Write F at the start of the first step, history and work, unless they go on from an earlier run."""
        if not particles.F_old.size:
            particles.F_old = particles.F.reshape(-1, 4).copy()
            particles.history = self.initial(particles.sigma)
            particles.work = np.zeros((len(particles), 2))

    def update(self, particles: Particles, dt: float, F_smoothed: Floats | None = None) -> None:
        """Write particles.sigma, history and work, from F_old and the new F.

        Parameters
        ----------
        particles
            Particles that the material has started, with F at the end of the step.
        dt
            Length of the step; it does not matter.
        F_smoothed
            F (P,2,2) whose way from F_old gives the strain, None for the new F; the rotation is that of F.

        Raises
        ------
        ValueError
            For particles that the material has not started: there is no F to go on from.
        """
        frame, p = objective(self.rate), particles
        if p.F_old.shape[1:] != (4,) or p.history.shape[1:] != (len(self.memory),):
            raise ValueError(f"{type(self).__name__} must start the particles before it updates them")
        F_smoothed = p.F if F_smoothed is None else F_smoothed
        convects = getattr(frame, "convects", False)
        with weighted(p, convects) if self.kirchhoff else nullcontext():
            integrate(
                frame.unrotate, frame.rotate, self.respond, self.constants(), p.F_old, F_smoothed, p.F, p.sigma,
                p.history, p.work
            )  # fmt: skip


@cache
def objective(name: str) -> type[Rate]:
    """Plug-in of a rate, looked for once a process. Raises ValueError that lists the rates for another name."""
    return cast("type[Rate]", load(NEGATIVE_CONTROLS if name in available(NEGATIVE_CONTROLS) else RATES, name))
