"""Slabs and threads: how particles are shared out changes no bit, and how they are presented none but the last."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
from fixtures_export import PLANE

from mpm_verify.cases.harness.runner import process_pool, run_study
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.mms.execute import setup
from mpm_verify.cases.mms.run import Run
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.boundary import Walls, behind, box, moving
from mpm_verify.solver.energy_budget import Budget
from mpm_verify.solver.failure import RunFailed
from mpm_verify.solver.friction import frictional
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.material.neo_hookean import NeoHookean
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, TRANSFERS, available, create, load
from mpm_verify.solver.pooling import Pooling
from mpm_verify.solver.pushed import pushed
from mpm_verify.solver.slabs import SLAB_COLUMNS, Slabs
from mpm_verify.solver.smoothing.deviatoric import Deviatoric
from mpm_verify.solver.smoothing.fbar import Fbar
from mpm_verify.solver.state import Grid, Particles
from mpm_verify.solver.step import Model, Scheme, advance, particles_to_grid

BASES = available("mpm_verify.solver.basis")
SAND = "mohr_coulomb:E=1,rho0=1,void=1"
LAW = NeoHookean(E=1.0, nu=0.3, rho0=1.0)
ARRAYS = ("X", "x", "v", "F", "sigma", "m", "V0", "domain")
USUAL = Scheme()
every_basis = pytest.mark.parametrize("name", BASES)


def still(p: Particles, t: float) -> None:
    """No body force."""


def rollers(grid: Grid) -> Walls:
    """Walls without friction, at rest."""
    return box(grid, "roller")


def channel(
    name: str, columns: int = 64, rows: int = 12, order: Any = None, scheme: Scheme = USUAL, law: Any = LAW,
    walls: Callable[[Grid], Walls] = rollers, **more: Any,
) -> Model:  # fmt: skip
    """A body of 6 x 6 cells near the left end of a channel with cells of side one, presented in the given order."""
    grid = Grid(1.0, np.zeros(2), np.array([columns, rows], dtype=float))
    basis = load("mpm_verify.solver.basis", name)()
    whole = basis.populate(rectangle(grid.lower, grid.upper, grid.dx, 4), law.rho0)
    keep = np.flatnonzero((np.abs(whole.X - [4, rows / 2]) < 3).all(axis=1))
    keep = keep if order is None else keep[order]
    body = Particles(whole.X[keep], whole.m[keep], whole.V0[keep], whole.domain[keep])
    return Model(grid, body, basis, law, walls(grid), 0.05, scheme, **more)


def fly(m: Model, steps: int) -> Model:
    """Fast to the right, and stirred, so that the body deforms on its way; the walls stand out of its way."""
    p = m.particles
    p.v[:] = np.stack([6 + 0.1 * np.sin(p.X[:, 1]), 0.1 * np.cos(p.X[:, 0])], axis=-1)
    for _ in range(steps):
        advance(m, still)
    return m


@every_basis
def test_order_of_presentation(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Across five slabs: particles shuffled at the start give the same motion to round-off."""
    sorts, sort = [], Slabs.sort
    monkeypatch.setattr(Slabs, "sort", lambda self, *args: sorts.append(0) or sort(self, *args))
    plain = fly(channel(name), 140).particles
    again = not create("mpm_verify.solver.basis", name).reference
    assert len(sorts) >= 5 if again else len(sorts) == 1  # at the start, and again as it moves on the grid
    order = np.random.default_rng(1).permutation(len(plain))
    shuffled = fly(channel(name, order=order), 140).particles
    assert np.ptp(plain.x[:, 0]) < 12
    assert plain.x[:, 0].min() > 5 * SLAB_COLUMNS
    for array in ARRAYS:
        a, b = plain.in_initial_order(array)[order], shuffled.in_initial_order(array)
        np.testing.assert_allclose(b, a, atol=1e-10 * np.abs(a).max(initial=1.0), rtol=0)
    assert np.abs(plain.F - np.eye(2)).max() > 0.05


def rough(grid: Grid) -> Walls:
    """Walls with friction at the bottom and the top."""
    return frictional(grid, ("roller", "roller", 0.3, 0.3))


