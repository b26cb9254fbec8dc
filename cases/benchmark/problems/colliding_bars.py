"""Colliding bars: two elastic bars meet, and part with their velocities exchanged after twice the travel of a wave.

Two bars of length L and wave speed c move towards each other with v0. Where they meet, a wave of the stress -rho c v0
goes into each and brings it to rest; it comes back from the free end as one that unloads. So the contact lasts 2 L / c,
all of a bar bears rho c v0 in the middle of it, and the bars part with the velocities -v0 and v0, free of stress
(Achenbach 1973, Wave Propagation in Elastic Solids, for waves in one dimension).

The single velocity field of a grid is all that keeps the bars apart: they touch as soon as they give to one node. So
contact comes early, at a distance between the ends that the support of the weights tells,

    2 r + 2 e   where they meet at a node, r the reach of a weight, e that of a particle beyond its end, in cells

r = 1 for hats, 3/2 for quadratic and 2 for cubic splines; e = 0 for domains, whose corner is the end, and -1/4 for
points, with two along a cell: 3/2 cells for mpm, 2 for cpdi, gimp and cpgimp, 5/2 for bspline2. It is a distance of
first order in dx; the wave knows nothing of it. The force begins softly, as a corner has little weight at the node:
what slow bars feel grows with the cube of their way, and the contact of slow bars seems long on coarse grids. The usual
speed is a tenth of the wave's, and the material is linear in the nominal stress, so that the closed form is exact.

Registered: points do not come through. An end of mpm that enters a cell alone, with next to no mass at its far node,
has a step that is not stable there: on 64 cells and more it is inverted. The nodes of a total Lagrangian method are
those of one body: its bars never meet.
"""

from dataclasses import dataclass
from math import ceil, nan, sqrt
from typing import ClassVar

import numpy as np

from mpm_verify.cases.benchmark.problem import Drawn, Held, Measured, Problem, Setup, Watch
from mpm_verify.cases.benchmark.run import Run
from mpm_verify.solver.boundary import box
from mpm_verify.solver.layout import Layout, rectangle
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, create, optional, split
from mpm_verify.solver.state import Floats, Grid
from mpm_verify.solver.step import Model, Scheme

L = 1.0
APART = 4  # cells between the bars at first
AFTER = 3.0  # travels of a wave along a bar, from contact to the end of a run
ROUND_OFF = 1e-9  # of a distance in cells: bars of cpdi touch at the very start of a step
TOUCH = 1e-9  # of rho c v0, a stress that is a contact
LOW, HIGH = 0.05, 0.95  # fractions of the exchanged momentum between which the contact is timed
REACH = {"mpm": 1.0, "gimp": 1.0, "cpgimp": 1.0, "cpdi": 1.0, "cpdi2": 1.0, "bspline2": 1.5, "bspline3": 2.0}
POINTS = ("mpm", "bspline2", "bspline3")
LIGHT = 0.8  # density of the right bar of the failing control, over that of the left one


