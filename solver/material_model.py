"""Contract of a constitutive model, and what it states of itself, so that no study has to ask for its class.

A model is of one of two forms: a function of F with its `energy` (solver/elastic.py), or in rate form with one kernel
`respond` (solver/rate_material.py); one with both has in rate form, with the right rate, the stress of its energy. What
a model does not have is None, or empty.
"""

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar, Literal

from mpm_verify.solver.plugins import MATERIALS
from mpm_verify.solver.state import Floats, Particles


class Material:
    """Constitutive model: writes particles.sigma, and its history, once a step.

    A subclass is a frozen dataclass of its parameters.

    Attributes
    ----------
    energy
        ``energy(F, log)``: energy W per initial volume of a 3 x 3 F of numbers or symbols.
    respond
        Kernel of signature solver.objective.RESPOND.
    kirchhoff
        Whether the stress that `respond` sees is J sigma.
    moduli
        ``moduli(s)``: shear and bulk modulus at the mean stress s in the plane, compression positive, of a model whose
        stiffness follows it.
    stored_energy
        ``stored_energy(sigma)``: elastic energy per volume (P,) under sigma (P,4).
    compression
        ``compression()``: volume strain that stress holds (solver/compression.py), of a model that opens, for pooling.
    memory
        Names of the columns of particles.history; "void" is the void strain, solver/voids.py.
    sums
        Those of them that are sums over the steps, and that nothing else of the model reads.
    small_strain
        Whether the stress is dW/dF itself: that of a function of F for small amplitudes alone.
    yields_in_plane
        Whether it yields where t = s sin(friction_angle) + cohesion cos(friction_angle).
    out_of_plane
        How a strain of zz reaches the kernel of a model in rate form, which sees plane strain (cases/element/space.py):
        ``trial``, ``plane``, or empty where it cannot.
    order
        Order in the strain step, where the axes of stress turn; None: exact or unknown.
    rho0
        Density at reference.
    formula
        Cauchy stress of F as a formula, for whoever writes it in another program; empty where there is none.
    rate
        Objective rate, a file of solver/rates; None for a function of F.
    """

    energy: Callable[[Any, Callable[[Any], Any]], Any] | None = None
    respond: ClassVar[Callable[..., Any] | None] = None
    kirchhoff: ClassVar[bool] = False
    moduli: Callable[[float], tuple[float, float]] | None = None
    stored_energy: Callable[[Floats], Floats] | None = None
    compression: Callable[[], Any] | None = None
    memory: ClassVar[tuple[str, ...]] = ()
    sums: ClassVar[tuple[str, ...]] = ()
    small_strain: ClassVar[bool] = False
    yields_in_plane: ClassVar[bool] = False
    out_of_plane: ClassVar[Literal["", "trial", "plane"]] = ""
    order: ClassVar[float | None] = None
    formula: ClassVar[str] = ""
    rho0: float
    rate: str | None = None

    @property
    def name(self) -> str:
        """Name of the file in solver/material, the word on the command line; empty for a model of no file."""
        module = type(self).__module__
        return module.rpartition(".")[2] if module.startswith(f"{MATERIALS}.") else ""

    @property
    def strays(self) -> bool:
        """Whether its rate makes it another solid than the one of the energy that it states."""
        return False

    @property
    def friction_angle(self) -> float | None:
        """Angle of friction in degrees; None without friction."""
        return None

    @property
    def fails_as_mohr_coulomb(self) -> bool:
        """Whether it fails and flows as Mohr-Coulomb in plane strain."""
        return False

    @property
    def cohesion(self) -> float | None:
        """Cohesion, a stress; None without a strength."""
        return None

    def start(self, particles: Particles) -> None:
        """Write what the model keeps of the path to `particles` at the start of a run: a function of F, nothing."""

    @abstractmethod
    def update(self, particles: Particles, dt: float) -> None:
        """Write particles.sigma (P,4) at the end of a step, from the new F.

        Parameters
        ----------
        particles
            Particles with F at the end of the step.
        dt
            Length of the step, in time.
        """
        raise NotImplementedError

    @abstractmethod
    def wave_speed(self, s: float | None = None) -> float:
        """Speed of the fastest wave.

        Parameters
        ----------
        s
            Mean stress in the plane, compression positive; None for the undeformed state.

        Returns
        -------
        float
            Length per time.
        """
        raise NotImplementedError
