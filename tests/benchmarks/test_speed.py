"""Speed, as ratios within one run: `make bench`. Nothing here asserts a time; what is asserted is that results agree.

Every comparison alternates its two sides, so that a drift of the machine's speed hits both; the median of the pairs'
ratios is what docs/speed.md quotes. 128 x 128 cells, 4 particles a cell; body force and errors left out but where
named.
"""

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np
import plain
import pytest
import yardstick

from mpm_verify.cases.mms.execute import Comparison, setup
from mpm_verify.cases.mms.run import Run
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.boundary import MASS_CUTOFF
from mpm_verify.solver.plugins import available
from mpm_verify.solver.state import Particles
from mpm_verify.solver.step import Model, advance

CELLS, PPC, PAIRS = 128, 4, 60
STEPS = 10  # of one side before the other's turn, where each has particles of its own: the cache holds one of them
METHODS = available("mpm_verify.solver.basis")


def unloaded(particles: Particles, t: float) -> None:
    """No body force, no errors."""


def start(method: str) -> tuple[Model, Comparison]:
    model, comparison, _ = setup(Run(method, "axis_aligned", "neo_hookean", CELLS, PPC, 0.1))
    comparison(model.particles, 0.0)
    return model, comparison


def fused(model: Model) -> Callable[[], None]:
    """One step of the yardstick on the model's own arrays."""
    p, g, law = model.particles, model.grid, model.material
    held, cutoff = model.walls.held.astype(float), float(MASS_CUTOFF * p.m.max())
    kernel = getattr(yardstick, type(model.basis).__name__.lower())
    return lambda: kernel(
        p.x, p.v, p.F, p.sigma, p.m, p.V0, p.b, p.domain, g.origin, 1.0 / g.dx, g.ny, g.mass, g.momentum_force,
        g.velocity_acceleration,
        held, model.dt, cutoff, law.lam, law.mu,
    )  # fmt: skip


def paired(first: Callable[[], object], second: Callable[[], object], pairs: int = PAIRS) -> tuple[float, float]:
    """Median ratio of the times second / first over alternating calls, and the median time of the first."""
    first(), second()
    ratios, times = [], []
    for _ in range(pairs):
        t = [time.perf_counter()]
        for call in (first, second):
            call()
            t.append(time.perf_counter())
        ratios.append((t[2] - t[1]) / (t[1] - t[0]))
        times.append(t[1] - t[0])
    return median(ratios), median(times)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("threads", [1, 2])
def test_updates(benchmark, method: str, threads: int) -> None:
    """Particle updates a second."""
    use_threads(threads)
    model, _ = start(method)
    benchmark.pedantic(advance, (model, unloaded), rounds=PAIRS, warmup_rounds=3)
    updates_a_second(benchmark, model)


@pytest.mark.parametrize("method", [method for method in METHODS if method != "mpm"])
def test_against_mpm(benchmark, method: str) -> None:
    """Time of a step over that of classical MPM on one thread, beside the ratio of their support nodes."""
    use_threads(1)
    mine, classical = start(method)[0], start("mpm")[0]
    ratio, _ = paired(lambda: advance(classical, unloaded), lambda: advance(mine, unloaded))
    nodes = mine.basis.support / classical.basis.support
    report(benchmark, f"{method}: time over mpm, with {nodes:.2f} times the support nodes", ratio)
    assert ratio <= nodes


@pytest.mark.parametrize("method", ["mpm", "cpdi"])
def test_against_yardstick(benchmark, method: str) -> None:
    """Speed on one thread over that of the hand-fused kernel, which must give the same particles."""
    use_threads(1)
    mine, theirs = start(method)[0], start(method)[0]
    ratio, _ = paired(lambda: advance(mine, unloaded), fused(theirs))
    assert np.allclose(mine.particles.in_initial_order("x"), theirs.particles.x, rtol=0, atol=1e-13)
    assert np.allclose(mine.particles.in_initial_order("F"), theirs.particles.F, rtol=0, atol=1e-10)
    report(benchmark, f"{method}: speed over the hand-fused kernel", ratio)


@pytest.mark.skipif(plain.COMPILER is None, reason="needs a C++ compiler")
@pytest.mark.parametrize("method", ["mpm", "cpdi"])
def test_against_plain_cpp(benchmark, method: str, tmp_path: Path) -> None:
    """Speed on one thread over that of plain C++, -O3 -march=native, which must give the same particles."""
    use_threads(1)
    mine, theirs = start(method)[0], start(method)[0]
    step = plain.stepped(plain.built(tmp_path), theirs)

    def steps(call: Callable[[], object]) -> None:
        for _ in range(STEPS):
            call()

    ratio, _ = paired(lambda: steps(lambda: advance(mine, unloaded)), lambda: steps(step), PAIRS // 3)
    assert np.allclose(mine.particles.in_initial_order("x"), theirs.particles.x, rtol=0, atol=1e-13)
    assert np.allclose(mine.particles.in_initial_order("F"), theirs.particles.F, rtol=0, atol=1e-10)
    report(benchmark, f"{method}: speed over plain C++", ratio)


@pytest.mark.parametrize("method", METHODS)
def test_two_threads(benchmark, method: str) -> None:
    """Speed of two threads over one, with the same bits."""
    one, two = start(method)[0], start(method)[0]

    def step(model: Model, threads: int) -> None:
        use_threads(threads)
        for _ in range(STEPS):
            advance(model, unloaded)

    ratio, _ = paired(lambda: step(two, 2), lambda: step(one, 1), PAIRS // 3)
    for name in ("x", "v", "F", "sigma"):
        assert np.array_equal(one.particles.in_initial_order(name), two.particles.in_initial_order(name))
    report(benchmark, f"{method}: speed of two threads over one", ratio)


@pytest.mark.parametrize("method", METHODS)
def test_cost_of_comparison(benchmark, method: str) -> None:
    """Body force and error norms, as a fraction of a step without them."""
    use_threads(1)
    model, comparison = start(method)
    fraction, _ = paired(lambda: advance(model, unloaded), lambda: comparison(model.particles, model.time))
    report(benchmark, f"{method}: body force and errors over a step", fraction)


def test_memory(benchmark) -> None:
    """Bytes a particle beyond 300 MB, from the peak of a process of its own with 1.3 million particles."""
    code = (
        "from mpm_verify.cases.mms.execute import setup, snapshot\n"
        "from mpm_verify.cases.harness.memory import peak_memory\n"
        "from mpm_verify.cases.mms.run import Run\nfrom mpm_verify.solver.step import advance\n"
        "run = Run('cpdi', 'axis_aligned', 'neo_hookean', 380, 9, 0.4)\n"
        "model, comparison, _ = setup(run)\n"
        "for _ in range(3): advance(model, comparison)\n"
        "kept = snapshot(run, model, comparison)\n"
        "print((peak_memory() - 300) * 2**20 / len(model.particles))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    report(benchmark, "bytes a particle beyond 300 MB", float(run.stdout))


def updates_a_second(benchmark, model: Model) -> None:
    """Keep the speed with the benchmark, where steps were timed and not only tried (--benchmark-disable)."""
    if benchmark.stats:
        benchmark.extra_info["million updates a second"] = len(model.particles) / benchmark.stats.stats.median / 1e6


def report(benchmark, name: str, value: float) -> None:
    """Keep the number with the benchmark, and print it with -s."""
    benchmark.extra_info[name] = value
    benchmark.pedantic(lambda: None)
    print(f"\n{name}: {value:.2f}")
