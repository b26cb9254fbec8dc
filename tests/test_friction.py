"""Walls with friction: blocks on an incline against rigid ones, momentum, energy, the mirror, threads."""

from collections.abc import Iterator
from dataclasses import replace
from math import cos, radians, sin
from typing import Any

import numpy as np
import pytest

from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.boundary import box, moving
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.energy_budget import Budget, kinetic, residual
from mpm_verify.solver.friction import FrictionalWalls, frictional
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.material.hypoelastic import Hypoelastic
from mpm_verify.solver.model import Observer
from mpm_verify.solver.plugins import METHODS, TRANSFERS, create
from mpm_verify.solver.pushed import pushed
from mpm_verify.solver.state import Grid
from mpm_verify.solver.step import Model, Scheme, advance

G, INCLINE, V0 = 10.0, radians(25.0), 0.5
STIFF = Hypoelastic(E=1e7, nu=0.0, rho0=1000.0)
DX = 0.25


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    use_threads(1)
    yield
    use_threads(2)


def incline(
    mu: float, v0: float = V0, method: str = "cpdi", scheme: Scheme | None = None, side: float = 1.0, **more: Any
) -> Model:
    """Block of 2 m by 1 m on a plane that falls by INCLINE to the right, or to the left, with its own weight in it."""
    grid = Grid(DX, np.array([-2.0, 0.0]), np.array([4.0, 1.5]))
    basis = create(METHODS, method)
    p = basis.populate(rectangle(np.zeros(2), np.array([2.0, 1.0]), DX, 4), STIFF.rho0)
    p.b[:] = G * np.array([side * sin(INCLINE), -cos(INCLINE)])
    p.v[:, 0] = side * v0
    p.sigma[:, 1] = -STIFF.rho0 * G * cos(INCLINE) * (1.0 - p.x[:, 1])
    walls = frictional(grid, ("free", "free", mu, "free"))
    return Model(grid, p, basis, STIFF, walls, 0.4 * DX / STIFF.wave_speed(), scheme or Scheme(), **more)


def go(m: Model, duration: float) -> tuple[Any, Any]:
    """Mean shift (T,2) and mean velocity (T,2) after each step."""
    x, rows = m.particles.x.mean(axis=0), []
    for _ in range(round(duration / m.dt)):
        advance(m, lambda particles, t: None)
        rows.append([m.particles.x.mean(axis=0) - x, m.particles.v.mean(axis=0)])
    x, v = np.array(rows).transpose(1, 0, 2)
    return x, v


SCHEMES = [("flip", "usl"), ("flip", "musl"), ("flip", "usf"), ("pic", "usl"), ("apic", "usl"), ("apic", "musl"),
           ("flip:fraction=0.9", "usf")]  # fmt: skip


@pytest.mark.parametrize(("transfer", "stress"), SCHEMES)
def test_a_block_that_slides(transfer: str, stress: str) -> None:
    """Block with mu = 0.3 that has g (sin - mu cos), whatever carries its velocity.

    In each step friction is mu times what the plane gives, and the plane carries the weight.
    """
    m = incline(0.3, scheme=Scheme(create(TRANSFERS, transfer), stress))
    x, v = go(m, 0.2)
    t = m.dt * np.arange(1, len(v) + 1)
    a = G * (sin(INCLINE) - 0.3 * cos(INCLINE))
    assert np.abs(v[:, 0] - (V0 + a * t - 0.3 * v[:, 1])).max() < 1e-11
    assert x[-1, 0] == pytest.approx(V0 * t[-1] + a * t[-1] * (t[-1] + m.dt) / 2, rel=1e-3)
    assert abs(x[-1, 1]) < 1e-5
    assert a == pytest.approx(1.507259, rel=1e-6)


def test_a_block_that_comes_to_rest() -> None:
    """Block with mu = 0.6 that stops after v0 / g (mu cos - sin) and has slid v0^2 / 2 g (mu cos - sin).

    Then no node moves any more.
    """
    m = incline(0.6)
    slow = G * (0.6 * cos(INCLINE) - sin(INCLINE))
    x, v = go(m, V0 / slow + 0.15)
    walls, grid = m.walls, m.grid
    assert isinstance(walls, FrictionalWalls)
    t = m.dt * np.arange(1, len(v) + 1)
    sliding = t < (V0 - 0.1) / slow  # later the end that is pressed least stops and goes on
    assert np.abs(v[sliding, 0] - (V0 - slow * t - 0.6 * v[:, 1])[sliding]).max() < 1e-11
    assert x[-1, 0] == pytest.approx(V0**2 / (2 * slow), rel=5e-3)
    floor = (grid.nodes[:, 1] == 0) & (grid.mass > m.cutoff)
    assert floor.sum() == 9 or floor.sum() == 10
    assert (grid.velocity[floor] == 0.0).all()
    taken = walls.taken
    later, _ = go(m, 0.1)
    assert np.abs(later[:, 0]).max() < 1e-4  # it shivers, and does not creep
    assert walls.taken == pytest.approx(taken, rel=1e-6)


