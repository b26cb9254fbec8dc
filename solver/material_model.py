"""What a constitutive model is, and what it states of itself, so that no study has to ask for its class.

A model is of one of two forms: a function of F with its `energy` (solver/elastic.py), or in rate form with one kernel
`respond` (solver/rate_material.py). What a model does not have is None, or empty.
"""

from collections.abc import Callable
from typing import Any, ClassVar

from mpm_verify.solver.plugins import MATERIALS
from mpm_verify.solver.state import Floats, Particles


class Material:
    """Writes particles.sigma, and its history, once a step. A subclass is a frozen dataclass of its parameters.

    energy(F, log): W per initial volume of a 3 x 3 F of numbers or symbols; respond: a kernel of
    solver.objective.RESPOND; moduli(s): shear and bulk modulus at the mean stress s in the plane, compression positive,
    of a model whose stiffness follows it; stored_energy(sigma): elastic energy per volume (P,) under sigma (P,4).
    """

    energy: Callable[[Any, Callable[[Any], Any]], Any] | None = None
    respond: ClassVar[Callable[..., Any] | None] = None
    moduli: Callable[[float], tuple[float, float]] | None = None
    stored_energy: Callable[[Floats], Floats] | None = None
    memory: ClassVar[tuple[str, ...]] = ()  # columns of particles.history; "void" is the void strain, solver/voids.py
    yields_in_plane: ClassVar[bool] = False  # where t = s sin(friction_angle) + cohesion cos(friction_angle)
    order: ClassVar[float | None] = None  # in the strain step, where the axes of stress turn; None: exact or unknown
    rho0: float  # density at reference
    rate: str | None = None  # the objective rate, a file of solver/rates

    @property
    def name(self) -> str:
        """The file in solver/material that this is of, the word on the command line; empty for a model of no file."""
        files = (kind.__module__ for kind in type(self).__mro__ if kind.__module__.startswith(f"{MATERIALS}."))
        return next(files, "").rpartition(".")[2]

    @property
    def friction_angle(self) -> float | None:
        """Angle of friction in degrees; None without friction."""
        return None

    @property
    def cohesion(self) -> float | None:
        """Cohesion, a stress; None without a strength."""
        return None

    def start(self, particles: Particles) -> None:
        """Write what the model keeps of the path, at the start of a run; a function of F keeps nothing."""

    def update(self, particles: Particles, dt: float) -> None:
        """Write particles.sigma at the end of a step of length dt, from the new F."""
        raise NotImplementedError

    def wave_speed(self, s: float | None = None) -> float:
        """Speed of the fastest wave: in the undeformed state, or under the mean stress s, compression positive."""
        raise NotImplementedError
