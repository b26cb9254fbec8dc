"""Speed of the laws by themselves, one thread: `make bench`. Nothing here asserts a time.

65 536 particles under an admissible compressive stress of sand and a random step of strain and rotation, from which
about half of them fail under the strength of the column's sand. They stand in no order, so a branch is as hard to
foretell as it can be; in a body those beside each other do alike.
"""

import time
from collections.abc import Callable
from functools import cached_property
from statistics import median
from typing import Any

import numpy as np
import pytest
from test_speed import report

from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.plugins import available, create
from mpm_verify.solver.rate_material import RateMaterial
from mpm_verify.solver.state import Floats, Particles

COUNT, ROUNDS = 65_536, 60
LAWS = available("mpm_verify.solver.material")


def stresses(rng: np.random.Generator) -> Floats:
    """Stress (P,4): mean 5 to 15 kPa, ratio of radius to centre of Mohr's circle below 0.5, zz between."""
    centre, ratio = -rng.uniform(5e3, 15e3, COUNT), rng.uniform(0.25, 0.5, COUNT)
    angle, zz = rng.uniform(0, 2 * np.pi, COUNT), rng.uniform(-1, 1, COUNT)
    across, along = -centre * ratio * np.cos(angle), -centre * ratio * np.sin(angle)
    return np.column_stack([centre + across, centre - across, centre * (1 + ratio * zz), along])


def gradients(rng: np.random.Generator) -> tuple[Floats, Floats]:
    """F at the start and at the end (P,2,2): up to a fifth of strain before, 0.8 % in the step."""
    before = np.eye(2) + rng.uniform(-0.2, 0.2, (COUNT, 2, 2))
    return before, (np.eye(2) + rng.uniform(-8e-3, 8e-3, (COUNT, 2, 2))) @ before


class Step:
    """One update of all particles by a law, which `prepare` makes the first again."""

    def __init__(self, law: Any) -> None:
        rng = np.random.default_rng(0)
        self.law, self.sigma = law, stresses(rng)
        self.before, self.after = gradients(rng)
        self.p = Particles(np.zeros((COUNT, 2)), np.ones(COUNT), np.ones(COUNT), np.zeros((COUNT, 0)))
        self.p.sigma, self.p.F = self.sigma.copy(), self.before.copy()
        law.start(self.p)
        self.history = self.p.history.copy()
        self.prepare()

    def prepare(self) -> None:
        self.p.sigma[:], self.p.F[:], self.p.history[:] = self.sigma, self.after, self.history
        if self.p.F_old.size:
            self.p.F_old[:] = self.before.reshape(-1, 4)

    def update(self) -> None:
        self.law.update(self.p, 1e-4)

    def respond(self) -> None:
        """The law's kernel alone, the strain increments those of the step without rotation."""
        self.law.respond(self.law.constants(), self.p.sigma.reshape(-1), self.strain, self.p.history.reshape(-1))

    @cached_property
    def strain(self) -> Floats:
        """Strain increments, flat, xx, yy, xy."""
        L = (self.after - self.before) @ np.linalg.inv(0.5 * (self.after + self.before))
        return np.column_stack([L[:, 0, 0], L[:, 1, 1], 0.5 * (L[:, 0, 1] + L[:, 1, 0])]).reshape(-1)


def speed(step: Step, call: Callable[[], None]) -> float:
    """Million updates a second, by the median time."""
    times = []
    for _ in range(ROUNDS):
        step.prepare()
        begin = time.perf_counter()
        call()
        times.append(time.perf_counter() - begin)
    return COUNT / median(times) / 1e6


@pytest.mark.parametrize("name", LAWS)
def test_stress_updates(benchmark, name: str) -> None:
    """Stress updates a second: of laws in rate form by the kernel alone, and with their objective rate."""
    use_threads(1)
    step = Step(create("mpm_verify.solver.material", name))
    report(benchmark, f"{name}: million updates a second", speed(step, step.update))
    assert np.isfinite(step.p.sigma).all()
    assert not np.array_equal(step.p.sigma, step.sigma)
    if not isinstance(step.law, RateMaterial):
        return
    benchmark.extra_info["its kernel alone"] = alone = speed(step, step.respond)
    print(f"its kernel alone: {alone:.1f}")
    if step.law.memory:
        benchmark.extra_info["fraction of particles that yield"] = fraction = yielding(step)
        print(f"fraction of particles that yield: {fraction:.2f}")
        assert fraction > 0.1


def yielding(step: Step) -> float:
    """Fraction of the particles whose history the step has changed."""
    step.prepare()
    step.update()
    return float((step.p.history != step.history).any(axis=1).mean())


@pytest.mark.parametrize("rate", available("mpm_verify.solver.rates"))
def test_cost_of_a_rate(benchmark, rate: str) -> None:
    """Time of the hypoelastic law with its rate over that of its kernel alone."""
    use_threads(1)
    step = Step(create("mpm_verify.solver.material", f"hypoelastic:E=840e3,rate={rate}"))
    around, alone = speed(step, step.update), speed(step, step.respond)
    assert np.isfinite(step.p.sigma).all()
    benchmark.extra_info["million updates a second"] = around
    report(
        benchmark, f"hypoelastic, {rate}: time over its kernel alone ({around:.1f} million a second)", alone / around
    )
