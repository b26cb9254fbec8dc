"""Wall that is pushed into soil and pulled back: the earth pressures of Rankine, passive and active.

A layer of height H and as long, under its own weight and a surcharge q, stands on a smooth floor between two smooth
walls. One of them is pushed in until the soil fails all along its height, and pulled back until it fails the other way.
The strain along x is uniform, and with sigma_v the vertical stress the horizontal one is, compression positive,

    passive: sigma_h = K_p sigma_v + 2 c sqrt(K_p), K_p = (1 + sin phi)/(1 - sin phi) = 3 at phi = 30 degrees
    active: sigma_h = K_a sigma_v - 2 c sqrt(K_a), K_a = 1/K_p = 1/3

so that the force on the wall is K (q H + rho0 g H^2 / 2), and 2 c sqrt(K) H of the cohesion. It is the reaction of the
nodes of the wall, and K what is left of it without the cohesion's part. It does not depend on the cells: weight and
stress of each are in equilibrium to round-off, and so is a uniform layer under a surcharge. Nor on elasticity: the soil
is so stiff that strains stay below 1e-5. What is left is inertia, which falls with the square of the time: 0.1 % at
most of each coefficient from 20 to 45 degrees. Of steeper soils, and shorter times, it is more, and drucker_prager does
not come to its limit on this travel, 3.2 % short of K_p: their coefficients are shown, and not judged.
"""

from dataclasses import dataclass, fields, replace
from math import ceil, radians, sin, sqrt
from typing import Any, ClassVar

import numpy as np

from mpm_verify.cases.benchmark.pressed import STIFF, Pressed, Smooth, balance, slow, thinned
from mpm_verify.cases.benchmark.problem import Drawn, Held, Measured, Problem, Setup
from mpm_verify.cases.benchmark.run import Run
from mpm_verify.cases.harness.checks import Unjudged
from mpm_verify.solver.boundary import box
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.layout import Layout, rectangle
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, create, optional, split
from mpm_verify.solver.pushed import pushed
from mpm_verify.solver.state import Floats, Grid
from mpm_verify.solver.step import Model, Scheme
from mpm_verify.solver.surface import Given, Surface, faces

BEYOND = 1.5  # travel of the wall over what takes the base elastically from one failure to the other
LAST = 0.2  # fraction of the steps of each way whose mean is the force
STEEPEST, SHORTEST = 45.0, 400.0  # degrees and transits up to which, and from which on, the bands were measured
WRONG = 1.0  # degrees that the angle of friction of the failing control is too large by
RANKINE = "Rankine 1857, doi:10.1098/rstl.1857.0003"
BELL = "Bell 1915, Min. Proc. Inst. Civ. Eng. 199, 233-272"


