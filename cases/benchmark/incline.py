"""Incline: a plane with friction at y = 0, gravity tilted against it, and the motion of a body on it."""

from dataclasses import dataclass
from math import ceil, cos, radians, sin, tan
from typing import ClassVar

import numpy as np

from mpm_verify.cases.benchmark.problem import EXACT, Measured, Problem, Watch
from mpm_verify.cases.benchmark.run import Run
from mpm_verify.solver.friction import frictional
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.model import Model
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, create, label, optional, split
from mpm_verify.solver.state import Floats, Grid
from mpm_verify.solver.step import Scheme

# With hats at points a body that moves has nodes of hardly any mass at its front: update-stress-last inverts it there.
STRESS = {"mpm": "musl"}
ROOM = 3  # cells of the grid around the body and its way
MOST = 200  # points of a curve


@dataclass(frozen=True)
class Incline:
    """Plane that falls by `theta` degrees to the right, with friction `mu`, under gravity `g`."""

    theta: float
    mu: float
    g: float

    @property
    def gravity(self) -> Floats:
        """Force per mass (2,)."""
        return self.g * np.array([sin(radians(self.theta)), -cos(radians(self.theta))])

    @property
    def slope(self) -> float:
        """Tangent of the angle, the friction from which on a block sticks."""
        return tan(radians(self.theta))

    @property
    def sliding(self) -> float:
        """Acceleration of what slides, g (sin - mu cos)."""
        return float(self.gravity[0] + self.mu * self.gravity[1])

    def placed(
        self, run: Run, layout: Layout, dx: float, travel: float, duration: float, friction: float
    ) -> tuple[Model, int]:
        """Body with a grid for its travel and a floor of some friction, from rest, and the number of its steps."""
        material, basis = create(MATERIALS, run.material), create(METHODS, run.method)
        low, high = layout.corners.min(axis=(0, 1)), layout.corners.max(axis=(0, 1))
        left = dx * (np.floor(low[0] / dx) - ROOM)
        across, up = ceil((high[0] + travel - left) / dx) + ROOM, ceil(high[1] / dx) + ROOM
        grid = Grid(dx, np.array([left, 0.0]), np.array([left + across * dx, up * dx]))
        particles = basis.populate(layout, material.rho0)
        particles.b[:] = self.gravity
        steps = ceil(duration / (run.courant * dx / material.wave_speed()) * (1 - 1e-12))
        model = Model(
            grid, particles, basis, material, frictional(grid, ("free", "free", friction, "free")), duration / steps,
            Scheme(create(TRANSFERS, run.transfer), STRESS.get(split(run.method)[0], "usl")), None,
            optional(SMOOTHINGS, run.smoothing),
        )  # fmt: skip
        return model, steps


@dataclass(frozen=True)
class OnIncline(Problem):
    """Body on an incline; E, nu, rho0 are its material's, `theta` in degrees, g in m/s2.

    Attributes
    ----------
    lengths
        Names of its other parameters, which are above zero.
    """

    source: ClassVar[str] = "Bardenhagen, Brackbill & Sulsky 2000, doi:10.1016/S0045-7825(99)00338-2"
    material: ClassVar[str] = "hypoelastic"
    methods: ClassVar[tuple[str, ...]] = ("cpdi", "gimp", "bspline2", "mpm")
    lengths: ClassVar[tuple[str, ...]]

    E: float = 1e7
    nu: float = 0.0
    rho0: float = 1000.0
    theta: float = 25.0
    mu: float = 0.3
    g: float = 10.0

    @property
    def plane(self) -> Incline:
        """Plane, with its friction."""
        return Incline(self.theta, self.mu, self.g)

    def check(self, run: Run) -> None:
        """Raise ValueError for what is no incline, or whose method knows no floor."""
        name, above = label(run.problem), ("mu", "g", *self.lengths)
        if not 0 < self.theta < 60 or not min(getattr(self, one) for one in above) > 0:
            told = f"{', '.join(above[:-1])} and {above[-1]}"
            raise ValueError(f"{name}: theta must be above 0 and below 60; {told} above zero")
        if create(METHODS, run.method).reference:
            raise ValueError(f"{name}: nodes of {run.method} move with the body, and are no floor; take cpdi")


class Motion(Watch):
    """Watch of the mean shift, velocity and turn of a body after each step.

    Attributes
    ----------
    rows
        Time, shift (2), velocity (2), angular velocity, (T,6).
    """

    def __init__(self, plane: Incline, model: Model) -> None:
        self.plane, self.kept = plane, [self.look(model)]

    def look(self, model: Model) -> tuple[float, ...]:
        """Time, centre of mass, its velocity, and the angular velocity to the right, spin over moment of inertia."""
        p = model.particles
        whole, m = float(p.m.sum()), p.m[:, None]
        x, v = (m * p.x).sum(axis=0) / whole, (m * p.v).sum(axis=0) / whole
        r, w = p.x - x, p.v - v
        spin = float((p.m * (r[:, 1] * w[:, 0] - r[:, 0] * w[:, 1])).sum())
        return model.time, *x, *v, spin / float((p.m * (r**2).sum(axis=1)).sum())

    def after_step(self, model: Model) -> None:
        """Keep the motion."""
        self.kept.append(self.look(model))

    @property
    def rows(self) -> Floats:
        """Motion from the start on."""
        rows = np.array(self.kept)
        rows[:, 1:3] -= rows[0, 1:3]
        return rows

    def excess(self) -> float:
        """Tangential impulse of the floor less mu times its normal one, over the weight's: the most at any time."""
        rows = self.rows
        t, given = rows[:, 0], rows[:, 3:5] - self.plane.gravity * rows[:, :1]
        return float((np.abs(given[:, 0]) - self.plane.mu * given[:, 1]).max() / (self.plane.g * t[-1]))

    def measured(self, values: dict[str, float], figures: dict[str, tuple[Floats, float]]) -> Measured:
        """Values and friction, and figures by name: what was moved (T,), and with which acceleration it should be."""
        t, curves = self.rows[:, 0], {}
        fine, some = np.linspace(0.0, t[-1], MOST), slice(None, None, -(-len(t) // MOST))
        for name, (moved, acceleration) in figures.items():
            curves[name, "run"] = np.stack([t[some], moved[some]])
            curves[name, EXACT] = np.stack([fine, 0.5 * acceleration * fine**2])
        return Measured({}, values | {"excess_friction": self.excess()}, curves)
