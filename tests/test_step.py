"""One explicit step: what it reproduces exactly, what it conserves, its walls, and how a run that cannot go on ends."""

from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.mms import execute as mms
from mpm_verify.cases.mms.run import Run
from mpm_verify.solver._jit import BLOCK
from mpm_verify.solver.boundary import box
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.material.neo_hookean import NeoHookean
from mpm_verify.solver.plugins import available, load
from mpm_verify.solver.state import Grid, Particles
from mpm_verify.solver.step import (
    Model,
    Scheme,
    advance,
    check_time_step,
    grid_to_particles,
    particles_to_grid,
)
from mpm_verify.solver.transfers._passes import advect
from mpm_verify.solver.transfers.flip import Flip
from mpm_verify.solver.transfers.pic import Pic

BASES = available("mpm_verify.solver.basis")
LAW = NeoHookean(E=1e3, nu=0.3, rho0=1.0)
SOFT = NeoHookean(E=10.0, nu=0.3, rho0=1.0)  # round-off is not magnified by waves between nodes of hardly any mass
DX, DT = 1 / 16, 1e-4
# cells between a particle and the furthest node it gives to, and how far behind the wall a place can be on the grid
REACH = {"mpm": 1.0, "gimp": 1.5, "cpgimp": 3.0, "cpdi": 1.25, "cpdi2": 1.25, "bspline2": 1.5, "bspline3": 2.0}
REACH["tlmpm"] = 1.0
EDGE = {"mpm": 2.0, "gimp": 1.5, "cpgimp": 0.25, "cpdi": 1.75, "cpdi2": 1.75, "bspline2": 0.5, "bspline3": 0.5}
every_basis = pytest.mark.parametrize("name", BASES)
REFERENCE = [name for name in BASES if load("mpm_verify.solver.basis", name).reference]


def select(p: Particles, keep: Any) -> Particles:
    """A body of some of the particles."""
    return Particles(p.X[keep], p.m[keep], p.V0[keep], p.domain[keep])


def model(
    name: str, keep: Any = None, kind: Any = "roller", dt: float = DT, flip: float = 1.0, law: NeoHookean = LAW
) -> Model:
    """A body in the unit square: the places `keep(X)` chooses, the middle by default, three cells from the walls."""
    grid = Grid(DX, np.zeros(2), np.ones(2))
    basis = load("mpm_verify.solver.basis", name)()
    whole = basis.populate(rectangle(grid.lower, grid.upper, DX, 4), LAW.rho0)
    chosen = keep(whole.X) if keep else (np.abs(whole.X - 0.5) < 5 * DX).all(axis=1)
    body = select(whole, chosen)
    return Model(grid, body, basis, law, box(grid, kind), dt, Scheme(Flip(flip) if flip else Pic()))


def go(m: Model, count: int, load: Any = None) -> None:
    """So many steps."""
    for _ in range(count):
        advance(m, load or still)


def still(p: Particles, t: float) -> None:
    """No body force."""


def free(m: Model) -> Model:
    """The model without walls."""
    m.walls.held[:] = False
    return m


@every_basis
@pytest.mark.parametrize("flip", [0.0, 0.7, 1.0])
@pytest.mark.parametrize("g", [(0.0, 0.0), (4.0, -9.81)])
def test_free_fall(name: str, flip: float, g: tuple[float, float]) -> None:
    """Rigid flight over several cells: v and x of the scheme in closed form, F = I, no stress."""
    m = model(name, lambda X: (np.abs(X - [0.4, 0.6]) < 3 * DX).all(axis=1), dt=2e-3, flip=flip, law=SOFT)
    v0, n, p = np.array([1.3, -0.7]), 60, m.particles
    p.v[:] = v0

    def load_(p: Particles, t: float) -> None:
        p.b[:] = g

    go(m, n, load_)
    step = m.dt**2 * n * (n + 1) / 2  # the sum of dt v over the steps: velocity first, then place
    assert np.abs(p.v - (v0 + n * m.dt * np.array(g))).max() < 1e-9
    assert np.abs(p.x - p.X - (n * m.dt * v0 + step * np.array(g))).max() < 1e-12
    assert np.abs(p.F - np.eye(2)).max() < 1e-9  # round-off is magnified at nodes that a cubic spline hardly reaches
    assert np.abs(p.sigma).max() < 1e-11 * LAW.E
    assert m.time == n * m.dt


