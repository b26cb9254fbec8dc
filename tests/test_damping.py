"""Local damping against its closed forms: free fall, throw, oscillator; and what it is without axes."""

from typing import Any

import numpy as np
import pytest

from mpm_verify.solver.basis.mpm import Mpm
from mpm_verify.solver.boundary import box
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.material.hypoelastic import Hypoelastic
from mpm_verify.solver.state import Grid, Particles
from mpm_verify.solver.step import Model, advance

SOFT = Hypoelastic(E=1e-6, rho0=1.0)
G = 10.0


def block(damping: Damping | None, law: Any = SOFT, dt: float = 1e-3) -> Model:
    """A square of 2 by 2 cells that nothing holds, in the middle of 12 by 40."""
    grid = Grid(0.1, np.zeros(2), np.array([1.2, 4.0]))
    p = Mpm().populate(rectangle(np.array([0.5, 1.0]), np.array([0.7, 1.2]), 0.1, 4), law.rho0)
    return Model(grid, p, Mpm(), law, box(grid, "free"), dt, damping=damping)


def gravity(direction: Any) -> Any:
    def load(p: Particles, t: float) -> None:
        p.b[:] = np.array(direction) * G

    return load


@pytest.mark.parametrize("kind", ["local", "objective"])
@pytest.mark.parametrize("alpha", [0.05, 0.5])
def test_free_fall_and_throw(kind: Any, alpha: float) -> None:
    """(1 - alpha) g down from the second step on, (1 + alpha) g on the way up; the heights that follow."""
    m = block(Damping(alpha, kind))
    v = []
    for _ in range(300):
        advance(m, gravity((0, -1)))
        v.append(m.particles.v[:, 1].mean())
    np.testing.assert_allclose(np.diff(v), -(1 - alpha) * G * m.dt, rtol=1e-12)
    assert m.damped == pytest.approx(alpha * G * m.particles.m.sum() * (1.1 - m.particles.x[:, 1].mean()), rel=1e-2)
    m = block(Damping(alpha, kind))
    m.particles.v[:, 1] = v0 = 4.0
    v, y = [v0], [1.1]
    while y[-1] >= 1.1:
        advance(m, gravity((0, -1)))
        v.append(m.particles.v[:, 1].mean())
        y.append(m.particles.x[:, 1].mean())
    assert v[1] - v[0] == pytest.approx(-(1 + alpha) * G * m.dt, rel=1e-12)
    assert max(y) - 1.1 == pytest.approx(v0**2 / (2 * G * (1 + alpha)), rel=5e-3)
    assert -v[-1] == pytest.approx(v0 * np.sqrt((1 - alpha) / (1 + alpha)), rel=1e-2)
    m = block(None)
    m.particles.v[:, 1] = v0
    advance(m, gravity((0, -1)))
    assert v0 - m.particles.v[0, 1] == pytest.approx(G * m.dt, rel=1e-12)  # without it the check would fail


@pytest.mark.parametrize("alpha", [0.02, 0.05, 0.1])
def test_oscillator(alpha: float) -> None:
    """One free node: its amplitude falls by (1 - alpha)/(1 + alpha) a cycle, by force and velocity as the kernel has
    them; the work that is taken is the energy that is lost."""
    grid = Grid(1.0, np.zeros(2), np.ones(2))
    walls = box(grid, "free")
    mass, k, dt = 2.0, 30.0, 1e-4
    grid.mass[10] = mass
    x, v, taken, tops = 1.0, 0.0, 0.0, [1.0]
    for _ in range(round(4 * 2 * np.pi / np.sqrt(k / mass) / dt * 1.01)):
        grid.momentum_force[10] = mass * v, 0.0, -k * x, 0.0
        taken += Damping(alpha).apply(grid, walls, dt, 1e-12)
        last, v = v, v + dt * grid.momentum_force[10, 2] / mass
        x += dt * v
        if last > 0 >= v:
            tops.append(x)
    ratios = np.array(tops[1:]) / np.array(tops[:-1])
    assert len(ratios) == 4
    np.testing.assert_allclose(ratios, (1 - alpha) / (1 + alpha), rtol=1e-3)
    left = k * x**2 / 2 + mass * v**2 / 2
    assert taken == pytest.approx(k / 2 - left, rel=2e-3)


def test_axes_matter_to_the_local_kind_alone() -> None:
    """A force across the motion: the objective kind turns with its axes, the local one does not."""
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    grid = Grid(1.0, np.zeros(2), np.ones(2))
    away = {}
    for kind in ("local", "objective"):
        damping, forces = Damping(0.3, kind), []
        for Q in (np.eye(2), turn):
            grid.mass[10] = 1.5
            grid.momentum_force[10] = np.r_[Q @ [1.5, 0.0], Q @ [2.0, -3.0]]
            damping.apply(grid, box(grid, "free"), 1e-3, 1e-12)
            forces.append(Q.T @ grid.force[10])
        away[kind] = np.abs(forces[0] - forces[1]).max()
    assert away["objective"] < 1e-15
    assert away["local"] > 0.1


def test_walls_and_rest_are_left_alone() -> None:
    grid = Grid(1.0, np.zeros(2), np.ones(2))
    grid.mass[:] = 1.0
    grid.momentum_force[:] = [0.0, 0.0, 1.0, 2.0]
    assert Damping(0.5).apply(grid, box(grid, "free"), 1e-3, 1e-12) == 0.0  # at rest
    grid.momentum_force[:] = [1.0, 1.0, 1.0, 2.0]
    walls = box(grid, "roller")
    Damping(0.5).apply(grid, walls, 1e-3, 1e-12)
    assert (grid.force[walls.held] == np.tile([1.0, 2.0], (len(walls.held), 1))[walls.held]).all()
    assert (grid.force[~walls.held] < np.tile([1.0, 2.0], (len(walls.held), 1))[~walls.held]).all()


def test_none_at_all_has_the_same_bits() -> None:
    models = [block(damping, Hypoelastic(E=1e3, rho0=1.0)) for damping in (None, Damping(0.0))]
    for m in models:
        m.particles.v[:] = 0.1 * np.random.default_rng(1).normal(size=m.particles.v.shape)
        for _ in range(50):
            advance(m, gravity((1, -1)))
    for name in ("x", "v", "F", "sigma"):
        np.testing.assert_array_equal(*(getattr(m.particles, name) for m in models))
    assert models[1].damped == 0.0


@pytest.mark.parametrize("alpha", [-0.1, 1.0, np.nan])
def test_refusals(alpha: float) -> None:
    with pytest.raises(ValueError, match="must lie from 0 to below 1"):
        Damping(alpha)
    with pytest.raises(ValueError, match="choose from local, objective"):
        Damping(0.1, "viscous")  # type: ignore[arg-type]
