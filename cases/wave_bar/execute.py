"""One run of the wave bar: set up, struck, and its frequency measured."""

from collections.abc import Callable
from math import ceil, pi
from typing import Any

import numpy as np

from mpm_verify.cases.harness.progress import Progress
from mpm_verify.cases.harness.stopwatch import Stopwatch
from mpm_verify.cases.harness.study import Arrays, parameters
from mpm_verify.cases.wave_bar.run import Result, Run
from mpm_verify.solver.boundary import box
from mpm_verify.solver.failure import Failure, RunFailed
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.model import no_load
from mpm_verify.solver.plugins import MATERIALS, METHODS, TRANSFERS, create
from mpm_verify.solver.state import Floats, Grid
from mpm_verify.solver.step import Model, Observer, Scheme, advance, check_time_step

LENGTH, ROWS = 1.0, 4  # of the bar, and cells of its height


def setup(run: Run) -> tuple[Model, float, int]:
    """Bar at t = 0, its exact frequency (radians a time), and the number of steps."""
    basis: Any = create(METHODS, run.method)
    material: Any = create(MATERIALS, run.material)
    dx, c = LENGTH / run.cells, material.wave_speed()
    upper = np.array([LENGTH, ROWS * dx])
    grid = Grid(dx, np.zeros(2), upper)
    particles = basis.populate(rectangle(np.zeros(2), upper, dx, run.ppc, run.offset), material.rho0)
    omega, dt = pi * c / LENGTH, run.courant * dx / c
    particles.v[:, 0] = run.amplitude * c * np.sin(pi * particles.X[:, 0] / LENGTH) * np.cos(omega * dt / 2)
    model = Model(grid, particles, basis, material, box(grid, "roller"), dt, Scheme(create(TRANSFERS, run.transfer)))
    return model, omega, ceil(2 * pi / omega * run.periods / dt)


class Amplitude(Observer):
    """Amplitude of the mode after each step: mean of u sin(pi X / L), by mass."""

    def __init__(self) -> None:
        self.q = [0.0]

    def after_step(self, model: Model) -> None:
        """Keep the amplitude."""
        p = model.particles
        mode = np.sin(pi * p.X[:, 0] / LENGTH)
        self.q.append(float((p.m * (p.x[:, 0] - p.X[:, 0]) * mode).sum() / p.m.sum()))


def execute(run: Run, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Result, Arrays]:
    """Run to the end, or to where it cannot go on: a failed run is a Result. Arrays: t and the modal amplitude q."""
    stopwatch = Stopwatch()
    model, omega, steps = setup(run)
    mode = Amplitude()
    model.watch(mode, Progress(tick, steps))
    failure: Failure | None = None
    stopwatch.start()
    try:
        check_time_step(model)
        for _ in range(steps):
            advance(model, no_load)
    except RunFailed as ended:
        failure = ended.failure
    t = np.array([model.dt * step for step in range(len(mode.q))])
    q = np.array(mode.q)
    found = frequency(t, q)
    result = Result(
        run=run,
        digest=run.digest,
        status="failed" if failure else "finished",
        errors={} if failure else {"frequency": {"relative": abs(found / omega - 1)}},
        values={"frequency": found, "exact": omega},
        scale={"frequency": 1.0},
        floor={"frequency": float(np.finfo(float).eps * np.sqrt(steps))},
        steps=model.steps,
        particles=len(model.particles),
        dt=model.dt,
        crossings=model.crossings,
        failure=failure,
        parameters=parameters("material", model.material) | parameters("method", model.basis),
        **stopwatch.told(),
    )
    return result, {"t": t, "q": q}


def frequency(t: Floats, q: Floats) -> float:
    """Angular frequency between the first and the last zero of q (N,) at the times t (N,); the start at rest is one.

    Zeros lie on straight lines between two steps: q'' vanishes with q, so this misses by the cube of the step.
    """
    before = np.flatnonzero(q[1:-1] * q[2:] < 0) + 1
    zeros = t[before] - q[before] * (t[before + 1] - t[before]) / (q[before + 1] - q[before])
    return float(pi * len(zeros) / (zeros[-1] - t[0])) if len(zeros) else float("nan")
