"""Momentum and energy of a body between walls with every transfer: what walls take, in a filter too, and no more."""

import numpy as np
import pytest

from mpm_verify.solver.boundary import box
from mpm_verify.solver.energy_budget import Budget, kinetic, residual
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.material.hencky_rate import HenckyRate
from mpm_verify.solver.plugins import METHODS, TRANSFERS, create
from mpm_verify.solver.state import Floats, Grid
from mpm_verify.solver.step import Model, Scheme, advance
from mpm_verify.solver.transfers.fmpm import Fmpm

SOIL = HenckyRate(E=1e6, nu=0.25, rho0=1500.0)
GRAVITY = np.array([0.3, -9.81])
STEPS, ROUND = 20, 1e-12
TRANSFERS_HERE = ("flip", "flip:fraction=0.9", "pic", "apic", "fmpm", "fmpm:order=4")


def thrown(transfer: str, stops: bool) -> tuple[Model, Budget]:
    """Body thrown about between a roller, a fixed floor and a free top, with the budget that watches it."""
    dx, upper = 0.25, np.array([1.0, 0.75])
    grid, basis = Grid(dx, np.zeros(2), upper), create(METHODS, "cpdi")
    p = basis.populate(rectangle(np.zeros(2), upper, dx, 4), SOIL.rho0)
    p.v[:] = 0.5 * np.stack([np.sin(5 * p.x[:, 0]), np.cos(4 * p.x[:, 1])], axis=1)
    p.b[:] = GRAVITY
    walls = box(grid, ("roller", "roller", "fixed", "free"))
    walls.stops = stops
    model = Model(grid, p, basis, SOIL, walls, 0.3 * dx / SOIL.wave_speed(), Scheme(create(TRANSFERS, transfer)))
    budget = Budget(GRAVITY, kinetic(p))
    model.watch(budget)
    return model, budget


def missed(transfer: str, stops: bool = True) -> tuple[float, float, dict[str, float]]:
    """Momentum and energy that no term explains, over those that there are, and the terms at the end."""
    model, budget = thrown(transfer, stops)
    p = model.particles
    first, at_first, weight = budget.terms(model), momentum(model), p.m.sum() * GRAVITY * model.dt
    for _ in range(STEPS):
        advance(model, lambda particles, t: None)
    last = budget.terms(model)
    gap = momentum(model) - at_first - STEPS * weight - budget.impulse
    return float(np.abs(gap).max() / (p.m.sum() * 0.5)), abs(residual(last, first)) / first["kinetic"], last


def momentum(model: Model) -> Floats:
    """Momentum (2,) of the particles."""
    found: Floats = (model.particles.m[:, None] * model.particles.v).sum(axis=0)
    return found


@pytest.mark.parametrize("stops", [True, False])
@pytest.mark.parametrize("transfer", TRANSFERS_HERE)
def test_momentum_and_energy_are_accounted_for(transfer: str, stops: bool) -> None:
    momentum, energy, _ = missed(transfer, stops)
    assert momentum < ROUND
    assert energy < ROUND


@pytest.mark.parametrize("order", [2, 4])
def test_walls_that_stand_still_do_no_work_in_a_filter(order: int) -> None:
    """Velocities that the filter leaves at held nodes are no work of theirs; what is lost is the transfer's."""
    *_, terms = missed(f"fmpm:order={order}")
    assert terms["walls"] == 0.0
    assert terms["transfer"] > 0.0


def test_what_walls_take_in_the_filter_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = Fmpm.filter

    def untold(self: Fmpm, context: Model, velocity_acceleration: Floats) -> None:
        whole(self, context, velocity_acceleration)
        context.walls.filtered[:] = 0.0

    monkeypatch.setattr(Fmpm, "filter", untold)
    assert missed("fmpm")[0] > 1e-3


def test_a_filter_that_drops_momentum_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """One per mille of the velocities of all nodes, free ones too."""
    whole = Fmpm.filter

    def leaky(self: Fmpm, context: Model, velocity_acceleration: Floats) -> None:
        whole(self, context, velocity_acceleration)
        velocity_acceleration[:, :2] *= 0.999

    monkeypatch.setattr(Fmpm, "filter", leaky)
    momentum, energy, _ = missed("fmpm")
    assert momentum > 1e-5
    assert energy < ROUND  # it is a loss of the transfer


def test_a_filter_that_is_not_counted_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Fmpm, "filters", False)
    momentum, energy, terms = missed("fmpm")
    assert energy > 1e-6
    assert terms["walls"] < -0.01 * terms["kinetic"]
    assert momentum > 1e-3
