"""Reactions of walls: the weight of what rests, the momentum of what moves, parts of an edge that are pushed."""

from dataclasses import replace

import numpy as np
import pytest

from mpm_verify.solver.boundary import box
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.material.hencky_rate import HenckyRate
from mpm_verify.solver.plugins import METHODS, TRANSFERS, create
from mpm_verify.solver.pushed import PushedWalls, pushed
from mpm_verify.solver.reaction import Balance, Reaction
from mpm_verify.solver.state import Grid
from mpm_verify.solver.step import Model, Scheme, advance

SOIL = HenckyRate(E=1e6, nu=0.25, rho0=1500.0)
WIDE, HIGH, CELLS = 1.0, 0.75, 4
G = 9.81
WEIGHT = SOIL.rho0 * G * WIDE * HIGH
ROUND = 1e-12


def block(method: str = "cpdi", *, rest: bool = True, transfer: str = "flip", stress: str = "usl") -> Model:
    """Block under gravity between rollers: in equilibrium, or thrown about in it."""
    dx = WIDE / CELLS
    upper = np.array([WIDE, HIGH])
    grid, basis = Grid(dx, np.zeros(2), upper), create(METHODS, method)
    p = basis.populate(rectangle(np.zeros(2), upper, dx, 4), SOIL.rho0)
    down = -SOIL.rho0 * G * (HIGH - p.x[:, 1:])
    p.sigma[:] = down * [SOIL.nu / (1 - SOIL.nu), 1.0, SOIL.nu / (1 - SOIL.nu), 0.0]
    p.b[:] = [0.0, -G]
    if not rest:
        p.v[:] = 0.5 * np.stack([np.sin(5 * p.x[:, 0]), np.cos(4 * p.x[:, 1])], axis=1)
    walls = box(grid, ("roller", "roller", "roller", "free"))
    dt = 0.3 * dx / SOIL.wave_speed()
    return Model(grid, p, basis, SOIL, walls, dt, Scheme(create(TRANSFERS, transfer), stress))


def gravity(particles: object, t: float) -> None:
    """Leave the body force as it is."""


def went(model: Model, steps: int = 30) -> Model:
    for _ in range(steps):
        advance(model, gravity)
    return model


def floor(model: Model) -> np.ndarray:
    return model.grid.nodes[:, 1] < 1e-9


@pytest.mark.parametrize("method", ["mpm", "cpdi", "gimp"])
def test_a_block_at_rest_weighs_what_it_weighs(method: str) -> None:
    """Its floor bears the weight, each side K0 rho g H^2 / 2, and half of the floor about half."""
    model = block(method)
    n = model.grid.nodes
    base = floor(model)
    under, left = Reaction(base), Reaction(n[:, 0] < 1e-9)
    half = Reaction(base & (n[:, 0] < 0.5 * WIDE))
    model.watch(under, left, half)
    went(model, 1)
    side = SOIL.nu / (1 - SOIL.nu) * WEIGHT / WIDE * HIGH / 2
    assert under.force[1] == pytest.approx(WEIGHT, rel=ROUND)
    assert left.force[0] == pytest.approx(side, rel=ROUND)
    assert half.force[1] == pytest.approx(WEIGHT * (0.5 - 0.5 / CELLS), rel=ROUND)


@pytest.mark.parametrize("damping", [0.0, 0.3])
@pytest.mark.parametrize(
    ("transfer", "stress"), [("flip", "usl"), ("flip", "musl"), ("flip", "usf"), ("pic", "usl"), ("apic", "usl")]
)
def test_the_momentum_of_a_thrown_block_is_what_forces_gave(transfer: str, stress: str, damping: float) -> None:
    """In each step, to round-off, while walls bear more than its weight."""
    model = block(rest=False, transfer=transfer, stress=stress)
    model.damping = Damping(damping) if damping else None
    balance = Balance(np.array([0.0, -WEIGHT]))
    model.watch(balance)
    went(model)
    assert balance.largest > 1.2 * WEIGHT
    assert balance.missing < ROUND * balance.largest


@pytest.mark.parametrize("stops", [False, True])
def test_walls_that_stop_what_strikes_them_bear_that_too(stops: bool) -> None:
    model = block(rest=False)
    model.walls.stops = stops
    balance = Balance(np.array([0.0, -WEIGHT]))
    model.watch(balance)
    went(model)
    assert balance.missing < ROUND * balance.largest


