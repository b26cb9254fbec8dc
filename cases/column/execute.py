"""Collapse of a granular column down a channel (the paper's section 3, after Lube et al. 2007), in plane strain.

A column 90.5 mm wide and 633.5 mm high stands on a floor that nothing slips on, at a wall; at t = 0 the gate at its
other side is gone, or is lifted. Table 1: E = 840 kPa, nu = 0.3, phi = 31 deg, psi = 1 deg, 2650 kg/m^3, g = 10 m/s^2.
The paper leaves open, and this is our choice, each a parameter of ColumnRun:
    mesh     a whole number of cells of the width; its 0.67 mm are half a grain, and 135 cells of the width
    floor    nothing slips on it, or it has friction; then grains that leave it are not held
    wall     a roller at x = 0; floor and walls hand their reaction on to the particles (Walls.stops)
    stress   none at first, so that the column first sags; or at rest, or by the material's oedometric loading
    start    the gate is gone at once
    end      a wall at the end of the channel, 18 widths away, and none above
A cohesionless column of CPDI particles does not survive the plain scheme. What keeps it alive: the exponential update
of F (Scheme.deformation), domains of limited length (solver/basis/cpdi.py) and void-strain memory of the material
(solver/voids.py).
"""

from collections.abc import Callable
from dataclasses import asdict, replace
from math import ceil, inf, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.column.measure import Measure, due, final
from mpm_verify.cases.column.run import ColumnResult, ColumnRun
from mpm_verify.cases.column.start import stress
from mpm_verify.cases.harness.checkpoint import Checkpoint
from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.harness.memory import forget_peak
from mpm_verify.cases.harness.progress import Progress
from mpm_verify.solver.boundary import Walls, moving
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.failure import RunFailed
from mpm_verify.solver.friction import FrictionalWalls, frictional
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, create, optional
from mpm_verify.solver.pooling import Pooling
from mpm_verify.solver.state import Floats, Grid, Particles
from mpm_verify.solver.step import Material, Model, Observer, Scheme, advance, check_time_step
from mpm_verify.solver.voids import remembering
from mpm_verify.solver.weights import Basis

FRAMES, SNAPSHOTS = 57, 8  # of a run: positions of particles, all fields
DRAWN = 20_000  # particles of a frame
MOST = 1e8  # steps


def setup(run: ColumnRun) -> tuple[Model, int]:
    """Column before it moves, and the number of steps. Raises ValueError for what does not fit together."""
    material, basis = material_of(run), basis_of(run)
    dx = run.width / run.cells
    columns, rows = round(run.channel * run.cells), ceil((run.aspect + 1) * run.cells)
    grid = Grid(dx, np.zeros(2), dx * np.array([columns, rows]))
    low = np.array([grid.upper[0] - run.width if run.mirror else 0.0, 0.0])
    layout = rectangle(low, low + np.array([run.width, run.height]), dx, run.ppc, run.offset)
    particles = basis.populate(layout, material.rho0)
    gravity = np.array([0.0, -run.g])
    particles.b[:] = gravity
    stress(particles, material, run.start, run.height, run.g)
    steps = steps_of(run, material)
    dt = run.duration / steps
    if run.start == "none":
        particles.v[:] = -0.5 * dt * gravity  # that of t = -dt/2, as nothing but gravity acts at t = 0
    model = Model(
        grid, particles, basis, material, walls(run, grid), dt,
        Scheme(create(TRANSFERS, run.transfer), deformation=run.deformation),  # type: ignore[arg-type]
        Damping(run.damping, run.damping_kind) if run.damping else None,  # type: ignore[arg-type]
        optional(SMOOTHINGS, run.smoothing),
        pooling=Pooling() if run.pooling else None,
    )  # fmt: skip
    return model, steps


def steps_of(run: ColumnRun, material: Material) -> int:
    """Number of steps. Raises ValueError for more than can be done.

    A material that stiffens with s is taken at three times the weight of the column, or at its own bound if that is
    more: where sand strikes the floor s is some nine times the weight for moments, and the Courant number then 1.5
    times what was asked for.
    """
    c = max(material.wave_speed(), material.wave_speed(3 * material.rho0 * run.g * run.height))
    count = run.duration / (run.courant * run.width / run.cells / c) * (1 - 1e-12)
    if not count < MOST:
        raise ValueError(
            f"{count:.3g} steps would be needed, and {MOST:.0e} is the most; choose a larger courant or fewer cells"
        )
    whole: int = ceil(count)
    return max(1, whole)


def material_of(run: ColumnRun) -> Material:
    """Material, with void-strain memory where it has one. Raises ValueError for one that no column can have."""
    material: Any = create(MATERIALS, run.material)
    if material.respond is None:
        raise ValueError(f"the column must have a material in rate form, not {run.material}; choose mohr_coulomb")
    made: Material = remembering(material) if run.void else material
    return made


def basis_of(run: ColumnRun) -> Basis:
    """Basis, with the limit of the run unless it has its own; no domain is cut before it is stretched."""
    basis: Basis = create(METHODS, run.method)
    return basis.limited(max(run.limit, sqrt(0.5 / run.ppc) * (1 + 1e-9)))