def shift(p: Particles, by: Any, rows: Any = ...) -> None:
    """Move particles, and corners of domains with them where those are places."""
    p.x[rows] += by
    if p.domain.shape[1] == 8:
        p.domain[rows] += np.tile(by, 4)


def stir(m: Model, seed: int = 1) -> None:
    """Random velocities, deformations and the stress that belongs to them."""
    rng, p = np.random.default_rng(seed), m.particles
    shift(p, 0.3 * DX * rng.uniform(-1, 1, p.x.shape))
    p.v[:] = rng.standard_normal(p.v.shape)
    p.F += 0.1 * rng.standard_normal(p.F.shape)
    p.m *= rng.uniform(0.5, 2, len(p))
    LAW.update(p, 0.0)


@every_basis
@pytest.mark.parametrize("flip", [0.0, 0.3, 1.0])
def test_mass_and_momentum(name: str, flip: float) -> None:
    """Internal forces cancel: the grid and, a step later, the particles hold all momentum and what the load adds."""
    m = model(name, flip=flip)
    stir(m)
    p, g = m.particles, m.grid
    p.b[:] = (3.0, -2.0)
    before = p.m @ p.v
    advance(m, still)
    scale = p.m.sum()
    assert g.mass.sum() == pytest.approx(p.m.sum(), rel=1e-13)
    np.testing.assert_allclose(g.momentum.sum(axis=0), before, atol=1e-13 * scale)
    assert np.abs(g.force).max() > 100 * np.abs(g.force.sum(axis=0)).max() / len(p)  # it is not that nothing acts
    np.testing.assert_allclose(g.force.sum(axis=0), p.m @ p.b, atol=1e-13 * np.abs(g.force).sum())
    np.testing.assert_allclose(p.m @ p.v, before + m.dt * (p.m @ p.b), atol=1e-12 * scale)


@every_basis
def test_grid_sums_against_plain_numpy(name: str) -> None:
    """Mass, momentum and force of a random state, particle by particle with the weights of one."""
    m = model(name)
    stir(m)
    p, g, K = m.particles, m.grid, m.basis.support
    p.b[:] = np.random.default_rng(2).standard_normal(p.b.shape)
    particles_to_grid(m)
    mass, momentum, force = np.zeros(len(g.mass)), np.zeros((len(g.mass), 2)), np.zeros((len(g.mass), 2))
    for q in range(len(p)):
        table, node = np.empty(3 * K * BLOCK), np.empty(K * BLOCK, np.int64)
        whole = (0.0, g.nx - 1.0, 0.0, g.ny - 1.0)
        m.basis.fill(p.x[q], p.F[q].ravel(), p.domain[q], *g.origin, 1 / g.dx, g.nx, g.ny, *whole, table, node)
        N, gx, gy = table.reshape(3, K, BLOCK)[:, :, 0]
        i, (xx, yy, _, xy) = node.reshape(K, BLOCK)[:, 0], p.sigma[q]
        V = np.linalg.det(p.F[q]) * p.V0[q]
        np.add.at(mass, i, N * p.m[q])
        np.add.at(momentum, i, np.outer(N, p.m[q] * p.v[q]))
        np.add.at(force, i, np.outer(N, p.m[q] * p.b[q]) - V * np.stack([xx * gx + xy * gy, xy * gx + yy * gy], -1))
    for mine, theirs in ((g.mass, mass), (g.momentum, momentum), (g.force, force)):
        np.testing.assert_allclose(mine, theirs, atol=1e-13 * np.abs(theirs).max(), rtol=0)


