"""Pooling: what a cell keeps, strength, energy, UBCSAND's own compression, threads, the mirror, and the box with it."""

from dataclasses import replace
from typing import Any

import numba
import numpy as np
import pytest
from scipy.integrate import quad

from mpm_verify.cases.box.execute import execute, setup
from mpm_verify.cases.box.run import ROWS, Run
from mpm_verify.cases.column.execute import execute as column
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.solver.basis.cpdi import Cpdi
from mpm_verify.solver.boundary import box
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.model import no_load
from mpm_verify.solver.plugins import MATERIALS, create
from mpm_verify.solver.pooling import APART, MIXED, Pooling
from mpm_verify.solver.state import Floats, Grid
from mpm_verify.solver.step import Model, advance

DX = 0.1
SANDS = ["mohr_coulomb:void=1", "drucker_prager:void=1", "ubcsand:void=1"]
COHESIVE = "mohr_coulomb:c=2e3,sigma_t=1e3"
OTHERS = [COHESIVE, "mohr_coulomb:c=500,void=1", "ubcsand:void=1,ne=0.4"]


def admissible(rng: np.random.Generator, material: Any, count: int) -> Floats:
    """Random stresses (n,4) that one step of the material leaves, some of them without any."""
    sigma = np.zeros((count, 4))
    history = np.zeros((count, len(material.memory)))
    de = rng.normal(0.0 if material.cohesion else -2e-3, 4e-3, (count, 3))
    material.respond(material.constants(), sigma.ravel(), de.ravel(), history.ravel())
    sigma[(history[:, material.memory.index("void")] > 0)] = 0.0
    return sigma


def body(name: str, opened: float = 0.3, ppc: int = 9, seed: int = 1) -> Model:
    """A block of cells with stresses that a step leaves, and void strain of up to `opened` where there is none."""
    material = create(MATERIALS, name)
    grid = Grid(DX, np.zeros(2), np.array([1.0, 1.0]))
    p = Cpdi().populate(rectangle(np.array([0.2, 0.3]), np.array([0.7, 0.7]), DX, ppc), material.rho0)
    rng = np.random.default_rng(seed)
    p.x += rng.uniform(-0.02, 0.02, p.x.shape)
    p.F[:] = np.eye(2) + rng.uniform(-0.1, 0.1, p.F.shape)
    p.sigma[:] = admissible(rng, material, len(p))
    model = Model(grid, p, Cpdi(), material, box(grid, "roller"), 1e-4, pooling=Pooling())
    void = p.history[:, material.memory.index("void")]
    idle = (p.sigma == 0).all(axis=1)
    void[idle] = opened * rng.uniform(0, 0.1, idle.sum()) if material.void else 0.0
    if "eta_m" in material.memory:
        p.history[:, 0] = material.initial(p.sigma)[:, 0]
    return model


def strains(m: Model) -> Floats:
    """Volume strain w = void - elastic compression (P,)."""
    void = m.particles.history[:, m.material.memory.index("void")]
    assert m.pooling is not None
    assert m.pooling.compression is not None
    found: Floats = void - m.pooling.compression.held(m.particles.sigma)
    return found


def cells(m: Model) -> Any:
    return m.grid.cell(m.particles.x) @ [100, 1]


def excess(material: Any, sigma: Floats) -> float:
    """Largest change that the material's own return would make of stresses (n,4), over the largest stress."""
    after = sigma.copy()
    history = material.initial(sigma)
    material.respond(material.constants(), after.ravel(), np.zeros(3 * len(sigma)), history.ravel())
    return float(np.abs(after - sigma).max() / np.abs(sigma).max())