@dataclass(frozen=True)
class Rankine(Problem):
    """Layer of height H in m under gravity g in m/s2 and a surcharge q in Pa; phi and c are its material's.

    `transits` is the time of each way, in transits of a wave over H.

    References
    ----------
    Rankine 1857, doi:10.1098/rstl.1857.0003; Bell 1915 for the cohesion.
    """

    source: ClassVar[str] = f"{RANKINE}; {BELL} for the cohesion"
    material: ClassVar[str] = "mohr_coulomb:phi=30,psi=0"
    cells: ClassVar[tuple[int, ...]] = (4, 8)
    quick: ClassVar[tuple[int, ...]] = (4,)
    figures: ClassVar[dict[str, Drawn]] = {
        "wall": Drawn(
            "travel of the wall / H [1e-6]", "force / (q H + \N{GREEK SMALL LETTER RHO} g H\N{SUPERSCRIPT TWO} / 2)",
            "force on the wall, pushed in and pulled back", True,
        ),
    }  # fmt: skip
    tied: ClassVar[bool] = True

    E: float = 1e11
    nu: float = 0.3
    rho0: float = 2000.0
    H: float = 5.0
    g: float = 10.0
    q: float = 0.0
    transits: float = 400.0
    damping: float = 0.1

    def check(self, run: Run) -> None:
        """Raise ValueError for what has no earth pressure of Rankine."""
        soil: Any = create(MATERIALS, run.material)
        if not soil.fails_as_mohr_coulomb or not soil.friction_angle or "phi" not in {one.name for one in fields(soil)}:
            raise ValueError(f"rankine: {run.material} does not fail by friction; take mohr_coulomb:phi=30,psi=0")
        if not min(self.H, self.transits) > 0 or min(self.g, self.q) < 0 or not 0 <= self.damping < 1:
            raise ValueError(
                "rankine: H and transits must be above zero, g and q zero or more, and damping from 0 to below 1"
            )
        if not self.load(soil) > 0:
            raise ValueError("rankine: nothing loads the soil; take g=10 or q=1e5")
        if not self.pressure(soil, -1, self.q) >= 0:
            raise ValueError(
                f"rankine: c = {soil.cohesion:g} leaves the soil a crack; take q above {self.least(soil):g}"
            )
        if not self.E >= STIFF * self.pressure(soil, 1, self.base(soil)):
            raise ValueError(f"rankine: E must be {STIFF * self.pressure(soil, 1, self.base(soil)):g} or more")

    def base(self, soil: Any) -> float:
        """Vertical stress at the base, compression positive."""
        return float(self.q + soil.rho0 * self.g * self.H)

    def load(self, soil: Any) -> float:
        """Vertical stress over the height: what K is multiplied by."""
        return float(self.q * self.H + 0.5 * soil.rho0 * self.g * self.H**2)

    def least(self, soil: Any) -> float:
        """Surcharge from which the active pressure is positive everywhere."""
        return float(2 * soil.cohesion / sqrt(coefficient(soil, -1)))

    def pressure(self, soil: Any, side: int, vertical: float) -> float:
        """Horizontal stress at failure, compression positive; side 1 is passive, -1 active."""
        K = coefficient(soil, side)
        return float(K * vertical + side * 2 * soil.cohesion * sqrt(K))

    def setup(self, run: Run) -> Setup:
        """Layer in equilibrium with the elastic pressure at rest; the control's soil has a degree too much."""
        known: Any = create(MATERIALS, run.material)
        soil: Any = replace(known, phi=known.phi + WRONG) if run.control else known
        basis, dx = create(METHODS, run.method), self.H / run.cells
        upper = np.full(2, self.H)
        grid, layout = Grid(dx, np.zeros(2), upper), rectangle(np.zeros(2), upper, dx, run.ppc, run.offset)
        particles = basis.populate(layout, soil.rho0)
        vertical = -self.q - soil.rho0 * self.g * (self.H - particles.X[:, 1:])
        rest = soil.nu / (1 - soil.nu)
        particles.sigma[:, :3] = vertical * [rest, 1.0, rest]
        particles.b[:] = [0.0, -self.g]
        steps = ceil(self.transits * self.H / (run.courant * dx))
        duration = self.transits * self.H / soil.wave_speed()
        walls = box(grid, ("roller", "roller", "roller", "free"))
        model = Model(
            grid, particles, basis, soil, walls, duration / steps, Scheme(create(TRANSFERS, run.transfer)),
            Damping(self.damping) if self.damping else None,
            optional(SMOOTHINGS, run.smoothing),
            surcharge(layout, upper, self.q) if self.q else None,
        )  # fmt: skip
        at = self.base(known)
        strain = (self.pressure(known, 1, at) - self.pressure(known, -1, at)) * (1 - soil.nu**2) / self.E
        far = grid.nodes[:, 0] > self.H - 0.5 * dx
        push = pushed(walls, far, 0, Smooth(-BEYOND * strain * self.H, duration))
        outer = np.array([0.0, -(self.q + soil.rho0 * self.g * self.H) * self.H])
        reaction, whole = slow(model, push, outer)

        def measure(travel: Floats, force: Floats, momentum: Floats) -> Measured:
            found, speed = self.measured(known, -travel, -force), np.diff(travel, prepend=0.0) / model.dt
            found.values["mean_velocity"] = float((momentum * speed).sum() / (speed**2).sum() / particles.m.sum())
            return found

        return Setup(model, 2 * steps, Pressed(push, reaction, whole, measure))

    def measured(self, soil: Any, travel: Floats, force: Floats) -> Measured:
        """Coefficients at the end of each way, and the loop of the force."""
        values, load, curves = {}, self.load(soil), {}
        for name, side, way in zip(("Kp", "Ka"), (1, -1), np.array_split(force, 2), strict=True):
            end, K = way[-ceil(LAST * len(way)) :].mean(), coefficient(soil, side)
            values[name] = float(end - side * 2 * soil.cohesion * sqrt(K) * self.H) / load
        known = [
            (K * load + side * 2 * soil.cohesion * sqrt(K) * self.H) / load
            for side in (1, -1)
            for K in (coefficient(soil, side),)
        ]
        reach = 1e6 * travel.max() / self.H
        curves["wall", "run"] = thinned(1e6 * travel / self.H, force / load)
        curves["wall", "exact"] = np.array(
            [[0.0, reach, np.nan, 0.0, reach], [known[0]] * 2 + [np.nan] + [known[1]] * 2]
        )
        return Measured(values=values, curves=curves)

    def held(self, run: Run) -> tuple[Held, ...]:
        """Both coefficients on any grid, the momentum of the soil, and its balance."""
        soil = create(MATERIALS, run.material)
        known = split(run.material)[0] == "mohr_coulomb" and soil.friction_angle <= STEEPEST
        why: Unjudged = "" if known and self.transits >= SHORTEST else "not_usual"
        return (
            Held("Kp", coefficient(soil, 1), "relative", "(1 + sin phi)/(1 - sin phi)", 5e-3, "each", unjudged=why),
            Held("Ka", coefficient(soil, -1), "relative", "(1 - sin phi)/(1 + sin phi)", 5e-3, "each", unjudged=why),
            Held("mean_velocity", 0.5, "relative", "uniform strain: half of the wall's", 1e-2, "each"),
            *balance(run, traction=self.q > 0),
        )

    def particles(self, run: Run) -> int:
        """Number of particles."""
        return run.cells**2 * run.ppc

    def updates(self, run: Run) -> float:
        """Particle updates."""
        return self.particles(run) * 2 * self.transits * run.cells / run.courant


def coefficient(soil: Any, side: int) -> float:
    """Coefficient of earth pressure: side 1 is passive, -1 active."""
    s = side * sin(radians(soil.friction_angle))
    return float((1 + s) / (1 - s))


def surcharge(layout: Layout, upper: Floats, q: float) -> Surface:
    """Pressure q on the upper edge."""
    P = np.zeros((2, 2))
    P[1, 1] = -q
    given = Given(lambda X, t: np.broadcast_to(P, (len(X), 2, 2)), lambda X, t: X)
    return Surface(faces(layout, np.zeros(2), upper, {"top": "pulled"}), given)