F0 = np.array([[1.1, 0.25], [-0.15, 0.9]])
L0 = np.array([[3.0, -7.0], [11.0, 5.0]])
V0 = np.array([0.4, -0.9])


@every_basis
def test_affine_grid_velocity(name: str) -> None:
    """From strained particles at random places: L, x, v and F to round-off, whatever the basis."""
    m = model(name, dt=1e-3, flip=0.25)
    stir(m)
    p, nodes = m.particles, m.grid.nodes
    x, v, F, at = p.x.copy(), p.v.copy(), p.F.copy(), m.basis.on_grid(p).copy()
    m.grid.velocity[:] = V0 + nodes @ L0.T
    m.grid.acceleration[:] = (2.0, -3.0)
    grid_to_particles(m)
    there = V0 + at @ L0.T
    np.testing.assert_allclose(p.x, x + m.dt * there, atol=1e-13, rtol=0)
    np.testing.assert_allclose(p.v, 0.25 * (v + m.dt * np.array([2.0, -3.0])) + 0.75 * there, atol=1e-12, rtol=0)
    rate = L0 if m.basis.reference else L0 @ F  # dF/dt is the gradient by X
    np.testing.assert_allclose(p.F, F + m.dt * rate, atol=1e-12, rtol=0)


@every_basis
def test_affine_body(name: str) -> None:
    """A whole step of a strained body that moves affinely: exact wherever all cells around are full.

    The layout is symmetric about each inner node, so uniform stress gives no force there, and the mean velocity of
    its particles is that of the node.
    """
    m = model(name, lambda X: (np.abs(X - 0.5) < 6 * DX).all(axis=1), dt=1e-3)
    p = m.particles
    p.F[:] = F0
    p.v[:] = V0 + (p.x - 0.5) @ (L0 @ F0 if m.basis.reference else L0).T  # of nodes that F0 has moved, or not
    LAW.update(p, 0.0)
    sigma, v, x = p.sigma[0].copy(), p.v.copy(), p.x.copy()
    assert np.abs(sigma).min() > 0.01 * LAW.E
    advance(m, still)
    inner = (np.abs(p.X - 0.5) < 3 * DX).all(axis=1)
    F1 = (np.eye(2) + m.dt * L0) @ F0
    np.testing.assert_allclose(p.F[inner], np.broadcast_to(F1, (inner.sum(), 2, 2)), atol=1e-13, rtol=0)
    np.testing.assert_allclose(p.x[inner], (x + m.dt * v)[inner], atol=1e-14, rtol=0)
    np.testing.assert_allclose(p.v[inner], v[inner], atol=1e-11, rtol=0)
    J = np.linalg.det(F1)
    full = (LAW.mu * (F1 @ F1.T - np.eye(2)) + LAW.lam * np.log(J) * np.eye(2)) / J
    zz = LAW.lam * np.log(J) / J
    expected = [full[0, 0], full[1, 1], zz, full[0, 1]]
    np.testing.assert_allclose(p.sigma[inner], np.tile(expected, (inner.sum(), 1)), rtol=1e-11)
    assert np.linalg.det(p.F[inner]) @ p.V0[inner] == pytest.approx(J * p.V0[inner].sum(), rel=1e-12)
    assert np.abs(p.F[~inner] - F1).max() > 1e-4  # near the free edge it is not exact: the check can fail


