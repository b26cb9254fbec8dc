"""Crowding: claims over space on layouts with a closed answer, the strain that takes it off, its energy, a collapse."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.box.execute import setup as box_of
from mpm_verify.cases.box.run import Run
from mpm_verify.cases.column.execute import execute, setup
from mpm_verify.cases.column.measure import Measure
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.solver.basis.cpdi import Cpdi
from mpm_verify.solver.boundary import Walls, box
from mpm_verify.solver.crowding import NOISE, RATE, SLACK, Crowding, closed, excess, slack, smoothed, spaces
from mpm_verify.solver.friction import frictional
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.model import no_load
from mpm_verify.solver.plugins import MATERIALS, create
from mpm_verify.solver.pooling import APART, Pooling
from mpm_verify.solver.state import Floats, Grid
from mpm_verify.solver.step import Model, advance

DX = 0.1


def body(closer: float = 1.0, ppc: int = 9, dx: float = DX, beyond: int = 0) -> Model:
    """Sand that fills 12 x 12 cells and some `beyond`, particles `closer` together towards the lower left corner."""
    material: Any = create(MATERIALS, "mohr_coulomb:psi=0,void=1")
    corners = np.zeros(2), np.full(2, 12 * dx)
    grid, more = Grid(dx, *corners), beyond * dx
    p = Cpdi().populate(rectangle(corners[0] - more, corners[1] + more, dx, ppc), material.rho0)
    p.x *= closer
    return Model(grid, p, Cpdi(), material, box(grid, "roller"), 1e-4, pooling=Pooling())


def over(m: Model) -> Floats:
    """Excess of claims at nodes inside the domain, (13,13)."""
    return everywhere(m)[2:-2, 2:-2]


def everywhere(m: Model) -> Floats:
    """Excess of claims at all nodes, (17,17)."""
    p, g = m.particles, m.grid
    found: Floats = excess(g, smoothed(spaces(g, closed(g, m.walls))), p.x, p.V0 * p.J).reshape(g.nx, g.ny)
    return found


@pytest.mark.parametrize("ppc", [1, 4, 9, 16])
def test_a_regular_layout_claims_the_space_that_there_is(ppc: int) -> None:
    """Walls and corners included; closer by a tenth along both axes it claims 1/0.81, away from the free sides."""
    np.testing.assert_allclose(over(body(ppc=ppc)), 0.0, atol=1e-12)
    np.testing.assert_allclose(over(body(0.9, ppc=ppc))[:7, :7], 1 / 0.81 - 1, atol=0.25 if ppc == 1 else 0.03)
    m = body(ppc=ppc)
    m.particles.F *= np.sqrt(1.1)
    np.testing.assert_allclose(over(m), 0.1, atol=1e-12)
    assert over(body(1.1, ppc=ppc))[:7, :7].max() < -0.1


def test_beyond_a_free_side_there_is_space() -> None:
    """Sand that fills the ghost cells too, and sand across one side, are not crowded; to the last bit it stays."""
    m = body(beyond=2)
    m.walls = box(m.grid, "free")
    np.testing.assert_allclose(everywhere(m), 0.0, atol=1e-12)
    for side in range(4):
        m = body()
        kinds: Any = ["roller"] * 4
        kinds[side] = "free"
        m.particles.x[:, side // 2] += DX if side % 2 else -DX
        assert everywhere(m).max() > 0.3  # into a wall
        m.walls = box(m.grid, tuple(kinds))
        assert everywhere(m).max() < 1e-12
        F = m.particles.F.copy()
        relieved(m, 1)
        np.testing.assert_array_equal(m.particles.F, F)
        m.particles.F *= np.sqrt(1.1)
        assert everywhere(m).max() == pytest.approx(0.1, abs=1e-12)


def test_what_stands_on_a_side() -> None:
    """A wall with friction does before anything touches it, half a wall does not."""
    grid = body().grid
    assert closed(grid, frictional(grid, (0.3, "free", 0.3, "fixed"))) == (True, False, True, True)
    half: Walls = box(grid, ("roller", "roller", "fixed", "free"))
    assert closed(grid, half) == (True, True, True, False)
    half.held[(grid.nodes[:, 1] > 1.19) & (grid.nodes[:, 0] < 0.6), 1] = True
    assert closed(grid, half) == (True, True, True, False)
    half.held[(grid.nodes[:, 1] > 1.19), 1] = True
    assert closed(grid, half) == (True, True, True, True)


def test_space_follows_the_grid_and_its_sides() -> None:
    """Space of another cell, and of other walls, is another one, though its shape is the same."""
    crowding = Crowding()
    for dx, kind, corner in ((0.1, "roller", 0.25), (0.2, "roller", 0.25), (0.2, "free", 1.0), (0.1, "free", 1.0)):
        m = body(dx=dx)
        m.walls = box(m.grid, kind)  # type: ignore[arg-type]
        crowding.relieve(m)
        np.testing.assert_array_equal(crowding.space, smoothed(spaces(m.grid, closed(m.grid, m.walls))))
        assert spaces(m.grid, closed(m.grid, m.walls))[2, 2] == pytest.approx(corner * dx**2)
        assert crowding.strain == 0.0


def relieved(m: Model, times: int) -> list[float]:
    """Mean of ln J after each time."""
    found = []
    for _ in range(times):
        assert m.pooling
        m.pooling.crowding.relieve(m)
        found.append(float(np.log(m.particles.J).mean()))
    return found


def test_what_is_crowded_is_strained_by_a_rate() -> None:
    """ln J falls by RATE of what is beyond SLACK, each time; the stress is the material's, its work is counted."""
    m = body()
    p, phi = m.particles, 1.1
    p.F *= np.sqrt(phi)
    p.F_old[:] = p.F.reshape(-1, 4)
    sand: Any = m.material
    for ln_J in relieved(m, 5):
        phi *= np.exp(-RATE * (phi - 1 - SLACK))
        assert ln_J == pytest.approx(np.log(phi), abs=1e-10)
    assert m.pooling
    change = np.log(phi / 1.1)
    assert m.pooling.crowding.strain == pytest.approx(change, abs=1e-10)
    pressure = -(sand.lam + sand.mu) * change  # in the plane, elastic
    np.testing.assert_allclose(p.sigma[:, :2], -pressure, rtol=1e-2)
    assert m.pooling.crowding.given == pytest.approx(0.5 * pressure * -change * 1.1 * p.V0.sum(), rel=2e-2)
    np.testing.assert_allclose(p.F.reshape(-1, 4), p.F_old, atol=0)


