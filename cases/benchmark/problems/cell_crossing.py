"""Cell crossing: the spurious force inside a uniformly stressed bar that is shifted through the grid.

A bar is stretched along x by 1.1 and has the same stress sigma everywhere, so that the internal force of every node
inside it is zero (paper eq. (1), F = B^T sigma). It is shifted through a cell, and nothing is advanced in time. A row
of particles at a spacing of s cells gives a node the force

    f = -sigma A s sum S'(x_p - x_i),   S' the gradient of the weight in cells, A the area of the bar.

For hats at points S' is +1 in the cell to the left and -1 in the one to the right: f is sigma A s times the difference
of two counts of particles. These are equal where 1/s is a whole number, and otherwise differ by one wherever a particle
has crossed a cell face alone: the force is 0 or s sigma A, 0.55 sigma A with four particles in a cell. Domains of fixed
size leave gaps of the stretch between them, quadratic splines sum a smooth gradient at points: both are spurious, but
smaller. Domains that follow F tile the bar, the sum is an integral, and f is round-off.

The formula, with gradients written down here and not taken from the kernels, is known for each of these methods at each
shift; weights of a total Lagrangian method do not change with the shift.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np

from mpm_verify.cases.benchmark.problem import Drawn, Held, Measured, Problem, Setup, Watch
from mpm_verify.cases.benchmark.run import Run
from mpm_verify.solver.boundary import box
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.plugins import MATERIALS, METHODS, create, split
from mpm_verify.solver.state import Floats, Grid
from mpm_verify.solver.step import Model, particles_to_grid

SHIFTS = 240  # positions in one cell
MARGIN = 4  # cells at both ends of the bar whose nodes are not looked at, and beside it
SPOILT = 1.1  # stress of one particle of the failing control, over that of the others
Gradient = Callable[[Floats, float], Floats]  # of the distance to the node and half the spacing at reference, in cells


def hat(x: Floats) -> Floats:
    """Hat function of a distance in cells."""
    found: Floats = np.maximum(0.0, 1.0 - np.abs(x))
    return found


def of_points(x: Floats, half: float) -> Floats:
    """Gradient of the hat function: the sign is that of the side."""
    found: Floats = -np.sign(x) * (np.abs(x) < 1)
    return found


def of_fixed(x: Floats, half: float) -> Floats:
    """Gradient of the mean of the hat function over a domain of fixed size."""
    found: Floats = (hat(x + half) - hat(x - half)) / (2 * half)
    return found


def of_splines(x: Floats, half: float) -> Floats:
    """Gradient of the quadratic spline."""
    a = np.abs(x)
    found: Floats = np.where(a < 0.5, -2 * x, np.where(a < 1.5, np.sign(x) * (a - 1.5), 0.0))
    return found


GRADIENTS: dict[str, Gradient] = {"mpm": of_points, "gimp": of_fixed, "bspline2": of_splines}
FOLLOW = ("cpdi", "cpdi2", "cpgimp", "tlmpm")


@dataclass(frozen=True)
class CellCrossing(Problem):
    """Bar that is stretched along x and shifted through a cell.

    References
    ----------
    Bardenhagen & Kober 2004, doi:10.3970/cmes.2004.005.477; Steffen, Kirby & Berzins 2008, doi:10.1002/nme.2360.
    """

    source: ClassVar[str] = "Steffen, Kirby & Berzins 2008, doi:10.1002/nme.2360"
    material: ClassVar[str] = "neo_hookean"
    cells: ClassVar[tuple[int, ...]] = (20,)
    quick: ClassVar[tuple[int, ...]] = (20,)
    methods: ClassVar[tuple[str, ...]] = ("mpm", "gimp", "bspline2", "cpdi")
    figures: ClassVar[dict[str, Drawn]] = {
        "force": Drawn(
            "shift of the bar [cells]",
            "force at an inner node / (\N{GREEK SMALL LETTER SIGMA} A)",
            "force at one node inside the bar, which should be zero",
            True,
        ),
    }
    tied: ClassVar[bool] = True

    stretch: float = 1.1

    def check(self, run: Run) -> None:
        """Raise ValueError for a bar that is not stretched so, or has no inner node."""
        if not 1 < self.stretch <= 2:
            raise ValueError(f"cell_crossing: stretch = {self.stretch:g} must be above 1 and at most 2, 1.1 is usual")
        if run.cells < 3 * MARGIN:
            raise ValueError(
                f"cell_crossing: {run.cells} cells have no node far from the ends; take {3 * MARGIN} or more"
            )

    def spacing(self, run: Run) -> float:
        """Distance of particles in cells."""
        return self.stretch / sqrt(run.ppc)

    def setup(self, run: Run) -> Setup:
        """Bar of one cell's height, from which particles are moved by their stretch; nothing is advanced."""
        material, basis = create(MATERIALS, run.material), create(METHODS, run.method)
        dx, beside = 1.0 / run.cells, MARGIN / run.cells
        end = np.ceil(self.stretch * run.cells) * dx
        grid = Grid(dx, np.array([-beside, 0.0]), np.array([end + beside, dx]))
        layout = rectangle(np.zeros(2), np.array([1.0, dx]), dx, run.ppc, run.offset)
        scale = np.array([self.stretch, 1.0])
        particles = basis.populate(layout, material.rho0, lambda X: X * scale)
        particles.x, particles.F[:, 0, 0] = particles.X * scale, self.stretch
        model = Model(grid, particles, basis, material, box(grid, "roller"), run.courant * dx / material.wave_speed())
        return Setup(model, 0, Shifted(self, run))

    def held(self, run: Run) -> tuple[Held, ...]:
        """Largest force, and its distance from the formula at each shift and node."""
        name, s = split(run.method)[0], self.spacing(run)
        if name in FOLLOW:
            return (Held("spurious_force", 1e-13, "at_most", "domains tile the bar", of="each"),)
        if name not in GRADIENTS:
            return ()
        peak = float(np.abs(formula(GRADIENTS[name], s, self.stretch, shifts())).max())
        return (
            Held("spurious_force", peak, "absolute", "sum of gradients over a row of particles", 1e-10, "each"),
            Held("off_formula", 1e-10, "at_most", "sum of gradients over a row of particles", of="each"),
        )

    def particles(self, run: Run) -> int:
        """Number of particles."""
        return run.cells * run.ppc

    def updates(self, run: Run) -> float:
        """Particle updates: one for each shift."""
        return float(SHIFTS * self.particles(run))