@every_basis
@pytest.mark.parametrize(("steps", "grown"), [(100, 2.5e-2), (1000, 2.5e-3)])
def test_pure_rotation_inflates_f(name: str, steps: int, grown: float) -> None:
    """(I + dt L) F with skew L: det F grows by 1 + w^2 dt^2 a step, and the radius by its root."""
    m = model(name, lambda X: (np.abs(X - 0.5) < DX).all(axis=1), dt=1.0 / steps)
    p, w = m.particles, np.pi / 2
    skew = w * np.array([[0.0, -1.0], [1.0, 0.0]])
    for _ in range(steps):
        turned = p.F[0] if m.basis.reference else np.eye(2)  # where the nodes are
        m.grid.velocity[:] = (m.grid.nodes - 0.5) @ turned.T @ skew.T
        grid_to_particles(m)
    factor = (1 + (w * m.dt) ** 2) ** steps
    np.testing.assert_allclose(np.linalg.det(p.F), factor, rtol=1e-11)
    np.testing.assert_allclose(p.F, np.broadcast_to(np.linalg.matrix_power(np.eye(2) + m.dt * skew, steps), p.F.shape),
                               atol=1e-11)  # fmt: skip
    radius = np.linalg.norm(p.x - 0.5, axis=1) / np.linalg.norm(p.X - 0.5, axis=1)
    np.testing.assert_allclose(radius, np.sqrt(factor), rtol=1e-11)
    assert factor - 1 == pytest.approx(grown, rel=0.02)


@pytest.mark.parametrize("stress", ["usl", "musl"])
def test_the_exponential_update(stress: str) -> None:
    """det F grows by 1 + (w dt)^4/4 a step of a rotation, order 2 to exp(t L), and det F stays above zero."""
    errors = []
    for steps in (25, 50, 100):
        m = model("mpm", lambda X: (np.abs(X - 0.5) < DX).all(axis=1), dt=1.0 / steps)
        m.scheme = Scheme(deformation="exponential", stress=stress)
        w, p = np.pi / 2, m.particles
        for _ in range(steps):
            if stress == "usl":
                m.grid.velocity[:] = (m.grid.nodes - 0.5) @ [[0, w], [-w, 0]]
                grid_to_particles(m)
            else:
                motion = np.c_[(m.grid.nodes - 0.5) @ [[0, w], [-w, 0]], np.zeros((len(m.grid.nodes), 2))]
                advect(m, motion, motion, m.scheme.half(m.dt))
        np.testing.assert_allclose(np.linalg.det(p.F), (1 + (w * m.dt) ** 4 / 4) ** steps, rtol=1e-11)
        errors.append(np.abs(p.F[0] - [[0, -1], [1, 0]]).max())
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2, atol=0.05)
    for deformation, J in (("exponential", 0.505), ("linear", -0.1)):  # a step that compresses by 1.1
        m = model("mpm", lambda X: (np.abs(X - 0.5) < DX).all(axis=1), dt=1.0)
        m.scheme = Scheme(deformation=deformation)  # type: ignore[arg-type]
        m.grid.velocity[:, 0] = -1.1 * (m.grid.nodes[:, 0] - 0.5)
        if J > 0:
            grid_to_particles(m)
            np.testing.assert_allclose(np.linalg.det(m.particles.F), J, rtol=1e-12)
        else:
            with pytest.raises(RunFailed, match="inverted"):
                grid_to_particles(m)


def test_an_unknown_deformation() -> None:
    with pytest.raises(ValueError, match="choose from linear, exponential"):
        Scheme(deformation="cubic")  # type: ignore[arg-type]


@pytest.mark.parametrize("stops", [False, True])
def test_a_body_that_strikes_a_floor(stops: bool) -> None:
    """With `stops` the particles lose what the wall's impulse is, to the bit of the sums; without it they keep it."""
    m = model("cpdi", lambda X: (X[:, 1] < 4 * DX) & (np.abs(X[:, 0] - 0.5) < 4 * DX), "fixed", law=SOFT)
    m.walls.stops = stops
    p, g = m.particles, m.grid
    p.v[:, 1] = -1.0
    advance(m, still)
    bottom = p.x[:, 1] < 0.5 * DX
    if stops:
        held = m.walls.held[:, 1]
        impulse = -g.momentum[held, 1].sum()
        assert p.m @ (p.v[:, 1] + 1.0) == pytest.approx(impulse, rel=1e-12)
        assert np.abs(p.v[bottom, 1]).max() < 0.3
    else:
        np.testing.assert_allclose(p.v[:, 1], -1.0, atol=1e-6)