@pytest.mark.parametrize("name", [*SANDS, *OTHERS])
def test_a_cell_keeps_its_volume_and_has_one_sign(name: str) -> None:
    """Sum V0 ln J and sum V0 w of each cell to round-off; no cell is open and compressed; twice is once."""
    m = body(name)
    p = m.particles
    logs, w, F, F_old = np.log(p.J), strains(m), p.F.copy(), p.F_old.copy()
    assert min((w > 0).mean(), (w < 0).mean()) > 0.1
    assert m.pooling
    m.pooling.pool(m)
    after = strains(m)
    for cell in np.unique(cells(m)):
        inside = cells(m) == cell
        for one, other in ((logs, np.log(p.J)), (w, after)):
            kept = [(p.V0[inside] * values[inside]).sum() for values in (one, other)]
            assert kept[1] == pytest.approx(kept[0], abs=1e-13 * p.V0.sum())
        if inside.sum() > 1:
            assert not ((after[inside] > 1e-15).any() and (after[inside] < -1e-15).any())
    np.testing.assert_allclose(np.log(p.J) - logs, after - w, atol=1e-14)
    np.testing.assert_allclose(p.F_old / F_old, (p.F / F).reshape(-1, 4), rtol=1e-14)
    assert np.abs(after - w).max() > 1e-3
    sigma, F, taken = p.sigma.copy(), p.F.copy(), m.pooling.taken
    m.pooling.pool(m)
    np.testing.assert_allclose(p.sigma, sigma, rtol=1e-9)
    np.testing.assert_allclose(p.F, F, rtol=1e-12)
    assert m.pooling.taken == pytest.approx(taken, rel=1e-9)


@pytest.mark.parametrize("name", [*SANDS, *OTHERS])
def test_stress_stays_admissible(name: str) -> None:
    """The material's own return finds nothing to do, before and after; a stress a tenth beyond it does see."""
    m = body(name)
    assert excess(m.material, m.particles.sigma) < 1e-12
    before = m.particles.sigma.copy()
    assert m.pooling
    m.pooling.pool(m)
    assert excess(m.material, m.particles.sigma) < 1e-12
    assert np.abs(m.particles.sigma - before).max() > 0.1 * np.abs(before).max()
    pulled = m.particles.sigma + 0.1 * np.abs(before).max() * np.array([1.0, 0.0, 0.0, 0.0])
    assert excess(m.material, pulled) > 1e-3


@pytest.mark.parametrize("name", SANDS[:2])
def test_one_cell_by_hand(name: str) -> None:
    """Four particles, one of them open: the others give it the mean of what its opening leaves them."""
    material: Any = create(MATERIALS, name)
    grid = Grid(1.0, np.zeros(2), np.ones(2))
    p = Cpdi().populate(rectangle(np.zeros(2), np.ones(2), 1.0, 4), material.rho0)
    p.sigma[1:] = -np.array([[3e3, 5e3, 3e3, 0.0], [2e3, 2e3, 2e3, 5e2], [1e3, 2e3, 1e3, 0.0]])
    m = Model(grid, p, Cpdi(), material, box(grid, "roller"), 1e-4, pooling=Pooling())
    k = (1 - 2 * material.nu) / material.E
    compressed = k * 21e3  # sum of three traces, 11 + 6 + 4 kPa
    p.history[0, 2] = 0.25 * compressed
    before = p.sigma.copy()
    assert m.pooling
    m.pooling.pool(m)
    np.testing.assert_allclose(p.sigma[1:], 0.75 * 0.75 * before[1:], rtol=1e-13)  # r = 3/4, and a quarter joined
    np.testing.assert_allclose(p.sigma[0], 0.75 * before.sum(axis=0) / 4, rtol=1e-13)
    assert (p.history[:, 2] == 0).all()
    p.sigma[1:], p.history[0, 2], p.sigma[0] = before[1:], 4 * compressed, 0.0
    m.pooling.pool(m)
    assert not p.sigma.any()
    assert p.history[:, 2].sum() == pytest.approx(3 * compressed)