def test_fewer_particles_are_given_more_slack() -> None:
    """As the scatter of particles that lie by chance, 0.26 over the root of their number per cell, measured here."""
    rng, found = np.random.default_rng(1), []
    for ppc in (4, 9, 16):
        m = body(ppc=ppc)
        scatter = []
        for _ in range(20):
            m.particles.x[:] = rng.uniform(0, 1.2, m.particles.x.shape)
            scatter.append(float((over(m)[3:-3, 3:-3] ** 2).mean()))
        found.append(float(np.mean(scatter) * ppc) ** 0.5)
        assert slack(m.grid, m.particles.V0) == pytest.approx(max(SLACK, NOISE / ppc**0.5))
    np.testing.assert_allclose(found, 3 * NOISE, rtol=0.2)


def test_voids_close_first_and_what_has_room_stays() -> None:
    """Sand with voids claims what it takes with them closed; at most SLACK is left alone, to the last bit."""
    for stretch, void, stays in ((1.1, np.log(1.1), True), (1.02, 0.0, True), (1.1, 0.02, False)):
        m = body()
        p = m.particles
        p.F *= np.sqrt(stretch)
        p.F_old[:] = p.F.reshape(-1, 4)
        p.history[:, 2] = void
        F = p.F.copy()
        relieved(m, 1)
        assert (p.F == F).all() == stays
        assert m.pooling
        assert (m.pooling.crowding.strain == 0.0) == stays
        assert m.pooling.crowding.given == 0.0  # voids give no stress
        assert not p.sigma.any()
    assert p.history[:, 2].max() < 0.02


