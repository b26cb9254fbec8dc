"""Strip footing on soil of Tresca: the pressure at which it sinks is (2 + pi) times the cohesion.

A rigid strip of width B is pressed slowly into the level surface of a weightless soil with the cohesion c and no
friction. In plane strain the soil flows at the pressure

    q = (2 + pi) c = 5.1416 c

whether the strip is rough or smooth: the slip lines of Prandtl and those of Hill give the same load, and so do the
bounds of limit analysis from both sides. By symmetry half of it is computed, between rollers, on a rough floor; the
slip lines reach 1.5 B from the middle and 0.71 B down, the body 2.5 B and 1.5 B. The soil is so stiff that it fails at
strains of 1e-5, and the geometry does not change. The pressure is the reaction of the nodes under the strip over B/2.

The velocity jumps at the edge of the strip. Between the last node that is held and the first that is free it falls
linearly, and the strip ends in the middle: `cells`, those across the whole width B, is an odd number. With the edge at
the last node of 8 cells the pressure is an eighth too high.

Soil flows at constant volume, and the four particles of a cell leave it few ways to (Nagtegaal, Parks & Rice 1974).
Without smoothing the pressure goes on rising and is 28 % too high with 9 cells, 20 % with 17: it falls with the power
0.6 of the cell, and comes to 0.993 of the exact one by Richardson's extrapolation. A grid has fewer velocities than the
soil, so that each value is above. F-bar or volumetric smoothing relieves it: a plateau, and 1 % or 3 % from the exact
pressure with 9 cells. What reaches further than a hat makes the strip narrower by a part of a cell: with F-bar the
pressure is 2 % too low on 5 cells with gimp and 8 % with bspline2, and comes to the exact one with dx. Of these, as of
smooth strips and of volumetric smoothing, only the limit of 9 cells and more is held. Without smoothing they lock less,
and nothing is held. One particle per cell does not lock, but its hourglass modes ring, and local damping drags what
rings and moves: 1.00 with 13 cells becomes 0.978 in four times the time.
"""

from dataclasses import dataclass
from math import ceil, pi
from typing import Any, ClassVar

import numpy as np

from mpm_verify.cases.benchmark.pressed import STIFF, Pressed, Smooth, balance, slow, thinned
from mpm_verify.cases.benchmark.problem import Drawn, Held, Measured, Problem, Setup
from mpm_verify.cases.benchmark.run import Run
from mpm_verify.solver.boundary import box
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, create, optional, split
from mpm_verify.solver.pushed import pushed
from mpm_verify.solver.state import Floats, Grid
from mpm_verify.solver.step import Model, Scheme

FACTOR = 2 + pi  # of bearing capacity
WIDE, DEEP = 5.0, 3.0  # body in half widths of the strip
LAST = 0.1  # fraction of the steps whose mean is the pressure: the strip is nearly at rest
RELIEF = ("fbar", "volumetric")  # smoothings that relieve locking
PLATEAU, HATS = "fbar", ("mpm", "cpdi", "cpdi2", "tlmpm")  # with these any grid is within 2 %
RESOLVED = 9  # cells from which on the values of all others come to their limit by one order
PRANDTL = "Prandtl 1920, Nachr. Ges. Wiss. Goettingen, 74-85; Hill 1950, The mathematical theory of plasticity"
SOURCE = "(2 + pi) c of the slip lines"
BOUND = "(2 + pi) c: too few velocities are an upper bound"