def test_a_compressed_particle_that_has_void() -> None:
    """What it is compressed by counts, void taken off; it keeps its part of both, and its stress that part."""
    m = body(SANDS[0], ppc=4)
    p = m.particles
    p.x[:] = [5.0, 5.0]  # outside the grid
    p.x[:4] = [[0.51, 0.51], [0.53, 0.55], [0.55, 0.52], [0.58, 0.57]]
    p.sigma[:4], p.history[:4, 2] = -np.array([[0.0], [3e3], [5e3], [8e3]]) * [1.0, 1.0, 1.0, 0.0], 0.0
    assert m.pooling
    assert m.pooling.compression
    held = m.pooling.compression.held(p.sigma)[:4]
    p.history[0, 2], p.history[2, 2] = 0.1 * held.sum(), 0.25 * held[2]
    assert strains(m)[2] < 0
    kept = 1 - p.history[0, 2] / (held.sum() - p.history[2, 2])
    void, sigma, before = p.history[:4, 2].copy(), p.sigma[:4].copy(), strains(m)
    m.pooling.pool(m)
    np.testing.assert_allclose(p.history[1:4, 2], 0.75 * kept * void[1:], rtol=1e-13)
    np.testing.assert_allclose(p.sigma[1:4], 0.75 * kept * sigma[1:], rtol=1e-12)
    assert m.pooling.compression.held(p.sigma)[0] == pytest.approx(kept * (held.sum() - void[2]) / 4, rel=1e-12)
    assert strains(m)[:4].sum() == pytest.approx(before[:4].sum(), rel=1e-12)


@pytest.mark.parametrize("name", [*SANDS, *OTHERS])
def test_stresses_of_a_cell_mix(name: str) -> None:
    """All compressed: means of w, and of stress where moduli are constant, stay; what is beyond them falls by MIXED."""
    m = body(name)
    p, steps = m.particles, APART // 2 - 1
    p.sigma[:] = -np.array([[5e3, 8e3, 6e3, 1e3]]) * np.random.default_rng(2).uniform(0.2, 1, (len(p), 1))
    p.history[:], m.steps = m.material.initial(p.sigma), steps
    sigma, w, logs, own = p.sigma.copy(), strains(m), np.log(p.J), m.pooling and m.pooling.compression
    assert m.pooling
    assert own
    eta = p.history[:, 0].copy()
    m.pooling.pool(m)
    assert m.pooling.crowding.given == 0.0  # the block has room
    for cell in np.unique(cells(m)):
        inside, part = cells(m) == cell, MIXED * ((cells(m) == cell).sum() > 1)
        V = p.V0[inside, None] / p.V0[inside].sum()
        wanted = sigma[inside] + part * ((V * sigma[inside]).sum(axis=0) - sigma[inside])
        strain = w[inside] + part * ((V[:, 0] * w[inside]).sum() - w[inside])
        np.testing.assert_allclose(strains(m)[inside], strain, rtol=1e-11)
        scaled = p.sigma[inside, 1:2] / wanted[:, 1:2]  # 1 where moduli are constant
        np.testing.assert_allclose(p.sigma[inside], scaled * wanted, rtol=1e-12)
        if m.material.stored_energy:
            np.testing.assert_allclose(scaled, 1.0, rtol=1e-12)
    np.testing.assert_allclose(np.log(p.J) - logs, strains(m) - w, atol=1e-14)
    assert np.abs(p.sigma - sigma).max() > 50.0
    assert m.pooling.taken > 0
    assert excess(m.material, p.sigma) < 1e-12
    if "eta_m" in m.material.memory:
        assert (p.history[:, 0] >= eta).all()


def test_what_is_of_one_sign_or_alone_stays() -> None:
    """Bits stay where all are compressed, all open, one particle in a cell."""
    for name, ppc, opened in ((SANDS[0], 9, 0.0), (SANDS[0], 1, 0.3)):
        m = body(name, opened, ppc)
        if ppc == 1:
            m.particles.x = m.particles.X.copy()
        kept = [values.copy() for values in (m.particles.sigma, m.particles.F, m.particles.history)]
        assert m.pooling
        m.pooling.pool(m)
        for one, other in zip(kept, (m.particles.sigma, m.particles.F, m.particles.history), strict=True):
            np.testing.assert_array_equal(other, one)
        assert m.pooling.taken == 0.0