def test_pooling_relieves_now_and_then() -> None:
    for steps in range(2 * APART):
        m = body()
        m.particles.F *= np.sqrt(1.1)
        m.particles.F_old[:] = m.particles.F.reshape(-1, 4)
        m.steps = steps
        assert m.pooling
        m.pooling.pool(m)
        assert (m.pooling.crowding.strain < 0) == (steps % APART == APART // 2 - 1)


def test_what_is_crowded_is_relieved_before_the_cells_are_pooled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Relief finds particles as the material left them, half of them open, and pooling finds them relieved."""
    m, found = body(), []
    relieve = Crowding.relieve

    def seen(self: Crowding, context: Any) -> None:
        found.append(m.particles.F.copy())
        relieve(self, context)
        found.append(m.particles.F.copy())

    monkeypatch.setattr(Crowding, "relieve", seen)
    p = m.particles
    p.F *= np.sqrt(1.1)
    p.F_old[:] = p.F.reshape(-1, 4)
    p.history[::2, 2] = 0.05
    p.sigma[1::2, :3] = -1000.0
    begun = p.F.copy()
    m.steps = APART // 2 - 1
    assert m.pooling
    m.pooling.pool(m)
    np.testing.assert_array_equal(found[0], begun)
    assert (found[1] < found[0])[:, 0, 0].all()
    assert m.pooling.taken > 0
    assert (p.F != found[1]).any()


def test_sound_sand_is_left_alone() -> None:
    """Shifted by 0.3 spacings and landing from a fall: nothing is given to it."""
    m, _ = box_of(Run(cells=4, aspect=3.5, drop=0.005, duration=0.1, pooling=True))
    for _ in range(400):
        advance(m, no_load)
    assert m.pooling
    assert m.pooling.taken > 0
    assert (m.pooling.crowding.given, m.pooling.crowding.strain) == (0.0, 0.0)


SMALL = ColumnRun(cells=4, ppc=1, duration=0.3, pooling=True)


def test_the_budget_of_a_collapse_has_what_is_given() -> None:
    """Residual and work of the forces as without; what crowding was given is on one side, and twice of it is seen."""
    model, steps = setup(SMALL)
    measure = Measure(SMALL, model)
    measure.look(model)
    for _ in range(steps):
        advance(model, no_load)
    assert model.pooling
    crowding = model.pooling.crowding
    measure.look(model)
    first = measure.rows[0]["potential"]
    last = measure.rows[-1]
    assert last["given"] == crowding.given > 0.002 * first
    assert last["drifted"] == crowding.strain < -0.01
    parts = [last[name] for name in ("kinetic", "potential", "elastic", "plastic", "pooled", "damping", "transfer")]
    total = sum(parts) + last["convection"] - last["walls"] - last["half_step"] - last["given"]
    assert total / first == pytest.approx(1, abs=1e-3)
    assert abs(last["residual"]) < 1e-12 * first
    assert abs(last["convection"]) < 3e-3 * first
    crowding.given *= 2
    measure.look(model)
    assert abs(measure.rows[-1]["convection"] - last["convection"]) == pytest.approx(last["given"])


@pytest.mark.slow
def test_a_collapsed_column_has_the_volume_of_its_sand() -> None:
    """9 per cell: area and crowding within 4 %, no overload, next to nothing without stress; as shipped far off."""
    run = ColumnRun(cells=7, material="mohr_coulomb:psi=0", pooling=True)
    done, arrays = execute(run)
    v = done.values
    assert v["area"] == pytest.approx(1, abs=0.04)
    assert v["crowding"] == pytest.approx(1, abs=0.04)
    assert v["idle"] < 0.1
    assert overload(run, arrays) < 8
    plain, arrays = execute(replace(run, pooling=False))
    assert plain.values["crowding"] > 1.1
    assert plain.values["idle"] > 0.5
    assert overload(run, arrays) > 8


def overload(run: ColumnRun, arrays: Any) -> float:
    """Largest sigma_yy of the two lowest rows of cells over their mean, at the end."""
    x, sigma, F = (arrays[f"snapshot_{name}"][-1] for name in ("x", "sigma", "F"))
    low = x[:, 1] < 2 * run.width / run.cells
    found = np.average(sigma[low, 1], weights=np.linalg.det(F[low]))
    return float(sigma[low, 1].min() / found)