@pytest.mark.parametrize("kind", ["roller", "fixed"])
def test_box_holds_nodes_on_and_behind_the_wall(kind: Any) -> None:
    grid = Grid(0.1, np.array([-0.3, 0.2]), np.array([0.4, 0.7]))
    walls = box(grid, kind)
    assert walls.held.shape == walls.value.shape == (12 * 10, 2)
    assert not walls.value.any()
    for i in range(12):
        for j in range(10):  # two ghost cells: the walls are the nodes 2 and 9 in x, 2 and 7 in y
            across, along = i <= 2 or i >= 9, j <= 2 or j >= 7
            expected = (across or along,) * 2 if kind == "fixed" else (across, along)
            assert tuple(walls.held[i * 10 + j]) == expected


def test_an_unknown_wall() -> None:
    with pytest.raises(ValueError, match="choose from roller, fixed"):
        box(Grid(0.1, np.zeros(2), np.ones(2)), "rubber")  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", ["roller", "fixed"])
@every_basis
def test_walls_hold(name: str, kind: Any) -> None:
    """A body pressed into a corner: held components vanish at the wall and behind it, the others do not."""
    m = model(name, lambda X: (X < 4 * DX).all(axis=1), kind)
    p = m.particles
    p.v[:] = (-1.0, -0.5)
    p.F[:, 0, 0] = p.F[:, 1, 1] = 3.0  # corners of domains that follow F reach behind the walls
    advance(m, lambda p, t: p.b.fill(-500.0))  # a wall takes the force too: FLIP must not hand it on
    g, held = m.grid, m.walls.held
    assert (g.velocity[held] == 0).all()
    assert (g.acceleration[held] == 0).all()
    assert np.abs(g.force[held]).max() > 0.1
    free_ = ~held & (g.mass > 1e-9)[:, None]
    assert np.abs(g.velocity[free_]).min() > 0.1
    behind = (g.nodes < -0.5 * DX).any(axis=1)
    assert (g.mass[behind].sum() > 0) == (name in ("cpdi", "cpgimp"))
    if kind == "roller":
        wall = np.isclose(g.nodes[:, 0], 0) & (g.nodes[:, 1] > 0.5 * DX) & (g.mass > 1e-9)
        np.testing.assert_allclose(g.velocity[wall], np.tile([0, -0.5 - 500 * DT], (wall.sum(), 1)), atol=1e-9)


@every_basis
def test_a_moving_wall(name: str) -> None:
    """Held nodes have the velocity and the acceleration of the wall, whatever the particles do; so do those with it."""
    m = model(name, flip=1.0)
    stir(m)
    m.walls.held[:], m.walls.value[:], m.walls.rate[:] = True, (0.3, -0.2), (40.0, 70.0)
    x, v = m.particles.x.copy(), m.particles.v.copy()
    advance(m, still)
    np.testing.assert_allclose(m.particles.x, x + m.dt * np.array([0.3, -0.2]), atol=1e-15)
    np.testing.assert_allclose(m.particles.v, v + m.dt * np.array([40.0, 70.0]), atol=1e-14)


@every_basis
def test_corners_behind_a_wall_count(name: str) -> None:
    """Mass of domains that reach behind a wall is not lost."""
    m = model(name, lambda X: (X[:, 0] < DX) & (np.abs(X[:, 1] - 0.5) < DX))
    m.particles.F[:, 0, 0] = 3.5
    particles_to_grid(m)
    assert m.grid.mass.sum() == pytest.approx(m.particles.m.sum(), rel=1e-13)


