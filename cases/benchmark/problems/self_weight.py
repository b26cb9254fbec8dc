"""Self-weight column: a soft column settles under gravity to half its height, with a known stress.

A column of height H stands on a roller between rollers, and gravity is raised to g over eight of its slowest periods
and then held until local damping has brought it to rest. Forces of a grid are fewer than its particles, so that they
balance in many states, and the column comes to rest in one that its way leads to: raised over two periods it swings
beyond its rest and back, its error is twice as large, and grows by 10 to 15 % with half the time step. Raised slowly it
comes from one side, and half the step changes the error by 0.3 %. The neo-Hookean column, which is pressed to an
eighth, takes `ramp=16`: over 8 its error is 12 % too small on 32 cells and 11 % too large on 48. The stress is known
for any constitutive model: the area does not change, so that the Cauchy stress is the nominal one,

    sigma_yy = -rho0 g (H - Y),   Y the height of a particle at reference.

With an energy W the stretch l(Y) solves dW/dl = sigma_yy, and a particle comes to rest at the integral of l from 0 to
Y. With nu = 0 and q = rho0 g H / E it is closed:

    Hencky: ln(l) / l = -q, so l = W(q) / q at the base, and the height is H (W(q) + W(q)^2 / 2) / q
    neo-Hookean: (l - 1/l) / 2 = -q, so l = sqrt(q^2 + 1) - q, and the height is H times its mean from 0 to q

with W the function of Lambert: base stretch 0.30370 and height 24.233 m, or 0.12542 and 16.362 m.

The internal force of a cell balances the weight above it, so a stress belongs to a cell. With hats and two particles
along it, one is a quarter of a cell too low for it and one too high: held against the exact stress at its own height
each misses by rho0 g dx / 4, a first order that is none. Cell by cell, by the weights of the method itself, domains
that tile the column give the exact stress to round-off (cpdi, cpdi2, tlmpm).

Expected of the position: order 2 where domains tile the column. mpm is inverted while it is loaded, where a particle
is alone in a cell. gimp and bspline2 stall: three times as many particles as at first crowd the lowest cells, whose
domains of fixed size overlap and pass the floor, or which are summed as points. Domains of cpgimp follow F too, but
their centres move with a mean over the domain and not with that of its ends, so gaps open: its order goes to and fro.
"""

from dataclasses import dataclass
from math import ceil
from typing import Any, ClassVar

import numpy as np

from mpm_verify.cases.benchmark.balance import cell_stress, rms
from mpm_verify.cases.benchmark.problem import AT_REST, Drawn, Held, Measured, Pair, Problem, Setup, Watch
from mpm_verify.cases.benchmark.run import Run
from mpm_verify.cases.benchmark.uniaxial import stiffness, stretch, stretches
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.solver.boundary import box
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.layout import per_side, rectangle
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, create, optional, split
from mpm_verify.solver.reaction import Reaction
from mpm_verify.solver.state import Floats, Grid, Particles
from mpm_verify.solver.step import Model, Scheme, particles_to_grid

TILE = ("cpdi", "cpdi2", "tlmpm")  # methods whose domains tile the column as it deforms
DEVIATIONS = {  # of the position; see above
    "gimp": Expectation(None, stall=1.0, stall_h=1 / 32, source="measured"),
    "bspline2": Expectation(None, stall=1.0, stall_h=1 / 32, source="measured"),
    "mpm": Expectation(None, source="measured"),
}
MOST = 10.0  # times gravity takes to rise, after which a run ends though it is not at rest
REST = 1e-11  # largest force of a node at rest, over the whole weight
STIFFEST = 1e6  # stiffness over the weight per area, whose round-off of the stretch is 2e-10 of the weight
SAMPLES = 33  # heights at which the fastest wave is looked for
HEAVY = 1.02  # gravity of the failing control, over that of the problem