def squeezed(grid: Grid) -> Walls:
    """Walls whose bottom is pushed up, slower and slower."""
    return pushed(rollers(grid), behind(grid, 2), 1, lambda t: 0.05 * t / (1 + t), rough=True)


def swept(grid: Grid) -> Walls:
    """Walls all of which go to the right, faster and faster."""
    held = rollers(grid).held
    return moving(grid, lambda nodes, t, dt: (held, np.full(nodes.shape, 0.1 * t), np.full(nodes.shape, 0.1)))


def stepped(transfer: str, stress: str) -> Scheme:
    """Scheme of a transfer and a stress update."""
    return Scheme(create(TRANSFERS, transfer), stress)


WINDOWS: dict[str, tuple[str, Callable[[], dict[str, Any]]]] = {  # method, and what its channel has
    **{name: (name, dict) for name in ("mpm", "cpdi", "cpdi2", "bspline3", "tlmpm")},
    "apic musl": ("cpdi", lambda: {"scheme": stepped("apic", "musl")}),
    "fmpm usf": ("mpm", lambda: {"scheme": stepped("fmpm", "usf")}),
    "friction": ("cpdi", lambda: {"rows": 6, "walls": rough}),
    "friction fmpm musl": ("bspline3", lambda: {"rows": 6, "walls": rough, "scheme": stepped("fmpm", "musl")}),
    "pushed": ("cpdi", lambda: {"rows": 6, "walls": squeezed}),
    "moving": ("cpdi2", lambda: {"rows": 6, "walls": swept}),
    "smoothing": ("cpdi", lambda: {"smoothing": Fbar()}),
    "pooling": ("cpdi", lambda: {"law": create(MATERIALS, SAND), "pooling": Pooling()}),
    "pooling smoothing": (
        "cpdi",
        lambda: {"law": create(MATERIALS, SAND), "pooling": Pooling(), "smoothing": Deviatoric()},
    ),
}


@pytest.mark.parametrize("case", WINDOWS)
def test_nodes_that_no_particle_touches(case: str) -> None:
    """A fast body takes its columns of nodes along, also where it is put elsewhere: all nodes give the same bits.

    Arrays of the nodes that it does not touch hold zeros.
    """
    name, options = WINDOWS[case]
    some, every = (channel(name, **options()) for _ in range(2))
    every.slabs.whole = True
    every.slabs.bound(every.grid)
    budgets = [Budget(np.array([0.0, -1.0])) for _ in range(2)]
    for m, budget in zip((some, every), budgets, strict=True):
        m.watch(budget)
        fly(m, 20)
        for shift in (40.0, -20.0, -20.0):
            m.particles.x[:, 0] += shift
            if name == "cpdi2":  # its corners are points of their own
                m.particles.domain[:, ::2] += shift
            for _ in range(5):
                advance(m, still)
            if shift > 0:
                assert alone(m, budget) == (m is some)
    assert alone(some, budgets[0])
    for array in ARRAYS:
        np.testing.assert_array_equal(getattr(some.particles, array), getattr(every.particles, array))
    np.testing.assert_array_equal(some.particles.history, every.particles.history)
    np.testing.assert_array_equal(some.grid.mass, every.grid.mass)
    for array in ("held", "value", "rate"):
        np.testing.assert_array_equal(getattr(some.walls, array), getattr(every.walls, array))
    taken = [sum(getattr(part, "taken", 0.0) for part in (m.walls, m.pooling)) for m in (some, every)]
    assert taken[0] == taken[1]
    assert (taken[0] > 0) == case.startswith(("friction", "pooling"))
    np.testing.assert_array_equal(budgets[0].sums, budgets[1].sums)
    assert (budgets[0].sums != 0).sum() > 5


def alone(m: Model, budget: Budget) -> bool:
    """Whether the nodes that particles can touch are some of all, and whatever is not zero is there."""
    g, inside = m.grid, np.zeros(len(m.grid.mass), bool)
    inside[m.slabs.nodes] = True
    arrays = (g.mass, g.momentum_force, g.velocity_acceleration, budget.after)
    return 0.1 < inside.mean() < 0.6 and all(a[inside].any() and not a[~inside].any() for a in arrays)