@pytest.mark.parametrize("method", ["mpm", "gimp", "cpdi", "cpdi2", "bspline2", "bspline3"])
def test_each_method_has_the_same_friction(method: str) -> None:
    """Agreement to what waves make of the nodes before the block, which have hardly any mass."""
    m = incline(0.3, method=method)
    _, v = go(m, 0.05)
    a = G * (sin(INCLINE) - 0.3 * cos(INCLINE))
    assert abs(v[-1, 0] - (V0 + a * m.time - 0.3 * v[-1, 1])) < 1e-6


def test_energy_adds_up_and_friction_only_takes() -> None:
    """Budget of a block that slides and stops, damped: closed to round-off; what friction takes falls in no step and
    is what the block lost."""
    m = incline(0.6, damping=Damping(0.05))
    gravity = m.particles.b[0].copy()
    budget = Budget(gravity, kinetic(m.particles))
    m.watch(budget)
    first, taken = budget.terms(m), [0.0]
    for _ in range(round(0.6 / m.dt)):
        advance(m, lambda particles, t: None)
        taken.append(m.walls.taken)  # type: ignore[attr-defined]
    last = budget.terms(m)
    assert abs(residual(last, first)) < 1e-10 * first["kinetic"]
    assert (np.diff(taken) >= 0).all()
    assert np.diff(taken)[0] > 0
    lost = first["kinetic"] + first["potential"] - last["potential"] - last["kinetic"] - last["damping"]
    assert taken[-1] == pytest.approx(lost, rel=0.02)
    assert taken[-1] == pytest.approx(-last["walls"], rel=0.02)


def test_the_mirror() -> None:
    """Down to the left is down to the right, mirrored."""
    right, left = incline(0.3), incline(0.3, side=-1.0)
    a, b = go(right, 0.1), go(left, 0.1)
    np.testing.assert_allclose(b[0], a[0] * [-1, 1], atol=1e-12)
    np.testing.assert_allclose(b[1], a[1] * [-1, 1], atol=1e-11)
    assert np.abs(a[1]).max() > 0.5


@pytest.mark.parametrize("transfer", ["flip", "apic"])
def test_threads_change_no_bit(transfer: str) -> None:
    found = []
    for threads in (1, 2):
        use_threads(threads)
        m = incline(0.3, scheme=Scheme(create(TRANSFERS, transfer)))
        go(m, 0.05)
        found.append((m.particles.x, m.particles.v, m.particles.sigma, m.walls.taken))  # type: ignore[attr-defined]
    for one, other in zip(*found, strict=True):
        assert np.array_equal(one, other)


def test_a_body_leaves_and_a_fixed_floor_holds_it() -> None:
    """Pulled off the floor a block flies; on a floor that is fixed it hangs."""
    for walls, flies in ((frictional, True), (box, False)):
        m = incline(0.3, v0=0.0)
        m.particles.sigma[:] = 0.0
        m.particles.b[:] = (0.0, G)
        m.walls = walls(m.grid, ("free", "free", 0.3 if flies else "fixed", "free"))  # type: ignore[operator]
        _, v = go(m, 0.05)
        assert (np.abs(m.particles.v - [0, G * m.time]).max() < 1e-12) == flies
        assert (v[-1, 1] == pytest.approx(G * m.time)) == flies


def test_the_wall_acts_up_to_a_cell_early() -> None:
    """A block that falls on a floor is stopped as soon as its lowest weights reach it: with hats within a cell."""
    m = incline(0.3, v0=0.0, method="mpm")
    m.particles.sigma[:] = 0.0
    m.particles.x[:, 1] += 0.3
    m.particles.v[:] = (0.0, -0.5)
    m.particles.b[:] = 0.0
    lowest = []
    for _ in range(round(1.0 / m.dt)):
        advance(m, lambda particles, t: None)
        lowest.append(m.particles.x[:, 1].min())
        if m.particles.v[:, 1].mean() > 0.0:
            break
    assert 0.7 * DX < min(lowest) < DX  # of particles; the edge of the block is a quarter of a cell below them