@every_basis
def test_flip_and_pic(name: str) -> None:
    """Without forces FLIP keeps each velocity to the bit, PIC takes a mean of neighbours, a share lies between."""
    after = {}
    for flip in (0.0, 0.4, 1.0):
        m = model(name, flip=flip)
        m.particles.v[:] = before = np.random.default_rng(3).standard_normal((len(m.particles), 2))
        advance(m, still)
        after[flip] = m.particles.v
    np.testing.assert_array_equal(after[1.0], before)
    np.testing.assert_allclose(after[0.4], 0.4 * before + 0.6 * after[0.0], atol=1e-14)
    assert after[0.0].std() < 0.7 * before.std()


@pytest.mark.parametrize("fraction", [-0.1, 0.0, 1.1, np.nan])
def test_a_flip_that_is_no_fraction(fraction: float) -> None:
    with pytest.raises(ValueError, match="above 0 and up to 1"):
        Flip(fraction)


def test_an_unknown_stress_update() -> None:
    with pytest.raises(ValueError, match="choose from usl, musl, usf"):
        Scheme(stress="last")


def swing(name: str, turn: Any) -> Model:
    """A body in a corner with a smooth velocity field, 90 steps with the walls in play; `turn` maps places."""
    m = model(name, kind="fixed", dt=2e-3, law=SOFT)
    matrix, p = turn, m.particles
    X = p.X - 0.5
    moved = X @ matrix.T
    first = (moved[:, 0] < 0.2) & (moved[:, 1] < 0.1)  # no symmetry of its own
    m.particles = p = select(p, first)
    moved = moved[first]
    p.v[:] = np.stack([-1.5 - moved[:, 1] + moved[:, 0] ** 2, 0.7 + moved[:, 0] * moved[:, 1]], -1) @ matrix
    m = Model(m.grid, p, m.basis, SOFT, m.walls, m.dt)
    go(m, 90)
    return m


@every_basis
@pytest.mark.parametrize(
    "turn",
    [[[-1, 0], [0, 1]], [[1, 0], [0, -1]], [[0, -1], [1, 0]], [[0, 1], [1, 0]]],
    ids=["x", "y", "90", "diagonal"],
)
def test_symmetry(name: str, turn: Any) -> None:
    """Mirrored or turned by 90 degrees, the run is the same to round-off, wall and cell crossings included."""
    Q = np.array(turn, dtype=float)
    plain, turned = swing(name, np.eye(2)), swing(name, Q)
    a, b = plain.particles, turned.particles
    assert np.abs(a.x - a.X).max() > 2 * DX
    assert np.abs(a.x[:, 0]).min() < 2 * DX  # the wall has been reached
    place = np.round((a.X - 0.5) * 64).astype(int)
    image = np.round((b.X - 0.5) @ Q.T * 64).astype(int)
    match = np.lexsort(place.T), np.lexsort(image.T)
    np.testing.assert_array_equal(place[match[0]], image[match[1]])
    np.testing.assert_allclose((b.x[match[1]] - 0.5) @ Q.T, a.x[match[0]] - 0.5, atol=1e-11)
    np.testing.assert_allclose(b.v[match[1]] @ Q.T, a.v[match[0]], atol=1e-8)
    np.testing.assert_allclose(Q @ b.F[match[1]] @ Q.T, a.F[match[0]], atol=1e-9)


def two_bodies(name: str) -> tuple[Model, Any]:
    """Two blocks far from each other, presented in a shuffled order; the rows of the right one in that order."""
    left = lambda X: (np.abs(X - [3.5 * DX, 0.5]) < [2 * DX, 3 * DX]).all(axis=1)  # noqa: E731
    right = lambda X: (np.abs(X - [12 * DX, 0.5]) < [2 * DX, 3 * DX]).all(axis=1)  # noqa: E731
    m = model(name, lambda X: left(X) | right(X), dt=1e-3)
    shuffled = select(m.particles, np.random.default_rng(5).permutation(len(m.particles)))
    rows = np.flatnonzero(shuffled.X[:, 0] > 0.5)
    return Model(m.grid, shuffled, m.basis, LAW, m.walls, m.dt), rows