@pytest.mark.parametrize("stress", ["usl", "musl", "usf"])
@pytest.mark.parametrize("transfer", available("mpm_verify.solver.transfers"))
def test_order_of_presentation_with_every_transfer(transfer: str, stress: str) -> None:
    """What a transfer keeps of a particle travels with it across the slabs."""
    scheme, order = (
        Scheme(create("mpm_verify.solver.transfers", transfer), stress),
        np.random.default_rng(1).permutation(144),
    )
    plain, shuffled = (fly(channel("cpdi", order=o, scheme=scheme), 140).particles for o in (None, order))
    assert plain.x[:, 0].min() > 5 * SLAB_COLUMNS
    for array in (*ARRAYS, "affine_velocity"):
        a, b = plain.in_initial_order(array)[order], shuffled.in_initial_order(array)
        np.testing.assert_allclose(b, a, atol=1e-10 * np.abs(a).max(initial=1.0), rtol=0)
    assert plain.affine_velocity.any() == (transfer == "apic")


@every_basis
def test_rows_travel_together(name: str) -> None:
    """Whatever the sorting: id is a permutation, and each array is sorted with it, the caller's numbers too."""
    order = np.random.default_rng(2).permutation(144)
    m = channel(name, order=order)
    X = m.particles.in_initial_order("X").copy()
    m.particles.carried = np.concatenate([m.particles.X, m.particles.id[:, None]], axis=1)
    fly(m, 60)
    p = m.particles
    np.testing.assert_array_equal(np.sort(p.id), np.arange(len(p)))
    np.testing.assert_array_equal(p.in_initial_order("X"), X)
    np.testing.assert_array_equal(p.carried, np.concatenate([p.X, p.id[:, None]], axis=1))
    x = m.basis.on_grid(p)
    slab = (np.floor(x[:, 0] - m.grid.origin[0]) // m.slabs.slab_columns).astype(int)
    start = m.slabs.start
    assert start[0] == 0
    assert start[-1] == len(p)
    guard = (m.slabs.slab_columns - 1) // 2
    for s in range(len(start) - 1):  # no particle further from its slab than the guard
        inside = x[start[s] : start[s + 1], 0] - m.grid.origin[0]
        assert (inside >= s * m.slabs.slab_columns - guard).all()
        assert (inside < (s + 1) * m.slabs.slab_columns + guard).all()
    assert slab.max() > 1 or m.basis.reference


def test_sorting_keeps_the_order_within_a_slab() -> None:
    m = channel("mpm")
    grid, p = m.grid, m.particles
    p.x[:, 0] = np.random.default_rng(3).uniform(0, 60, len(p))
    p.id = np.arange(len(p))
    slabs = Slabs()
    slabs.sort(grid, p, p.x)
    for s in range(len(slabs.start) - 1):
        rows = slice(slabs.start[s], slabs.start[s + 1])
        assert (np.floor(p.x[rows, 0] + 2) // SLAB_COLUMNS == s).all()
        assert (np.diff(p.id[rows]) > 0).all()


@pytest.mark.parametrize("half", [0.6, 3.4, 5.2, 17.0, 30.0])
def test_wide_domains_widen_the_slabs(half: float) -> None:
    """CPDI domains of any width that the grid holds: slabs grow, and no mass or momentum is lost."""
    m = channel("cpdi", columns=62)
    p = m.particles
    p.x[:, 0] = np.random.default_rng(4).uniform(half - 1, 63 - half, len(p))
    p.F[:, 0, 0] = half / 0.25
    p.v[:] = np.random.default_rng(5).standard_normal(p.v.shape)
    order, before = np.argsort(p.id), p.v[np.argsort(p.id)].copy()
    particles_to_grid(m)
    assert (m.slabs.slab_columns > SLAB_COLUMNS) == (half > 3)
    g, nodes = m.grid, m.grid.nodes
    assert g.mass.sum() == pytest.approx(p.m.sum(), rel=1e-13)
    np.testing.assert_allclose(g.momentum.sum(axis=0), p.m @ p.v, atol=1e-12)
    np.testing.assert_allclose(g.mass @ nodes, p.m @ p.x, rtol=1e-12)  # N of a basis gives back the centre of mass
    np.testing.assert_array_equal(p.v[np.argsort(p.id)], before)
    assert len(order) == len(p)


def test_a_domain_wider_than_the_grid() -> None:
    m = channel("cpdi")
    m.particles.F[0, 0, 0] = 200.0
    with pytest.raises(RunFailed, match="outside_grid") as caught:
        particles_to_grid(m)
    assert (caught.value.failure.step, caught.value.failure.particle) == (0, 0)


def test_widening_ends() -> None:
    """Slabs are widened seven times at most: a domain of 800 of 1000 columns ends the run, it does not loop."""
    m = channel("cpdi", columns=1100, rows=12)
    m.particles.x[0, 0] = 600.0
    m.particles.F[0, 0, 0] = 1600.0
    with pytest.raises(RunFailed, match="slab"):
        particles_to_grid(m)


def after(method: str, solution: str, threads: int, **scheme: str) -> dict[str, Any]:
    """Bits of a run with 6400 particles, more than one chunk, and of its norms."""
    use_threads(threads)
    assert numba.get_num_threads() == threads
    m, comparison, _ = setup(Run(method, solution, load(SOLUTIONS, solution).material, 40, 4, 0.4, **scheme))
    with suppress(RunFailed):  # classical MPM ends soon on the rings, at the same step
        for _ in range(45):
            advance(m, comparison)
    comparison(m.particles, m.time)
    bits = {
        array: m.particles.in_initial_order(array).tobytes()
        for array in ("x", "v", "F", "sigma", "b", "affine_velocity")
    }
    use_threads(1)
    return bits | {
        "norms": comparison.norms.errors(),
        "width": m.slabs.slab_columns,
        "grid": m.grid.momentum_force.tobytes(),
    }


needs_two = pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="one processor")


@pytest.mark.slow
@needs_two
@pytest.mark.parametrize("solution", PLANE)
@every_basis
def test_threads_give_the_same_bits(name: str, solution: str) -> None:
    assert after(name, solution, 1) == after(name, solution, 2)


@needs_two
@pytest.mark.parametrize("stress", ["usl", "musl", "usf"])
@pytest.mark.parametrize("transfer", available("mpm_verify.solver.transfers"))
def test_threads_give_the_same_bits_with_every_transfer(transfer: str, stress: str) -> None:
    one, two = (after("cpdi", "clamped_shear", threads, transfer=transfer, stress=stress) for threads in (1, 2))
    assert one == two


@needs_two
@every_basis
def test_threads_give_the_same_bits_across_slabs(name: str) -> None:
    """The body crosses slabs, and particles are sorted anew on the way."""
    bits = []
    for threads in (1, 2):
        use_threads(threads)
        p = fly(channel(name), 100).particles
        bits.append([getattr(p, array).tobytes() for array in (*ARRAYS, "id")])
    use_threads(1)
    assert bits[0] == bits[1]


def test_more_threads_than_there_are() -> None:
    use_threads(1000)
    assert numba.get_num_threads() == numba.config.NUMBA_NUM_THREADS
    use_threads(0)
    assert numba.get_num_threads() == 1


@pytest.mark.slow
def test_jobs_and_threads_give_the_same_results(tmp_path: Path) -> None:
    """One worker with one thread against two workers with two threads each."""
    runs = tuple(Run("cpdi", "axis_aligned", "neo_hookean", cells, 4, 0.4) for cells in (8, 12, 16))
    study = Study("jobs", "jobs", "", runs, (), case="mms")
    found = []
    for jobs in (1, 2):
        store = Store(tmp_path / str(jobs))
        store.create(study)
        with process_pool(jobs, "mms") as (pool, _):
            found.append(run_study(study, store, pool, threads=jobs))
        arrays = {run.digest: store.arrays(run.digest) for run in runs}
        found[-1] = {
            digest: (result.errors, {k: a.tobytes() for k, a in arrays[digest].items()})
            for digest, result in found[-1].items()
        }
    assert len(found[0]) == 3
    assert found[0] == found[1]