@dataclass(frozen=True)
class SelfWeight(Problem):
    """Column under its own weight; E, nu, rho0 of its material, height H in m, gravity g in m/s2, local damping.

    `ramp` is the number of slowest periods in which gravity rises.

    References
    ----------
    Coombs & Augarde 2020, doi:10.1016/j.advengsoft.2019.102748, for the problem and its constants.
    """

    source: ClassVar[str] = "Coombs & Augarde 2020, doi:10.1016/j.advengsoft.2019.102748"
    material: ClassVar[str] = "hencky"
    cells: ClassVar[tuple[int, ...]] = (12, 16, 24, 32, 48, 64, 96)
    quick: ClassVar[tuple[int, ...]] = (16, 24, 36, 54)
    methods: ClassVar[tuple[str, ...]] = ("cpdi", "tlmpm")
    figures: ClassVar[dict[str, Drawn]] = {
        "stress": Drawn("vertical stress [kPa]", "height at rest [m]", "stress of each particle, and the exact one"),
        "cells": Drawn("height at rest [m]", "stress less the exact one [Pa]", "what particles and cells miss by"),
    }

    E: float = 1e4
    nu: float = 0.0
    rho0: float = 80.0
    H: float = 50.0
    g: float = 9.81
    damping: float = 0.5
    ramp: float = 8.0

    def check(self, run: Run) -> None:
        """Raise ValueError for a material whose rest position is not known."""
        if not min(self.H, self.g, self.ramp) > 0 or not 0 < self.damping < 1:
            raise ValueError("self_weight: H, g and ramp must be above zero, and damping between 0 and 1")
        material = create(MATERIALS, run.material)
        if material.energy is None:
            raise ValueError(f"self_weight needs a material with an energy, which {run.material} has not; take hencky")
        weight = -float(self.stress(material, 0.0))
        stretch(material, -weight)
        if not stiffness(material, 1.0) <= STIFFEST * weight:
            most = f"{1e-3 * STIFFEST * weight:g}"
            raise ValueError(f"self_weight: round-off of so stiff a material is above what is held; take E = {most}")

    def stress(self, material: Any, Y: Any) -> Any:
        """Vertical stress at heights Y at reference."""
        return -material.rho0 * self.g * (self.H - Y)

    def setup(self, run: Run) -> Setup:
        """Column of one cell's width; the step is that of the fastest wave at rest, on the grid of the method."""
        material, basis = create(MATERIALS, run.material), create(METHODS, run.method)
        dx = self.H / run.cells
        upper = np.array([dx, self.H])
        grid = Grid(dx, np.zeros(2), upper)
        particles = basis.populate(rectangle(np.zeros(2), upper, dx, run.ppc, run.offset), material.rho0)
        Y = np.linspace(0.0, self.H, SAMPLES)
        at_rest = stretches(material, self.stress(material, Y))
        speed = np.sqrt([stiffness(material, one) / material.rho0 for one in at_rest])  # at reference
        dt = run.courant * dx / float((speed if basis.reference else at_rest * speed).max())
        period = 4 * float(np.trapezoid(1 / speed, Y))
        model = Model(
            grid, particles, basis, material, box(grid, ("roller", "roller", "roller", "free")), dt,
            Scheme(create(TRANSFERS, run.transfer)), Damping(self.damping),
            optional(SMOOTHINGS, run.smoothing),
        )  # fmt: skip
        g, ramp = self.g * (HEAVY if run.control else 1.0), self.ramp * period

        def weight(particles: Particles, t: float) -> None:
            particles.b[:, 1] = -g * min(1.0, t / ramp)

        floor = Reaction(grid.nodes[:, 1] < 0.5 * dx)
        model.watch(floor)
        return Setup(model, ceil(MOST * ramp / dt), AtRest(self, ramp, per_side(run.ppc), floor), weight)

    def measures(self, run: Run) -> tuple[Pair, ...]:
        """Position, stress of cells and of particles."""
        return ("u", "rms"), ("sigma", "cells"), ("sigma", "particles")

    def expectation(self, run: Run, quantity: str, norm: str) -> Expectation | None:
        """Order 2 of the position where domains follow F; the stress of particles is only shown."""
        name = split(run.method)[0]
        if quantity != "u":
            return None
        return Expectation(2.0, source="measured") if name in TILE else DEVIATIONS.get(name)

    def held(self, run: Run) -> tuple[Held, ...]:
        """Stretch at the base and height at rest, and the exact stress of cells."""
        material, name = create(MATERIALS, run.material), split(run.method)[0]
        if name not in TILE:
            return ()
        base, height = stretch(material, self.stress(material, 0.0)), float(self.rest(material, np.array([self.H]))[0])
        weight = material.rho0 * self.g * self.H
        return (
            Held("height", height, "relative", "integral of the stretch", 1e-3, rests=True, unit="m"),
            Held("base_stretch", base, "relative", "stretch under the whole weight", 1e-2, rests=True),
            Held("base_force", 1.0, "absolute", "weight over the area", 1e-8, "each", rests=True),
            Held("cell_stress", 1e-8 * weight, "at_most", "balance of each cell", of="each", rests=True, unit="Pa"),
        )

    def answers(self, run: Run, X: Floats) -> dict[str, Floats]:
        """Height at rest and vertical stress of particles."""
        material = create(MATERIALS, run.material)
        return {"y": self.rest(material, X[:, 1]), "syy": self.stress(material, X[:, 1])}

    def rest(self, material: Any, Y: Floats) -> Floats:
        """Heights at rest (n,) of particles at Y (n,) at reference, by Gauss's rule."""
        points, weights = np.polynomial.legendre.leggauss(24)
        where = 0.5 * Y[:, None] * (points + 1)
        along = stretches(material, self.stress(material, where.ravel())).reshape(where.shape)
        found: Floats = 0.5 * Y * (along @ weights)
        return found