def walls(run: ColumnRun, grid: Grid) -> Walls:
    """Floor, wall, end of the channel, and the gate while it is there."""
    floor, wall = (run.mu if kind == "frictional" else kind for kind in (run.floor, run.left))
    left, right = ("roller", wall) if run.mirror else (wall, "roller")
    made = frictional(grid, (left, right, floor, "free"))  # type: ignore[arg-type]
    if run.gate < inf:
        still = made.still if isinstance(made, FrictionalWalls) else made
        gated = moving(grid, Gate(run, grid, still))
        made = replace(made, still=gated) if isinstance(made, FrictionalWalls) else gated
    made.stops = run.stops
    return made


class Gate:
    """Gate that is lifted at a constant speed: above its edge two columns of nodes beside the column are a roller."""

    def __init__(self, run: ColumnRun, grid: Grid, still: Walls) -> None:
        self.speed, self.still = run.gate, still
        away = grid.upper[0] - grid.nodes[:, 0] if run.mirror else grid.nodes[:, 0]
        self.near = np.abs(away - run.width - 0.5 * grid.dx) < 0.6 * grid.dx
        self.y = grid.nodes[:, 1]

    def __call__(self, nodes: Floats, t: float, dt: float) -> tuple[NDArray[np.bool_], Floats, Floats]:
        """Held components, values and rates (n,2) for the step from t on."""
        held = self.still.held.copy()
        held[:, 0] |= self.near & (self.y > self.speed * t)
        return held, self.still.value, self.still.rate


def gravity(particles: Particles, t: float) -> None:
    """Leave the body force as it is: gravity is constant, written once, and travels with the particles."""


def execute(
    run: ColumnRun, tick: Callable[[float], None] = lambda fraction: None, checkpoint: Checkpoint | None = None
) -> tuple[ColumnResult, dict[str, Any]]:
    """Run to the end, or to where it cannot go on: a failed run is a Result. `tick` hears the fraction that is done."""
    checkpoint = checkpoint or Checkpoint()
    forget_peak()
    model, steps = setup(run)
    measure, failure = Measure(run, model), None
    kept = Kept(model, steps)
    model.watch(measure, kept, Progress(tick, steps))
    try:
        if not checkpoint.resume(model):
            measure.look(model)
            check_time_step(model)
        while model.steps < steps:
            advance(model, gravity)
            checkpoint.keep(model)
    except RunFailed as ended:
        failure = ended.failure
    wall, cpu, peak = checkpoint.spent
    curves = measure.curves()
    arrays = {f"curve_{name}": column.astype(np.float32) for name, column in curves.items()} | kept.arrays()
    result = ColumnResult(
        run=run,
        digest=run.digest,
        status="failed" if failure else "finished",
        values=final(run, curves) if measure.rows else {},
        steps=model.steps,
        particles=len(model.particles),
        dt=model.dt,
        wall_s=wall,
        cpu_s=cpu,
        peak_memory_mb=peak,
        failure=failure,
        environment=environment(),
        parameters=asdict(model.material) | {"domain limit": model.basis.limit},  # type: ignore[call-overload]
    )
    return result, arrays


class Kept(Observer):
    """Positions of particles for an animation, and all their fields at a few times, in the initial order, float32."""

    def __init__(self, model: Model, steps: int) -> None:
        self.steps, self.times = steps, ([], [])  # type: tuple[int, tuple[list[float], list[float]]]
        self.some = slice(None, None, -(-len(model.particles) // DRAWN))
        self.frames: list[Any] = []
        self.fields: dict[str, list[Any]] = {}
        self.after_step(model)

    def after_step(self, model: Model) -> None:
        """Keep what is due."""
        step = model.steps
        if step == 0 or due(step, self.steps, FRAMES - 1):
            self.times[0].append(model.time)
            self.frames.append(model.particles.in_initial_order("x")[self.some].astype(np.float32))
        if step == 0 or due(step, self.steps, SNAPSHOTS - 1):
            self.times[1].append(model.time)
            for name, values in fields(model).items():
                self.fields.setdefault(name, []).append(values)

    def arrays(self) -> dict[str, Any]:
        """Arrays by name: frame_t, frame_x (T,P,2), snapshot_t, and each field as snapshot_NAME (T,P,...)."""
        found = {"frame_t": self.times[0], "frame_x": self.frames, "snapshot_t": self.times[1]}
        found |= {f"snapshot_{name}": values for name, values in self.fields.items()}
        return {name: np.array(values, np.float32) for name, values in found.items()}


def fields(model: Model) -> dict[str, Any]:
    """Fields of the particles in the initial order, float32.

    x, v, F, sigma, m, J, corners, the memory of the material by name, and where smoothing gives the forces another
    stress, that as sigma_smoothed.
    """
    p = model.particles
    found = {"x": p.x, "v": p.v, "F": p.F, "sigma": p.sigma, "m": p.m, "J": p.J}
    if p.sigma_smoothed.size:
        found["sigma_smoothed"] = p.sigma_smoothed
    corners = model.basis.corners(p.x, p.F, p.domain, model.grid.dx)
    if corners is not None:
        found["corners"] = corners
    found |= {name: p.history[:, column] for column, name in enumerate(model.material.memory)}
    row = np.empty(len(p), np.int64)
    row[p.id] = np.arange(len(p))
    return {name: values[row].astype(np.float32) for name, values in found.items()}
