"""Rotated block of the paper (section 2.2, Figure 2) as a run: gravity ramped over a second, then a quarter turn.

A block of side L lies in an open box on a grid that does not turn. In the first second gravity grows to g: rollers on
the left, right and bottom confine the block. In the next second box, block and gravity turn by 90 degrees about the
middle of the block. Gravity turns too, as in the paper: with a fixed one the stress could not follow the block.

The walls of the turning box are nodes with the box's rigid velocity. A node belongs to a wall when its hat function
reaches beyond it: before the turn these are the nodes on and behind the wall, and during it none is left free
beside cells that are partly empty, which no traction would balance. The velocity of a step is the chord of the
rotation, (R(w dt) - I)(x - c)/dt, which hats hold exactly; so the box turns by exactly w dt a step.

With `frame` nothing turns: the same box at rest feels the inertial forces of the turning one (centrifugal, Coriolis).
That run shows the inertial fraction alone, without any rotation of stress.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import ceil

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.harness.checks import Curves
from mpm_verify.cases.objectivity.axes import OMEGA, Block
from mpm_verify.cases.objectivity.exact import turn
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.basis.cpdi import Cpdi
from mpm_verify.solver.boundary import moving
from mpm_verify.solver.failure import Failure, RunFailed
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.state import Floats, Grid, Particles
from mpm_verify.solver.step import Model, advance

SAMPLES = 200  # of each stage, at most
RAMP = 1.0


def angle_at(t: float) -> float:
    """Angle of the box at a time."""
    return OMEGA * max(0.0, t - RAMP)


@dataclass
class Box:
    """Walls of the box: `rule` of solver.boundary.MovingWalls. `turns` is false for the box at rest."""

    L: float
    dx: float
    turns: bool
    centre: Floats = field(init=False)

    def __post_init__(self) -> None:
        self.centre = np.full(2, self.L / 2)

    def __call__(self, nodes: Floats, t: float, dt: float) -> tuple[NDArray[np.bool_], Floats, Floats]:
        """Held components, values, rates (n,2) for the step from t to t + dt: rollers, then the rigid motion."""
        if t < RAMP - dt / 2:
            near = self.reaches(nodes, 0.0)
            held = np.stack([near[:, :2].any(axis=1), near[:, 2]], axis=1)
            return held, np.zeros(nodes.shape), np.zeros(nodes.shape)
        angle, step = (angle_at(t), OMEGA * dt) if self.turns else (0.0, 0.0)
        held = np.repeat(self.reaches(nodes, angle).any(axis=1, keepdims=True), 2, axis=1)
        out = nodes - self.centre
        return held, out @ (turn(step) - np.eye(2)).T / dt, -2 * (1 - np.cos(step)) / dt**2 * out

    def reaches(self, nodes: Floats, angle: float) -> NDArray[np.bool_]:
        """Whether a node's hat reaches beyond the wall on the left, right, bottom (n,3) of the box at that angle."""
        own = (nodes - self.centre) @ turn(angle)
        wide = self.dx * np.abs(turn(angle)).sum(axis=0)  # half width of the hat's square along the axes of the box
        depth = self.L / 2 - np.stack([-own[:, 0], own[:, 0], -own[:, 1]], axis=1)
        near: NDArray[np.bool_] = np.less(depth, wide[[0, 0, 1]] * (1 - 1e-9))
        return near


@dataclass
class Gravity:
    """Body force (P,2) of the particles; in the box at rest, with the inertial forces of the turning box."""

    block: Block
    centre: Floats = field(init=False)

    def __post_init__(self) -> None:
        self.centre = np.full(2, self.block.L / 2)

    def __call__(self, particles: Particles, t: float) -> None:
        """Write particles.b."""
        down = np.array([0.0, -self.block.g * min(t / RAMP, 1.0)])
        if not self.block.frame:
            particles.b[:] = turn(angle_at(t)) @ down
            return
        particles.b[:] = down
        if t > RAMP - 1e-9:
            x, v = particles.x - self.centre, particles.v
            particles.b += OMEGA**2 * x + 2 * OMEGA * np.stack([v[:, 1], -v[:, 0]], axis=1)


def setup(block: Block) -> Model:
    """Block at rest, free of stress, in a grid that holds it at every angle."""
    dx, dt = block.L / block.cells, 1.0 / block.steps
    margin = ceil(0.25 * block.cells) * dx
    grid = Grid(dx, np.full(2, -margin), np.full(2, block.L + margin))
    particles = Cpdi().populate(rectangle(np.zeros(2), np.full(2, block.L), dx, block.ppc), block.rho0)
    walls = moving(grid, Box(block.L, dx, not block.frame))
    return Model(grid, particles, Cpdi(), block.material, walls, dt)


def spin(model: Model, block: Block) -> None:
    """Add the rigid velocity of the box to that of the particles, at the time level of v: half a step before x."""
    back = np.eye(2) - turn(-OMEGA * model.dt)
    model.particles.v += (model.particles.x - block.L / 2) @ back.T / model.dt


def execute(block: Block, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Curves, Failure | None]:
    """Curves of a run, and why it ended early if it did; stresses in units of |sigma_v|.

    `mean`: t, angle, means over the particles xx, yy, zz, xy, in the frame of the box own_xx, own_yy, own_xy, and
    `shear`, the largest |own_xy| of a particle. `field`: X, Y of the particles, and their own_xx, own_yy, own_xy,
    averaged over the turn.
    """
    use_threads(1)
    model, load, rows = setup(block), Gravity(block), []
    failure = None
    every, total, looks = max(1, block.steps // SAMPLES), np.zeros((len(model.particles), 3)), 0
    try:
        for step in range(1, 2 * block.steps + 1):
            if step == block.steps + 1 and not block.frame:
                spin(model, block)
            advance(model, load)
            tick(step / (2 * block.steps))
            if step % every == 0 or step % block.steps == 0:
                own = in_box(model, block)
                rows.append(row(model, block, own))
                if step > block.steps:
                    total[model.particles.id] += own  # rows move when particles cross cells
                    looks += 1
    except RunFailed as ended:
        failure = ended.failure
    scale = np.array([1.0, 1.0] + 8 * [abs(block.sigma_v)])
    names = ("t", "angle", "xx", "yy", "zz", "xy", "own_xx", "own_yy", "own_xy", "shear")
    mean = dict(zip(names, (np.array(rows).reshape(-1, len(names)) / scale).T, strict=True))
    own = total / max(1, looks) / abs(block.sigma_v)
    X = model.particles.in_initial_order("X")
    field = {"X": X[:, 0], "Y": X[:, 1], "own_xx": own[:, 0], "own_yy": own[:, 1], "own_xy": own[:, 2]}
    return {"mean": mean, "field": field}, failure


def in_box(model: Model, block: Block) -> Floats:
    """Stress of the particles as the box sees it, xx, yy, xy (P,3)."""
    Q = turn(0.0 if block.frame else angle_at(model.time))
    own = np.einsum("ai,pab,bj->pij", Q, model.particles.sigma[:, [0, 3, 3, 1]].reshape(-1, 2, 2), Q)
    return np.stack([own[:, 0, 0], own[:, 1, 1], own[:, 0, 1]], axis=1)


def row(model: Model, block: Block, own: Floats) -> tuple[float, ...]:
    """Row of `mean`, in units of stress."""
    angle = 0.0 if block.frame else angle_at(model.time)
    return (model.time, angle, *model.particles.sigma.mean(axis=0), *own.mean(axis=0), float(np.abs(own[:, 2]).max()))