@dataclass(frozen=True)
class Footing(Problem):
    """Strip footing of width B in m on soil of E in Pa, nu and rho0; the cohesion c is its material's.

    `settlement` is that of the end in units of c B / (2 E), `transits` the time in transits of a wave over B/2.

    References
    ----------
    Prandtl 1920; Hill 1950. Nagtegaal, Parks & Rice 1974, doi:10.1016/0045-7825(74)90032-2, for the locking.
    """

    source: ClassVar[str] = PRANDTL
    material: ClassVar[str] = "mohr_coulomb:phi=0,c=1e4,sigma_t=1e9"
    cells: ClassVar[tuple[int, ...]] = (9, 13, 17)
    quick: ClassVar[tuple[int, ...]] = (5, 7, 9)
    smoothings: ClassVar[tuple[str, ...]] = ("fbar", "none")
    figures: ClassVar[dict[str, Drawn]] = {
        "settlement": Drawn("settlement [c B / (2 E)]", "mean pressure / c", "pressure under the strip", True),
    }
    tied: ClassVar[bool] = True

    E: float = 1e10
    nu: float = 0.45
    rho0: float = 2000.0
    B: float = 2.0
    settlement: float = 30.0
    transits: float = 200.0
    damping: float = 0.7
    rough: float = 1.0

    def check(self, run: Run) -> None:
        """Raise ValueError for what is no strip on a soil without friction."""
        if run.cells % 2 == 0 or run.cells < 3:
            raise ValueError(
                f"footing: {run.cells} cells across the strip must be an odd number, 3 or more, as its edge lies in"
                f" the middle of a cell; take {run.cells + 1}"
            )
        soil: Any = create(MATERIALS, run.material)
        if not soil.fails_as_mohr_coulomb or soil.friction_angle != 0:
            raise ValueError(
                f"footing: {run.material} has no strength of Tresca; take mohr_coulomb:phi=0,c=1e4,sigma_t=1e9"
            )
        if not self.E >= STIFF * soil.cohesion:
            raise ValueError(
                f"footing: E must be {STIFF:g} c = {STIFF * soil.cohesion:g} or more, so that strains are small"
            )
        if not min(self.B, self.settlement, self.transits) > 0 or not 0 <= self.damping < 1 or self.rough not in (0, 1):
            raise ValueError(
                "footing: B, settlement and transits must be above zero, damping from 0 to below 1, and rough 0 or 1"
            )

    def setup(self, run: Run) -> Setup:
        """Half of the strip and of the soil; the failing control counts every other node under the strip."""
        soil, basis = create(MATERIALS, run.material), create(METHODS, run.method)
        dx, half = self.B / run.cells, self.B / 2
        upper = dx * np.array([ceil(WIDE * run.cells / 2), ceil(DEEP * run.cells / 2)])
        grid = Grid(dx, np.zeros(2), upper)
        particles = basis.populate(rectangle(np.zeros(2), upper, dx, run.ppc, run.offset), soil.rho0)
        steps = ceil(self.transits * half / (run.courant * dx))
        dt = self.transits * half / soil.wave_speed() / steps
        walls = box(grid, ("roller", "roller", "fixed", "free"))
        model = Model(
            grid, particles, basis, soil, walls, dt, Scheme(create(TRANSFERS, run.transfer)),
            Damping(self.damping) if self.damping else None,
            optional(SMOOTHINGS, run.smoothing),
        )  # fmt: skip
        under = (grid.nodes[:, 0] < half) & (grid.nodes[:, 1] > upper[1] - 0.5 * dx)
        unit = soil.cohesion * half / self.E
        push = pushed(walls, under, 1, Smooth(-self.settlement * unit, steps * dt), bool(self.rough))
        reaction, whole = slow(model, push, np.zeros(2))
        if run.control:
            reaction.part = under & (np.arange(len(under)) // grid.ny % 2 == 0)

        def measure(travel: Floats, force: Floats, momentum: Floats) -> Measured:
            pressure, settled = -force / (soil.cohesion * half), -travel / unit
            curves = {
                ("settlement", "run"): thinned(settled, pressure),
                ("settlement", "exact"): np.array([[0.0, self.settlement], [FACTOR, FACTOR]]),
            }
            return Measured(values={"bearing": float(pressure[-ceil(LAST * len(pressure)) :].mean())}, curves=curves)

        return Setup(model, steps, Pressed(push, reaction, whole, measure))

    def held(self, run: Run) -> tuple[Held, ...]:
        """Factor of bearing capacity: the limit within 2 %, and a bound of what locks; and the balance of momentum.

        A coarse grid has the exact pressure only where nothing locks and the edge of a rough strip is as wide as a hat.
        Without smoothing nothing is held of single particles and of wider functions: see the statement.
        """
        smoothing = split(run.smoothing)[0]
        hats, relieved = split(run.method)[0] in HATS, smoothing in RELIEF
        plateau = smoothing == PLATEAU and hats and self.rough
        limit = Held("bearing", FACTOR, "relative", SOURCE, 0.02, least=0 if plateau else RESOLVED)
        bound = Held("bearing", FACTOR, "at_least", BOUND, of="each")
        if not relieved:
            return (*((limit, bound) if hats and run.ppc > 1 else ()), *balance(run))
        return (limit, *balance(run))

    def particles(self, run: Run) -> int:
        """Number of particles."""
        return ceil(WIDE * run.cells / 2) * ceil(DEEP * run.cells / 2) * run.ppc

    def updates(self, run: Run) -> float:
        """Particle updates."""
        return self.particles(run) * self.transits * run.cells / (2 * run.courant)