@pytest.mark.parametrize("name", [*SANDS, *OTHERS])
def test_energy_falls_and_is_counted(name: str) -> None:
    """The elastic energy that is gone, by the material's own formula where it has one, is what was counted."""
    m = body(name)
    p, stored = m.particles, m.material.stored_energy
    before = (p.V0 * p.J * stored(p.sigma)).sum() if stored else 0.0
    assert m.pooling
    m.pooling.pool(m)
    assert m.pooling.taken > 0
    if stored:
        after = (p.V0 * p.J * stored(p.sigma)).sum()
        assert m.pooling.taken == pytest.approx(before - after, rel=1e-9)
        assert m.pooling.taken > 0.05 * before


@pytest.mark.parametrize(
    ("ne", "me"), [(0.0, 0.0), (0.4, 0.4), (0.7, 0.7), (1.0, 1.0), (0.4, 0.7), (0.5, 0.5001), (0.8, 0.6), (0.0, 1.0)]
)
def test_compression_of_ubcsand_is_the_integral_of_its_moduli(ne: float, me: float) -> None:
    """Volume and energy by quadrature, the inverse, and the strain that its own kernel takes to get there."""
    sand: Any = create(MATERIALS, f"ubcsand:void=1,ne={ne},me={me}")
    own = sand.compression()

    def stiff(s: float) -> float:
        G, K = sand.moduli(s)
        return float(K + G / 3)

    for s in (3.0, 50.0, 4e3):
        sigma = -np.array([0.7 * s, 1.3 * s, s, 0.2 * s])
        volume = own.volume(own.constants, *sigma[:3])
        kink = [sand.s_min * sand.Pa]
        assert volume == pytest.approx(quad(lambda q: 1 / stiff(q), 0, s, points=kink)[0], rel=1e-7)
        stored = own.stored(own.constants, *sigma)
        assert stored == pytest.approx(quad(lambda q: q / stiff(q), 0, s, points=kink)[0], rel=1e-7)
        scale = own.scale(own.constants, volume, 0.3 * volume)
        assert own.volume(own.constants, *(scale * sigma[:3])) == pytest.approx(0.3 * volume, rel=1e-12)
    sigma, history, steps = -np.array([1e3, 1e3, 1e3, 0.0]), sand.initial(np.zeros((1, 4)))[0], 400
    first = own.volume(own.constants, *sigma[:3])
    for _ in range(steps):
        sand.respond(sand.constants(), sigma, np.array([-1e-5, -1e-5, 0.0]), history)
    assert own.volume(own.constants, *sigma[:3]) - first == pytest.approx(2e-5 * steps, rel=1e-5)


def test_ubcsand_mobilises_what_it_has_and_loads_as_if_new() -> None:
    """eta_m is never below the ratio of the stress; where nothing is left it is forgotten."""
    m = body(SANDS[2])
    assert m.pooling
    m.pooling.pool(m)
    p, sigma = m.particles, m.particles.sigma
    s, t = -(sigma[:, 0] + sigma[:, 1]) / 2, np.hypot((sigma[:, 0] - sigma[:, 1]) / 2, sigma[:, 3])
    carries = s > 0
    assert 0.2 < carries.mean()
    assert (p.history[carries, 0] >= t[carries] / s[carries] - 1e-12).all()


def test_now_and_then_the_cells_are_those_around_the_nodes() -> None:
    """Two that share no cell of the grid and are around one node are pooled in such steps alone, and keep their sum."""
    for steps, pooled in ((0, False), (APART - 1, True), (APART, False)):
        m = body(SANDS[0], ppc=1)
        p = m.particles
        p.x[:] = [0.55, 0.55]
        p.x[:, 0] += 5.0  # outside the grid, where nothing is pooled
        p.x[:2] = [[0.49, 0.5], [0.51, 0.5]]
        p.sigma[0], p.sigma[1], p.history[0, 2], p.history[1, 2] = 0.0, [-4e3, -8e3, -4e3, 0.0], 1e-3, 0.0
        m.steps, before = steps, strains(m)
        assert m.pooling
        m.pooling.pool(m)
        after = strains(m)
        assert (p.history[0, 2] == 0.0) == pooled
        assert (p.sigma[0] != 0.0).any() == pooled
        np.testing.assert_array_equal(after[2:], before[2:])
        assert (p.V0 * after).sum() == pytest.approx((p.V0 * before).sum(), rel=1e-13)


