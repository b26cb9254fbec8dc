"""Time of a step of one method, over that of another, in alternating turns.

Three bodies of their own particles: of the method on one thread, of the method on several, and of the other method on
one. Each does STEPS steps in its turn, so that a drift of the machine's speed hits all three; a ratio is the median
over the turns of the ratio within one. Values:

    ns                   processor time of a particle update on one thread, median, in nanoseconds
    ratio, low, high     time over that of the other method: median and quartiles of the turns
    parallel             speed of several threads over one, by the clock
    threads              how many they were, no more than the machine has
    differ               numbers of x, v, F and sigma that several threads left other than one, after as many steps
"""

from collections.abc import Callable
from statistics import median, quantiles
from time import perf_counter, process_time
from typing import Any

import numpy as np
from llvmlite.binding import get_host_cpu_name
from numba import get_num_threads

from mpm_verify.cases.bench.run import STEPS, Result, Run
from mpm_verify.cases.harness.stopwatch import Stopwatch
from mpm_verify.cases.harness.study import Arrays, parameters
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.boundary import box
from mpm_verify.solver.failure import Failure, RunFailed
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.model import no_load
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, create, optional
from mpm_verify.solver.state import Grid
from mpm_verify.solver.step import Model, Scheme, advance, check_time_step

COURANT, FAST = 0.2, 1e-3  # of the wave; velocity at first over that of the wave: nothing comes near a limit


def body(run: Run, method: str, smoothing: str = "none") -> Model:
    """Unit square between rollers, turning in itself."""
    basis: Any = create(METHODS, method)
    material: Any = create(MATERIALS, run.material)
    dx, c = 1.0 / run.cells, material.wave_speed()
    grid = Grid(dx, np.zeros(2), np.ones(2))
    particles = basis.populate(rectangle(np.zeros(2), np.ones(2), dx, run.ppc), material.rho0)
    x, y = np.pi * particles.X.T
    particles.v[:] = FAST * c * np.column_stack([np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y)])
    return Model(
        grid, particles, basis, material, box(grid, "roller"), COURANT * dx / c,
        Scheme(create(TRANSFERS, run.transfer)), smoothing=optional(SMOOTHINGS, smoothing),
    )  # fmt: skip


def turn(model: Model, threads: int) -> tuple[float, float]:
    """Processor and wall time of STEPS steps, in s."""
    use_threads(threads)
    used, begun = process_time(), perf_counter()
    for _ in range(STEPS):
        advance(model, no_load)
    return process_time() - used, perf_counter() - begun


def execute(run: Run, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Result, Arrays]:
    """Time all turns: a body that cannot go on is a failed Result. Array: times (pairs,3,2) of the turns."""
    stopwatch = Stopwatch()
    one, several = (body(run, run.method, run.smoothing) for _ in range(2))
    other = body(run, run.over)
    turns = ((one, 1), (several, run.parallel), (other, 1))
    times: list[list[tuple[float, float]]] = []
    failure: Failure | None = None
    use_threads(run.parallel)
    threads = get_num_threads()
    stopwatch.start()
    try:
        check_time_step(one)
        for pair in range(run.pairs + 1):
            times.append([turn(*item) for item in turns])
            tick(pair / run.pairs)
    except RunFailed as ended:
        failure = ended.failure
    spent = np.array(times[1:]).reshape(-1, 3, 2)  # the first one warms up
    told = stopwatch.told()
    told["environment"] = told["environment"] | {"architecture": get_host_cpu_name()}  # a processor's name may say less
    result = Result(
        run=run,
        digest=run.digest,
        status="failed" if failure else "finished",
        values={} if failure else values(spent, one, several) | {"threads": float(threads)},
        steps=one.steps,
        particles=len(one.particles),
        dt=one.dt,
        failure=failure,
        parameters=parameters("material", one.material) | parameters("method", one.basis),
        **told,
    )
    return result, {"times": spent}


def values(spent: Any, one: Model, several: Model) -> dict[str, float]:
    """Numbers of a run from times (pairs,3,2), see above."""
    cpu, wall = spent[:, :, 0], spent[:, :, 1]
    ratios = (cpu[:, 0] / cpu[:, 2]).tolist()
    low, _, high = quantiles(ratios, n=4)
    return {
        "ns": 1e9 * median(cpu[:, 0].tolist()) / STEPS / len(one.particles),
        "ratio": median(ratios),
        "low": low,
        "high": high,
        "parallel": median((wall[:, 0] / wall[:, 1]).tolist()),
        "differ": float(differ(one, several)),
    }


def differ(one: Model, other: Model) -> int:
    """Count of the numbers of the particles that are not the same to the bit."""
    names = ("x", "v", "F", "sigma")
    pairs = ((one.particles.in_initial_order(name), other.particles.in_initial_order(name)) for name in names)
    return sum(int((a.view(np.int64) != b.view(np.int64)).sum()) for a, b in pairs)
