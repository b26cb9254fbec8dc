"""Model of a run between two steps: a body on its grid, the strategies of a step, and who watches it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from mpm_verify.solver.context import Context
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.state import Particles
from mpm_verify.solver.stress_update import check_stress_update
from mpm_verify.solver.transfers._base import Transfer
from mpm_verify.solver.transfers.flip import Flip

if TYPE_CHECKING:  # their kernels take seconds to compile, and most runs have neither
    from mpm_verify.solver.damping import Damping
    from mpm_verify.solver.pooling import Pooling
    from mpm_verify.solver.smoothing._base import Smoothing
    from mpm_verify.solver.surface import Surface

Load = Callable[[Particles, float], None]
Deformation = Literal["linear", "exponential"]


def no_load(particles: Particles, t: float) -> None:
    """Leave the body force of particles as it is: zero, or one that travels with them."""


@dataclass(frozen=True)
class Scheme:
    """Choices of a step.

    A rigid turn by w dt makes det F grow by 1 + (w dt)^2 a step with the linear deformation, and by 1 + (w dt)^4/4 with
    the exponential one. The second keeps det F > 0 in any step unless A has the eigenvalues -1 +- i; the first inverts
    a particle at det(I + A) = 0.

    Parameters
    ----------
    transfer
        How velocities go between particles and grid, see solver/transfers.
    stress
        Stress update: ``usl``, ``musl`` or ``usf``, see solver/stress_update.py.
    staggered
        Whether v has the time levels half a step before those of x, F and sigma: a run starts with v at t = -dt/2.
        Without it usl and musl are of first order in time.
    deformation
        ``linear``: F <- (I + A) F with A = dt L (paper eq. (4)); ``exponential``: F <- (I + A + A^2/2) F, exp(A) to
        second order.

    Raises
    ------
    ValueError
        For another stress update or deformation.
    """

    transfer: Transfer = field(default_factory=Flip)
    stress: str = "usl"
    staggered: bool = True
    deformation: Deformation = "linear"

    def __post_init__(self) -> None:
        check_stress_update(self.stress)
        if self.deformation not in get_args(Deformation):
            raise ValueError(f"no deformation {self.deformation!r}; choose from {', '.join(get_args(Deformation))}")

    def half(self, dt: float) -> float:
        """Weight of A^2 F in the transfers, over dt."""
        return 0.5 * dt if self.deformation == "exponential" else 0.0


class Observer:
    """Watcher of the steps of a run, which changes nothing; hooks that a subclass does not override are not called."""

    def before_forces(self, model: "Model") -> None:
        """Look at mass, momentum and force at the nodes, before damping and the equation of motion."""

    def after_motion(self, model: "Model") -> None:
        """Look at the nodes' new velocities and accelerations; the particles still have their old ones."""

    def after_particles(self, model: "Model") -> None:
        """Look at the particles' new velocities; their stress is still the old one, except with update-stress-first."""

    def after_step(self, model: "Model") -> None:
        """Look at the end of a step, `model.steps` counts it."""


HOOKS = ("before_forces", "after_motion", "after_particles", "after_step")


@dataclass
class Model(Context):
    """All that one run holds: what the parts of a step work on, see Context, and the choices of the step.

    Parameters
    ----------
    grid, particles, basis, material, walls
        A body on its grid. The particles are put into the order of their slabs, and the material and the transfer
        start: write x, v, F and sigma before.
    dt
        Length of a step, in time.
    scheme
        Choices of a step.
    damping
        Damping of the force at the nodes, None for none.
    smoothing
        Smoothing of strain and stress, None for none.
    surface
        Edge of the body that is pulled or driven, None for none.
    pooling
        Pooling after each step, with the relief of what is crowded, see solver/pooling.py; None for none.
    steps
        Steps done; `time` is steps * dt, the time level of x, F and sigma. In a staggered run v has the level dt/2
        before it.

    Raises
    ------
    ValueError
        For a material that cannot be smoothed, or pooled.
    """

    scheme: Scheme = Scheme()
    damping: "Damping | None" = None
    smoothing: "Smoothing | None" = None
    surface: "Surface | None" = None
    pooling: "Pooling | None" = None
    damped: float = 0.0  # energy that damping has taken so far
    hooks: dict[str, list[Callable[["Model"], None]]] = field(init=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.hooks = {hook: [] for hook in HOOKS}
        if self.smoothing:
            self.smoothing.check(self.material)
        if self.pooling:
            self.pooling.start(self.material)
        self.material.start(self.particles)
        self.slabs.whole = self.surface is not None
        self.slabs.sort(self.grid, self.particles, self.basis.on_grid(self.particles))
        self.scheme.transfer.start(self)

    def watch(self, *observers: Observer) -> None:
        """Call the hooks of `observers` from now on, after those that watch already."""
        for observer in observers:
            for hook, called in self.hooks.items():
                if getattr(type(observer), hook) is not getattr(Observer, hook):
                    called.append(getattr(observer, hook))

    def tell(self, hook: str) -> None:
        """Call what watches this part of the step."""
        for look in self.hooks[hook]:
            look(self)


def check_time_step(model: Model) -> None:
    """Check that dt is a stable step: at most dx / (c + |v|), the time a wave needs to cross a cell.

    With edges that are driven it is a fraction of that, see solver/surface.py.

    Raises
    ------
    RunFailed
        UNSTABLE_STEP, with dt and its limit.
    """
    speed = model.material.wave_speed() + float(np.hypot(*model.particles.v.T).max())
    limit = model.grid.dx / speed * (model.surface.step_fraction if model.surface else 1.0)
    if model.dt > limit:
        raise RunFailed(FailureKind.UNSTABLE_STEP, numbers={"dt": model.dt, "limit": limit})