class AtRest(Watch):
    """Watch that ends the run when no node is accelerated any more, and measures it."""

    def __init__(self, problem: SelfWeight, ramp: float, side: int, floor: Reaction) -> None:
        self.problem, self.ramp, self.side, self.floor, self.unbalanced = problem, ramp, side, floor, 0.0

    def after_motion(self, model: Model) -> None:
        """Look at the largest force of a node that is free."""
        if model.time > self.ramp:
            grid = model.grid
            weight = float(model.particles.m.sum()) * self.problem.g
            self.unbalanced = float(np.abs(grid.mass * grid.acceleration[:, 1]).max()) / weight
            self.done = self.unbalanced < REST

    def found(self, model: Model) -> Measured:
        """Errors of position and stress, numbers of the whole, and two figures."""
        problem, p, material, model.smoothing = self.problem, model.particles, model.material, None
        particles_to_grid(model)  # which may sort them
        exact = problem.stress(material, p.X[:, 1])
        rows, where = np.unique(p.X[:, 1], return_inverse=True)
        u = p.x[:, 1] - problem.rest(material, rows)[where]
        own = p.sigma[:, 1] - exact
        heights, cells = cell_stress(model, own)
        if model.basis.reference:  # cells are those of the reference configuration
            heights = problem.rest(material, heights)
        F = np.array([p.F[where == row, 1, 1].mean() for row in range(len(rows))])
        low, next_ = (F[k * self.side : (k + 1) * self.side].mean() for k in range(2))  # of two layers, a cell high
        weight = material.rho0 * problem.g * problem.H
        values = {
            "height": float(p.x[where == len(rows) - 1, 1].mean() + F[-1] * (problem.H - rows[-1])),
            "base_stretch": float(1.5 * low - 0.5 * next_),
            "base_force": float(self.floor.force[1]) / (weight * model.grid.dx),
            "cell_stress": float(np.abs(cells).max()),
            "unbalanced": self.unbalanced,
            AT_REST: float(self.done),
        }
        fine = np.linspace(0.0, problem.H, 101)
        curves = {
            ("stress", "run"): np.stack([p.sigma[:, 1] / 1e3, p.x[:, 1]]),
            ("stress", "exact"): np.stack([problem.stress(material, fine) / 1e3, problem.rest(material, fine)]),
            ("cells", "particles"): np.stack([p.x[:, 1], own]),
            ("cells", "cells"): np.stack([heights, cells]),
        }
        errors = {"u": {"rms": rms(u)}, "sigma": {"cells": rms(cells), "particles": rms(own)}}
        return Measured(errors, values, curves, {"u": problem.H, "sigma": weight}, {"u": 1e-13 * problem.H})