def test_a_reaction_of_half_of_the_nodes_breaks_the_balance() -> None:
    model = block(rest=False)
    balance = Balance(np.array([0.0, -WEIGHT]))
    balance.walls.part = np.arange(len(model.grid.nodes)) % 2 == 0
    model.watch(balance)
    went(model)
    assert balance.missing > 0.1 * balance.largest


def test_parts_add_up_to_the_whole() -> None:
    model = block(rest=False)
    parts = np.arange(len(model.grid.nodes)) % 3
    found = [Reaction(parts == k) for k in range(3)]
    whole = Reaction()
    model.watch(whole, *found)
    went(model)
    np.testing.assert_allclose(sum(one.force for one in found), whole.force, atol=ROUND * WEIGHT)


def test_watching_the_walls_changes_no_bit() -> None:
    alone, watched = block(rest=False), block(rest=False)
    watched.watch(Reaction(), Balance(np.array([0.0, -WEIGHT])))
    assert not any(alone.hooks.values())
    for name in ("x", "v", "F", "sigma"):
        np.testing.assert_array_equal(getattr(went(alone).particles, name), getattr(went(watched).particles, name))


def pressed(travel: float, duration: float, rough: bool = False) -> Model:
    """Block without weight, whose upper edge is pressed down, in its middle, by a smooth travel."""
    model = block()
    model.particles.sigma[:] = 0.0
    model.particles.b[:] = 0.0
    nodes = model.grid.nodes
    there = (np.abs(nodes[:, 0] - 0.6) < 0.2) & (nodes[:, 1] > HIGH - 1e-9)
    made = pushed(model.walls, there, 1, lambda t: -0.5 * travel * (1 - np.cos(np.pi * t / duration)), rough)
    return replace(model, walls=made)


def test_particles_keep_the_velocity_of_a_wall_that_pushes_them_all() -> None:
    """A free body whose nodes are all pushed goes where the wall goes, without strain, and bears m a."""
    model = block()
    p, nodes, T = model.particles, model.grid.nodes, 50 * model.dt
    p.sigma[:], p.b[:] = 0.0, 0.0
    free = box(model.grid, "free")
    made = pushed(free, np.full(len(nodes), True), 0, lambda t: 1e-3 * (t / T) ** 2)
    p.v[:, 0] = made.travel(0.0) - made.travel(-model.dt)
    p.v[:, 0] /= model.dt
    model, reaction = replace(model, walls=made), Reaction()
    model.watch(reaction)
    went(model, 50)
    np.testing.assert_allclose(p.x[:, 0] - p.X[:, 0], 1e-3, rtol=1e-11)
    np.testing.assert_allclose(p.F, np.tile(np.eye(2), (len(p), 1, 1)), atol=1e-14)
    assert reaction.force[0] == pytest.approx(WEIGHT / G * 2e-3 / T**2, rel=1e-9)


@pytest.mark.parametrize("rough", [False, True])
def test_what_is_pressed_in_is_borne_by_the_floor(rough: bool) -> None:
    """Slowly: all walls together bear nothing; what a rough plate bears sideways it has from its own nodes."""
    duration = 20 * WIDE / SOIL.wave_speed()
    model = pressed(1e-5, duration, rough)
    assert isinstance(model.walls, PushedWalls)
    model.damping = Damping(0.7)
    plate, under, whole = Reaction(model.walls.there), Reaction(floor(model)), Reaction()
    model.watch(plate, under, whole)
    went(model, round(duration / model.dt))
    assert plate.force[1] < -0.3 * 1e-5 / HIGH * SOIL.E * WIDE / 2
    assert under.force[1] == pytest.approx(-plate.force[1], rel=1e-2)
    assert whole.force == pytest.approx([0.0, 0.0], abs=1e-2 * under.force[1])
    assert (abs(plate.force[0]) > 0.01 * under.force[1]) == rough


def test_nodes_beside_a_part_stay_as_they_were() -> None:
    model = pressed(1e-5, 1.0)
    walls = model.walls
    assert isinstance(walls, PushedWalls)
    walls.move(model.grid, 0.5, model.dt)
    assert (walls.value[walls.there, 1] < 0).all()
    assert not walls.value[~walls.there].any()
    assert not walls.value[:, 0].any()
    np.testing.assert_array_equal(walls.held[~walls.there], block().walls.held[~walls.there])
    with pytest.raises(ValueError, match="no node is pushed"):
        pushed(walls, np.zeros(len(walls.held), bool), 1, lambda t: t)
    with pytest.raises(ValueError, match="axis = 2 must be 0 or 1"):
        pushed(walls, walls.there, 2, lambda t: t)