def test_refusals() -> None:
    with pytest.raises(ValueError, match="a material that opens"):
        Pooling().start(create(MATERIALS, "neo_hookean"))


def test_a_column_of_two_powers_runs() -> None:
    run = ColumnRun(material="ubcsand:ne=0.4", cells=2, aspect=2.0, channel=4.0, duration=0.1, ppc=4, pooling=True)
    done = column(run)[0]
    assert done.status == "finished"
    assert done.values["pooled"] > 0.0
    assert done.values["unbalanced"] < 1e-12


# ---- in runs

SMALL = Run(cells=4, aspect=3.5, ppc=4, drop=0.005, duration=0.15, pooling=True)


def fallen(run: Run, mirrored: bool = False) -> Model:
    """The sand after all steps; mirrored from the start."""
    model, steps = setup(run)
    if mirrored:
        model.particles.x[:, 0] = run.width - model.particles.x[:, 0]
        model.slabs.sort(model.grid, model.particles, model.particles.x)
    for _ in range(steps):
        advance(model, no_load)
    return model


def test_any_number_of_threads_gives_the_same_bits() -> None:
    before, ends = numba.get_num_threads(), []
    try:
        for count in (1, 2):
            numba.set_num_threads(count)
            m = fallen(replace(SMALL, cells=10, aspect=1.4, duration=0.06))
            ends.append([m.particles.in_initial_order(name) for name in ("x", "sigma", "F", "history")])
    finally:
        numba.set_num_threads(before)
    for one, other in zip(*ends, strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_mirrored_box_is_the_mirror_image() -> None:
    run = replace(SMALL, duration=0.06)
    one, other = fallen(run), fallen(run, mirrored=True)
    x, image = (m.particles.in_initial_order("x") for m in (one, other))
    np.testing.assert_allclose(image * [-1, 1] + [run.width, 0], x, atol=1e-9)
    assert one.pooling
    assert one.pooling.taken > 0


@pytest.mark.slow
@pytest.mark.parametrize("method", ["cpdi", "gimp", "bspline2", "bspline3", "cpdi2", "mpm"])
def test_every_basis_rests_with_no_open_particles(method: str) -> None:
    """In a smaller box; as shipped a half and more carry nothing, and the sand stands higher."""
    run = Run(method=method, cells=4, aspect=3.5, drop=0.06, duration=0.8)
    with_, without = (execute(replace(run, pooling=pooling))[0] for pooling in (True, False))
    assert (with_.status, without.status) == ("finished", "finished")
    assert with_.values["free"] < 0.02 < 0.4 < without.values["free"]
    assert with_.values["void"] < 1e-3 < 5e-3 < without.values["void"]
    assert with_.values["top"] < without.values["top"] - 0.02


@pytest.mark.slow
def test_the_box_with_pooling_reaches_its_known_end() -> None:
    v = execute(Run(pooling=True, seed=2))[0].values
    assert v["free"] < 0.05
    assert v["void"] < 0.002
    assert v["top"] == pytest.approx(1.0, abs=0.03)
    assert [v[f"weight_{k}"] for k in range(1, ROWS + 1)] == pytest.approx([1.0] * ROWS, abs=0.05)
    assert v["largest"] < 8


@pytest.mark.slow
@pytest.mark.parametrize(("material", "dilates"), [("mohr_coulomb:c=200,psi=0", 0.03), ("ubcsand", 0.01)])
def test_other_soils_rest_in_the_box(material: str, dilates: float) -> None:
    """With cohesion it left the grid, as it did not remember what it had opened; without pooling it swells."""
    v = execute(Run(material=material, duration=1.0))[0].values
    assert v["free"] < 0.01
    assert v["void"] < 1e-3
    assert abs(v["dilated"]) < dilates
    assert v["top"] == pytest.approx(1, abs=0.03)
    assert v["largest"] < 8
    assert 0.4 < v["K_low"] < 0.55