def test_walls_that_move_and_what_is_refused() -> None:
    """A floor with friction beside a gate that a rule moves; coefficients below zero and other words."""
    grid = Grid(DX, np.zeros(2), np.ones(2))
    still = frictional(grid, ("free", "roller", 0.5, "free"))
    assert isinstance(still, FrictionalWalls)
    rule = moving(grid, lambda nodes, t, dt: (np.full(nodes.shape, t > 0.5), np.full(nodes.shape, t), 0 * nodes))
    both = FrictionalWalls(rule.held, rule.value, rule.rate, rule, still.normal, still.mu)
    both.move(grid, 1.0, 0.1)
    assert both.held.all()
    assert (both.value == 1.0).all()
    both.move(grid, 0.0, 0.1)
    assert not both.held.any()
    assert type(frictional(grid, ("free", "roller", "fixed", "free"))) is type(box(grid, "free"))
    for wrong in (-0.1, float("nan")):
        with pytest.raises(ValueError, match=r"friction = .* must be zero or more"):
            frictional(grid, ("free", "free", wrong, "free"))
    with pytest.raises(ValueError, match="no wall 'sandy'"):
        frictional(grid, ("free", "free", "sandy", "free"))  # type: ignore[arg-type]


def flown(stress: str, v: float, courant: float = 0.4) -> Model:
    """Block without stress on a floor, after a step of its flight with v off it."""
    m = incline(0.3, v0=0.0, scheme=Scheme(stress=stress))  # type: ignore[arg-type]
    m.particles.sigma[:], m.particles.b[:], m.particles.v[:] = 0.0, 0.0, (0.0, v)
    m.dt = courant * DX / STIFF.wave_speed()
    advance(m, lambda particles, t: None)
    return m


@pytest.mark.parametrize("stress", ["usl", "musl", "usf"])
def test_nothing_strains_a_body_that_leaves(stress: str) -> None:
    """Update-stress-first neither, which strains before it knows the forces."""
    m = flown(stress, 1.0)
    for _ in range(2):
        advance(m, lambda particles, t: None)
    assert np.abs(m.particles.F - np.eye(2)).max() < 1e-15
    assert np.abs(m.particles.v - [0.0, 1.0]).max() < 1e-15


@pytest.mark.parametrize("courant", [0.4, 0.2])
def test_a_strike_strains_a_step_late_with_update_stress_first(courant: float) -> None:
    """Strain of v dt / dx, of first order in dt."""
    at_once, late = flown("usl", -1.0, courant), flown("usf", -1.0, courant)
    strain = courant / STIFF.wave_speed()
    assert np.abs(at_once.particles.F - np.eye(2)).max() == pytest.approx(strain, rel=1e-9)
    assert np.abs(late.particles.F - np.eye(2)).max() == 0.0
    advance(late, lambda particles, t: None)
    assert 0.7 * strain < np.abs(late.particles.F - np.eye(2)).max() < strain


def one_node(walls_rate: float = 0.0) -> tuple[Grid, FrictionalWalls]:
    """Grid of nodes with the mass 1 but those of the right side, above a floor with friction."""
    grid = Grid(1.0, np.zeros(2), np.array([2.0, 1.0]))
    walls = frictional(grid, ("free", "free", 0.5, "free"))
    assert isinstance(walls, FrictionalWalls)
    grid.mass[grid.nodes[:, 0] < 1.5] = 1.0
    walls.still.value[:, 1] = walls_rate
    return grid, walls


@pytest.mark.parametrize(("kind", "ends"), [("local", -0.35), ("objective", 0.1 - 0.5 * 0.9 / 10**0.5)])
def test_damping_turns_no_node_into_the_wall(kind: Any, ends: float) -> None:
    """A node that leaves with 0.1 ends at `ends` with damping alone; the wall holds it, and rubs by what it gives."""
    grid, walls = one_node()
    floor = (grid.nodes[:, 1] <= 0) & (grid.mass > 0)
    grid.momentum_force[grid.mass > 0] = (3.0, 1.0, 0.0, -0.9)
    walls.touch(grid, 1.0, 1e-12)
    assert not walls.held.any()
    before = grid.momentum + grid.force
    work = walls.damp(Damping(0.5, kind).apply, grid, 1.0, 1e-12)
    new = grid.momentum + grid.force
    assert ends < 0
    assert new[floor, 1] == pytest.approx(ends)
    assert walls.held[floor].all()
    assert (walls.value[floor, 1] == 0.0).all()
    assert walls.value[floor, 0] == pytest.approx(new[floor, 0] + 0.5 * new[floor, 1])
    after = np.where(walls.held, walls.value, new)
    assert work == pytest.approx(((before - new) * (grid.momentum + after))[grid.mass > 0].sum() / 2)
    assert not walls.held[~floor].any()


