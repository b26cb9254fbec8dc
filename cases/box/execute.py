"""One run of the box: the column dropped, and measured until it rests."""

from collections.abc import Callable
from dataclasses import asdict
from math import ceil, sqrt
from typing import Any

import numpy as np

from mpm_verify.cases.box.measure import Measure, settled
from mpm_verify.cases.box.run import Result, Run
from mpm_verify.cases.harness.progress import Progress
from mpm_verify.cases.harness.stopwatch import Stopwatch
from mpm_verify.cases.harness.study import Arrays
from mpm_verify.solver.boundary import Kind, box
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.failure import RunFailed
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.model import no_load
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, create, optional
from mpm_verify.solver.pooling import Pooling
from mpm_verify.solver.state import Grid
from mpm_verify.solver.step import Model, Scheme, advance, check_time_step
from mpm_verify.solver.voids import remembering


def setup(run: Run) -> tuple[Model, int]:
    """Column before it falls, and the number of steps. Raises ValueError for what does not fit together."""
    material: Any = create(MATERIALS, run.material)
    if material.respond is None:
        raise ValueError(f"the sand must have a material in rate form, not {run.material}; choose mohr_coulomb")
    material = remembering(material)
    basis = create(METHODS, run.method).limited(max(run.limit, sqrt(0.5 / run.ppc) * (1 + 1e-9)))
    grid = Grid(run.dx, np.zeros(2), run.dx * np.array([run.cells, run.cells_above]))
    low = np.array([0.0, run.drop])
    particles = basis.populate(rectangle(low, low + np.array([run.width, run.height]), run.dx, run.ppc), material.rho0)
    shift = np.random.default_rng(run.seed).uniform(-run.jitter, run.jitter, particles.x.shape)
    particles.x += shift * run.dx / sqrt(run.ppc)
    particles.b[:] = [0.0, -run.g]
    fast = max(material.wave_speed(), material.wave_speed(3 * material.rho0 * run.g * run.height))
    steps = ceil(run.duration * fast / (run.courant * run.dx) * (1 - 1e-12))
    dt = run.duration / steps
    particles.v[:] = -0.5 * dt * particles.b  # that of t = -dt/2
    side: Kind = "fixed" if run.control else "roller"
    walls = box(grid, (side, side, "roller", "free"))
    walls.stops = True
    model = Model(
        grid, particles, basis, material, walls, dt, Scheme(create(TRANSFERS, run.transfer), deformation="exponential"),
        Damping(run.damping) if run.damping else None, optional(SMOOTHINGS, run.smoothing),
        pooling=Pooling() if run.pooling else None,
    )  # fmt: skip
    return model, steps


def execute(run: Run, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Result, Arrays]:
    """Run to the end, or to where it cannot go on: a failed run is a Result. Arrays: curves, the sand at the end."""
    stopwatch = Stopwatch()
    model, steps = setup(run)
    measure, failure = Measure(run, steps), None
    model.watch(measure, Progress(tick, steps))
    stopwatch.start()
    try:
        check_time_step(model)
        for _ in range(steps):
            advance(model, no_load)
    except RunFailed as ended:
        failure = ended.failure
    curves = measure.curves()
    result = Result(
        run=run,
        digest=run.digest,
        status="failed" if failure else "finished",
        values={} if failure else settled(run, curves),
        steps=model.steps,
        particles=len(model.particles),
        dt=model.dt,
        crossings=model.crossings,
        failure=failure,
        parameters=asdict(model.material) | {"domain limit": model.basis.limit},  # type: ignore[call-overload]
        **stopwatch.told(),
    )
    return result, {f"curve_{name}": column for name, column in curves.items()} | ending(model)


def ending(model: Model) -> Arrays:
    """The sand at the end: x (P,2), sigma (P,4), and the corners of domains (P,4,2) where there are some."""
    p = model.particles
    corners = model.basis.corners(p.x, p.F, p.domain, model.grid.dx)
    found = {"end_x": p.x, "end_sigma": p.sigma} | ({} if corners is None else {"end_corners": corners})
    return {name: values.astype(np.float32) for name, values in found.items()}