def shifts() -> Floats:
    """Shifts in cells; none puts a particle on a face, where the gradient of a hat is on neither side."""
    found: Floats = (np.arange(SHIFTS) + 0.5 + 1e-3) / SHIFTS
    return found


def formula(gradient: Gradient, spacing: float, stretch: float, positions: Floats) -> Floats:
    """Force over sigma A at a node that has a particle at each of the positions (n,), in cells, of endless rows."""
    row = spacing * np.arange(-np.ceil(3 / spacing), np.ceil(3 / spacing) + 1)
    found: Floats = -spacing * gradient(positions[:, None] + row, 0.5 * spacing / stretch).sum(axis=1)
    return found


class Shifted(Watch):
    """Measure of the forces at inner nodes for each shift."""

    def __init__(self, problem: CellCrossing, run: Run) -> None:
        self.problem, self.run, self.method = problem, run, split(run.method)[0]

    def found(self, model: Model) -> Measured:
        """Largest force over all shifts and inner nodes, its distance from the formula, and the curve of one node."""
        p, grid, run = model.particles, model.grid, self.run
        model.material.update(p, model.dt)
        sigma = float(p.sigma[0, 0])
        if run.control:
            p.sigma[np.argsort(p.x[:, 0])[len(p) // 2]] *= SPOILT
        x, origin, s = p.x[:, 0].copy(), grid.origin.copy(), self.problem.spacing(run)
        at = origin[0] + grid.dx * np.arange(grid.nx)
        inner = (at > x.min() + MARGIN * grid.dx) & (at < x.max() - MARGIN * grid.dx)
        forces = []
        for shift in shifts():
            grid.origin = origin - shift * np.array([grid.dx, 0.0])  # the same as a bar that is moved
            particles_to_grid(model)
            force = grid.force[:, 0].reshape(grid.nx, grid.ny).sum(axis=1)[inner]
            forces.append(force / (sigma * grid.dx))
        grid.origin, found = origin, np.array(forces)
        values = {"spurious_force": float(np.abs(found).max())}
        curves = {("force", "run"): np.stack([shifts(), found[:, found.shape[1] // 2]])}
        if gradient := GRADIENTS.get(self.method):
            first = ((x.min() - at[inner]) / grid.dx)[:, None] + shifts()
            known = np.array([formula(gradient, s, self.problem.stretch, one % s) for one in first]).T
            values["off_formula"] = float(np.abs(found - known).max())
        return Measured({}, values, curves)