@pytest.mark.parametrize("kind", ["local", "objective"])
def test_energy_adds_up_where_damping_meets_a_wall(kind: Any) -> None:
    """Block that strikes the floor and flies off, half of its force damped: no velocity into the floor, none of the
    energy missing."""

    class Into(Observer):
        def __init__(self) -> None:
            self.least = 0.0

        def after_motion(self, model: Model) -> None:
            floor = (model.grid.nodes[:, 1] == 0) & (model.grid.mass > model.cutoff)
            self.least = min(self.least, float(model.grid.velocity[floor, 1].min()))

    m = incline(0.3, damping=Damping(0.5, kind))
    m.particles.v[:] = (0.5, -1.0)
    budget, into = Budget(m.particles.b[0].copy(), kinetic(m.particles)), Into()
    m.watch(budget)
    m.watch(into)
    first = budget.terms(m)
    for _ in range(100):
        advance(m, lambda particles, t: None)
    assert abs(residual(budget.terms(m), first)) < 1e-10 * first["kinetic"]
    assert into.least == 0.0


def test_a_wall_with_friction_that_moves() -> None:
    """Nodes without mass are left alone: there is nothing to hold; those with mass take its velocity."""
    grid, walls = one_node(1.0)
    floor = grid.nodes[:, 1] <= 0
    walls.touch(grid, 0.1, 1e-12)
    full = grid.mass > 0
    assert walls.held[floor & full, 1].all()
    assert (walls.value[floor & full, 1] == 1.0).all()
    assert not walls.held[~full].any()
    assert np.isfinite(walls.rate).all()
    assert np.isfinite(walls.taken)


def test_pushed_walls_beside_friction() -> None:
    """A plate that is pushed beside a floor with friction moves, and what it hands on, and what it strains."""
    grid = Grid(DX, np.zeros(2), np.ones(2))
    floor = frictional(grid, ("free", "free", 0.5, "free"))
    assert isinstance(floor, FrictionalWalls)
    there = grid.nodes[:, 0] >= 1.0 - 1e-9
    plate = pushed(replace(floor.still, stops=True), there, 0, lambda t: -0.5 * t**2)
    walls = FrictionalWalls(floor.held, floor.value, floor.rate, plate, floor.normal, floor.mu)
    assert walls.stops
    walls.move(grid, 1.0, 0.1)
    assert walls.value[there, 0] == pytest.approx(-1.05)
    assert walls.rate[there, 0] == pytest.approx(-1.0)
    assert walls.held[there, 0].all()
    assert not walls.held[~there].any()


def test_a_gate_beside_friction_strains_while_it_is_there() -> None:
    """Nodes that have the gate's velocity in the strain of musl and usf too, until it is gone; contact is kept."""
    grid = Grid(DX, np.zeros(2), np.ones(2))
    floor = frictional(grid, ("free", "free", 0.5, "free"))
    assert isinstance(floor, FrictionalWalls)
    gate = grid.nodes[:, 0] > 0.6

    def rule(nodes: Any, t: float, dt: float) -> Any:
        held = np.zeros(nodes.shape, bool)
        held[gate, 0] = 0.5 < t < 1.5
        return held, np.zeros(nodes.shape), np.zeros(nodes.shape)

    walls = FrictionalWalls(floor.held, floor.value, floor.rate, moving(grid, rule), floor.normal, floor.mu)
    grid.mass[:] = 1.0
    grid.momentum_force[:] = (1.0, -1.0, 0.0, 0.0)
    for t in (0.0, 1.0, 2.0):
        walls.move(grid, t, 0.1)
        held, _, _ = walls.in_strain()
        assert held[gate & (grid.nodes[:, 1] > 0), 0].all() == (t == 1.0)
        assert held[grid.nodes[:, 1] <= 0, 1].all() == (t > 0.0)  # what touched in the step before
        walls.touch(grid, 0.1, 1e-12)