def known(name: str) -> None:
    """A basis that was dropped in has no entry in the tables above: the test is skipped, and says what to write."""
    if name not in (*EDGE, *REFERENCE) or name not in REACH:
        pytest.skip(f"write in EDGE and REACH how far {name} reaches")


def row_of(m: Model, particle: int) -> int:
    return int(np.flatnonzero(m.particles.id == particle)[0])


@every_basis
def test_leaving_the_grid(name: str) -> None:
    known(name)
    m, rows = two_bodies(name)
    free(m).particles.v[np.isin(m.particles.id, rows)] = (20.0, 0.0)
    if name in REFERENCE:  # no x is outside of the reference configuration
        go(m, 100)
        assert m.particles.x[:, 0].max() > 2.0
        return
    X = m.particles.in_initial_order("X").copy()
    with pytest.raises(RunFailed, match="outside_grid") as caught:
        go(m, 100)
    failed = caught.value.failure
    assert X[failed.particle, 0] == X[:, 0].max()  # the foremost column of the right body
    beyond = 1 + EDGE[name] * DX - X[failed.particle, 0]
    assert failed.step == m.steps == np.ceil(beyond / 0.02 - 1e-9)
    x = m.particles.x[row_of(m, failed.particle)]
    assert failed.cell == tuple(np.floor(x / DX).astype(int))


@every_basis
def test_inverted(name: str) -> None:
    """dt times the rate of compression above one turns F inside out: the particle that is named has det F <= 0."""
    m, rows = two_bodies(name)
    p, mine = m.particles, np.isin(m.particles.id, rows)
    p.v[mine, 0] = -1500 * (p.x[mine, 0] - 12 * DX)
    with pytest.raises(RunFailed, match="inverted") as caught:
        advance(m, still)
    failed = caught.value.failure
    assert failed.step == 0
    assert failed.particle in rows
    assert np.linalg.det(m.particles.F[row_of(m, failed.particle)]) <= 0
    at = m.basis.on_grid(m.particles)[row_of(m, failed.particle)]
    assert failed.cell == tuple(np.floor(at / DX).astype(int))


@every_basis
def test_nan_velocity(name: str) -> None:
    """One NaN poisons the nodes around it; the particle named is the one it came from or one next to it."""
    known(name)
    m, rows = two_bodies(name)
    X, start = m.particles.in_initial_order("X").copy(), rows[7]
    go(m, 3)
    m.particles.v[row_of(m, start), 1] = np.nan
    with pytest.raises(RunFailed, match="not_finite") as caught:
        advance(m, still)
    assert caught.value.failure.step == 3
    assert np.abs(X[caught.value.failure.particle] - X[start]).max() < 2 * REACH[name] * DX


@every_basis
@pytest.mark.parametrize("array", ["x", "F", "sigma"])
def test_nan_state(name: str, array: str) -> None:
    m, rows = two_bodies(name)
    row = row_of(m, rows[3])
    getattr(m.particles, array)[row].flat[0] = np.nan
    if array == "x":
        shift(m.particles, [np.nan, 0.0], row)
    with pytest.raises(RunFailed):
        go(m, 2)


@pytest.mark.parametrize("entries", [(1e200, 0, 0, 1e200), (np.inf, 0, 0, 1), (1e200, 1e200, 1e200, 1e200)])
def test_det_f_overflows(entries: Any) -> None:
    """Not a number, or none that can be held: a failed run, and no warning on the way."""
    m = model("mpm")
    m.particles.F[3] = np.reshape(entries, (2, 2))
    with pytest.raises(RunFailed) as caught:
        grid_to_particles(m)
    assert caught.value.failure.particle == m.particles.id[3]