@dataclass(frozen=True)
class CollidingBars(Problem):
    """Bars that meet; E, nu, rho0 are those of the material.

    References
    ----------
    Bardenhagen, Brackbill & Sulsky 2000, doi:10.1016/S0045-7825(99)00338-2, for contact by the grid alone.
    """

    source: ClassVar[str] = "Bardenhagen, Brackbill & Sulsky 2000, doi:10.1016/S0045-7825(99)00338-2"
    material: ClassVar[str] = "linear_elastic"
    cells: ClassVar[tuple[int, ...]] = (16, 32, 64)
    quick: ClassVar[tuple[int, ...]] = (8, 16, 32)
    methods: ClassVar[tuple[str, ...]] = ("cpdi", "gimp", "bspline2")
    figures: ClassVar[dict[str, Drawn]] = {
        "velocity": Drawn(
            "time from contact / (L / c)",
            "mean velocity of the left bar / v₀",
            "mean velocity of the left bar, from contact on",
            True,
        ),
        "stress": Drawn(
            "time from contact / (L / c)",
            "mean stress of the left bar / (\N{GREEK SMALL LETTER RHO} c v₀)",
            "mean stress of the left bar, from contact on",
            True,
        ),
    }

    E: float = 1.0
    nu: float = 0.0
    rho0: float = 1.0
    speed: float = 0.1  # of each bar, over that of the wave

    def check(self, run: Run) -> None:
        """Raise ValueError for bars that are too fast, of another material, or whose method keeps them apart."""
        if split(run.material)[0] != self.material:
            raise ValueError(
                f"colliding_bars: the closed form is that of {self.material} alone, not of {run.material}; "
                "leave --material out"
            )
        if not 0 < self.speed <= 0.3:
            raise ValueError(f"colliding_bars: speed = {self.speed:g} must be above 0 and at most 0.3")
        if create(METHODS, run.method).reference:
            raise ValueError(f"colliding_bars: bodies never meet in {run.method}, whose nodes move with one; take cpdi")

    def setup(self, run: Run) -> Setup:
        """Two bars of one cell's height, a few cells apart, with a grid that they do not leave."""
        material, basis = create(MATERIALS, run.material), create(METHODS, run.method)
        dx, c = L / run.cells, material.wave_speed()
        half = 0.5 * APART * dx
        side = dx * ceil(run.cells * (1 + AFTER * self.speed) + APART + 3)
        grid = Grid(dx, np.array([-side, 0.0]), np.array([side, dx]))
        bars = [
            rectangle(np.array([left, 0.0]), np.array([left + L, dx]), dx, run.ppc, run.offset)
            for left in (-half - L, half)
        ]
        layout = Layout(*(np.concatenate([getattr(bar, name) for bar in bars]) for name in ("X", "V0", "r0")))
        particles = basis.populate(layout, material.rho0)
        right = particles.X[:, 0] > 0
        if run.control:
            particles.m[right] *= LIGHT
        particles.v[:, 0] = np.where(right, -1.0, 1.0) * self.speed * c
        model = Model(
            grid, particles, basis, material, box(grid, ("free", "free", "roller", "roller")), run.courant * dx / c,
            Scheme(create(TRANSFERS, run.transfer)), None,
            optional(SMOOTHINGS, run.smoothing),
        )  # fmt: skip
        steps = ceil((half / (self.speed * c) + AFTER * L / c) / model.dt)
        return Setup(model, steps, Bars(self, run, c))

    def distance(self, run: Run) -> float:
        """Distance of the ends at contact, in cells."""
        name = split(run.method)[0]
        return 2 * REACH.get(name, nan) - (1 / sqrt(run.ppc) if name in POINTS else 0.0)

    def held(self, run: Run) -> tuple[Held, ...]:
        """Duration, stress and velocity by their limits, the distance of each grid, and momentum to round-off."""
        name, found = (
            split(run.method)[0],
            [Held("momentum", 1e-12, "at_most", "nothing pulls at both bars", of="each")],
        )
        if name in REACH:
            half = self.speed * run.courant + ROUND_OFF  # in cells: contact is between the starts of two steps
            found.append(Held("distance", self.distance(run), "absolute", "reach of the weights", half, "each"))
        if name != "mpm":
            found += [
                Held("contact_time", 1.0, "relative", "twice the travel of the wave", 0.02),
                Held("stress", 1.0, "relative", "rho c v0", 0.02),
                Held("exit_velocity", 1.0, "relative", "velocities are exchanged", 0.02),
            ]
        return tuple(found)

    def particles(self, run: Run) -> int:
        """Number of particles."""
        return 2 * run.cells * run.ppc

    def updates(self, run: Run) -> float:
        """Particle updates: bars come near, and a wave goes to and fro."""
        return self.particles(run) / run.courant * (0.5 * APART / self.speed + AFTER * run.cells)


class Bars(Watch):
    """Measure of both bars after each step: momentum, mean stress of the left one, distance of the ends."""

    def __init__(self, problem: CollidingBars, run: Run, c: float) -> None:
        self.problem, self.run, self.c = problem, run, c
        self.t: list[float] = []
        self.rows: list[tuple[float, ...]] = []

    def after_step(self, model: Model) -> None:
        """Keep the numbers; the run ends a while after contact."""
        p = model.particles
        left = p.X[:, 0] < 0
        momentum = p.m * p.v[:, 0]
        mass, v0 = float(p.m[left].sum()), self.problem.speed * self.c
        gap = L / self.run.cells * APART + float(
            (p.x - p.X)[~left, 0][p.X[~left, 0].argmin()] - (p.x - p.X)[left, 0][p.X[left, 0].argmax()]
        )
        self.t.append(model.time)
        stress = p.sigma[left, 0] / (model.material.rho0 * self.c * v0)
        self.rows.append((float(momentum[left].sum()) / (mass * v0), float(momentum.sum()) / (mass * v0),
                          float(stress.mean()), float(np.abs(stress).max()), gap / model.grid.dx))  # fmt: skip

    def found(self, model: Model) -> Measured:
        """Numbers of the contact, and both histories."""
        t, (own, both, stress, largest, gap) = np.array(self.t), np.array(self.rows).T
        touched = np.flatnonzero(largest > TOUCH)
        if not len(touched):
            return Measured()
        first, last = int(touched[0]), float(own[-1])
        begin, end = (crossed(t, own, 1 + part * (last - 1)) for part in (LOW, HIGH))
        unit = L / self.c
        values = {
            "contact_time": (end - begin) / (HIGH - LOW) / (2 * unit),
            "stress": float(-stress.min()),
            "exit_velocity": -last,
            "momentum": float(np.abs(both - both[0]).max()),
            "distance": float(
                gap[first - 1] + self.problem.speed * self.run.courant
            ),  # between the starts of two steps
        }
        late = t > t[first] - 0.5 * unit
        since = (t[late] - t[first]) / unit
        line = np.array([-0.5, 0.0, 1.0, 2.0, 3.0])
        curves = {
            ("velocity", "run"): np.stack([since, own[late]]),
            ("velocity", "exact"): np.stack([line, [1.0, 1.0, 0.0, -1.0, -1.0]]),
            ("stress", "run"): np.stack([since, -stress[late]]),
            ("stress", "exact"): np.stack([line, [0.0, 0.0, 1.0, 0.0, 0.0]]),
        }
        return Measured({}, values, curves)


def crossed(t: Floats, values: Floats, level: float) -> float:
    """First time at which values (n,) at the times t (n,) have fallen to a level, on a straight line between two."""
    k = int(np.flatnonzero(values <= level)[0])
    return float(t[k - 1] + (t[k] - t[k - 1]) * (values[k - 1] - level) / (values[k - 1] - values[k]))