def test_det_f_of_round_off() -> None:
    """A determinant may be below zero by one formula and above it by another: that run ends as the others do."""
    rng = np.random.default_rng(0)
    F = rng.uniform(0.1, 1, (20000, 2, 1)) * rng.uniform(0.1, 1, (20000, 1, 2))  # singular but for rounding
    J = F[:, 0, 0] * F[:, 1, 1] - F[:, 0, 1] * F[:, 1, 0]
    doubtful = F[(J <= 0) & (np.linalg.det(F) > 0)]
    assert len(doubtful) > 0
    m = model("mpm")
    m.particles.F[3] = doubtful[0]
    with pytest.raises(RunFailed, match="inverted") as caught:
        grid_to_particles(m)  # the grid is at rest: F stays
    assert caught.value.failure.particle == m.particles.id[3]


@pytest.mark.parametrize("speed", [0.0, 30.0])
def test_the_time_step_limit(speed: float) -> None:
    """dx / (c + |v|), with |v| of the fastest particle."""
    m = model("cpdi")
    m.particles.v[5] = (0.6 * speed, -0.8 * speed)
    limit = DX / (LAW.wave_speed() + speed)
    m.dt = 0.999 * limit
    check_time_step(m)
    m.dt = 1.001 * limit
    with pytest.raises(RunFailed, match="unstable_step") as caught:
        check_time_step(m)
    assert (caught.value.failure.step, caught.value.failure.particle, caught.value.failure.cell) == (0, -1, None)
    assert caught.value.failure.numbers == {"dt": m.dt, "limit": pytest.approx(limit, rel=1e-12)}


def run(**changes: Any) -> Run:
    return Run(**{"method": "cpdi", "solution": "axis_aligned", "material": "neo_hookean", "cells": 8, "ppc": 4,
                  "courant": 0.4, **changes})  # fmt: skip


def test_a_time_step_above_the_limit_is_a_failed_result() -> None:
    result, arrays = mms.execute(run(courant=0.8))
    assert result.status == "failed"
    assert result.failure is not None
    assert result.failure.kind is FailureKind.UNSTABLE_STEP
    assert (result.failure.step, result.failure.particle, result.steps) == (0, -1, 0)
    assert result.errors == {}
    assert set(arrays) == {"X", "x", "F", "corners", "error_u"}


def test_force_runs_a_time_step_above_the_limit() -> None:
    result, _ = mms.execute(run(courant=0.8, force=True))
    assert result.status == "finished"
    assert result.steps == 20
    assert result.errors["u"]["rms"] < 0.01


def test_det_f_is_a_failed_result() -> None:
    """Classical MPM with one particle a cell, as in the table of docs/results.md."""
    result, arrays = mms.execute(run(method="mpm", cells=16, ppc=1))
    assert (result.status, result.errors) == ("failed", {})
    failure = result.failure
    assert failure is not None
    assert failure.kind is FailureKind.INVERTED
    assert failure.step == result.steps < 80
    assert 0 <= failure.particle < 256
    F = arrays["F"][failure.particle]  # arrays are in the initial order, and so is the particle's number
    assert F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0] <= 0
    assert failure.cell == tuple(np.floor(arrays["x"][failure.particle] * 16).astype(int))


def nan_velocity(m: Model) -> None:
    m.particles.v[17, 0] = np.nan


def off_the_grid(m: Model) -> None:
    shift(m.particles, [-10.0, -10.0], 17)


@pytest.mark.parametrize(
    ("plant", "kind"), [(nan_velocity, FailureKind.NOT_FINITE), (off_the_grid, FailureKind.OUTSIDE_GRID)]
)
@every_basis
def test_other_failures_are_results(name: str, plant: Any, kind: FailureKind, monkeypatch: pytest.MonkeyPatch) -> None:
    original = mms.setup

    def setup(run: Run) -> Any:
        m, comparison, steps = original(run)
        plant(m)
        return m, comparison, steps

    monkeypatch.setattr(mms, "setup", setup)
    result, _ = mms.execute(run(method=name))
    if name in REFERENCE and plant is off_the_grid:  # there is no such thing
        assert result.status == "finished"
        return
    assert result.status == "failed"
    assert result.failure is not None
    assert result.failure.kind is kind
    assert result.failure.particle >= 0
    assert result.failure.step == result.steps
