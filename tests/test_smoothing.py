"""Smoothing: what it must leave as it is, adjoint pairs, idempotence, hourglasses, and admissibility."""

from typing import Any

import numpy as np
import pytest

from mpm_verify.solver.basis.cpdi import Cpdi
from mpm_verify.solver.boundary import box
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.material.hypoelastic import Hypoelastic
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb
from mpm_verify.solver.plugins import MATERIALS, SMOOTHINGS, available, create
from mpm_verify.solver.state import Floats, Grid, Particles
from mpm_verify.solver.step import Model, advance

DX = 0.1
KINDS = ["volumetric", "deviatoric", "full:beta=0.9"]
LAW = Hypoelastic(E=1e3, rho0=1.0)


def model(smoothing: str | None, law: Any = LAW, ppc: int = 9, seed: int = 1) -> Model:
    """A block of 5 by 4 cells with particles that have strayed, and volumes that differ."""
    grid = Grid(DX, np.zeros(2), np.array([1.0, 1.0]))
    p = Cpdi().populate(rectangle(np.array([0.2, 0.3]), np.array([0.7, 0.7]), DX, ppc), law.rho0)
    rng = np.random.default_rng(seed)
    p.x += rng.uniform(-0.02, 0.02, p.x.shape)
    p.F[:] = np.eye(2) + rng.uniform(-0.1, 0.1, p.F.shape)
    made = create(SMOOTHINGS, smoothing) if smoothing else None
    return Model(grid, p, Cpdi(), law, box(grid, "roller"), 1e-4, smoothing=made)


def smoothed(m: Model, tensor: Floats) -> Floats:
    assert m.smoothing
    return m.smoothing.smooth(m, m.particles.x, tensor)


def cells(m: Model) -> Any:
    return m.grid.cell(m.particles.x) @ [100, 1]


def volumes(m: Model) -> Floats:
    return np.asarray(m.particles.V0 * np.linalg.det(m.particles.F))


def field(seed: int, m: Model) -> Floats:
    return np.random.default_rng(seed).normal(size=(len(m.particles), 3))


@pytest.mark.parametrize("where", ["cell", "node"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_uniform_field_stays(kind: str, where: str) -> None:
    m = model(f"{kind}{',' if ':' in kind else ':'}where={where}")
    tensor = np.tile([1.0, -2.0, 0.7], (len(m.particles), 1))
    np.testing.assert_allclose(smoothed(m, tensor), tensor, rtol=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_cells_keep_their_means_and_twice_is_once(kind: str) -> None:
    """The mean of each cell by an independent sum; a projector of beta = 1."""
    m = model(kind)
    tensor = field(2, m)
    once = smoothed(m, tensor)
    for cell in np.unique(cells(m)):
        inside = cells(m) == cell
        means = [(volumes(m)[inside, None] * t[inside]).sum(axis=0) for t in (tensor, once)]
        np.testing.assert_allclose(*means, atol=1e-15)
    assert np.abs(once - tensor).max() > 0.5
    if "beta" not in kind:
        np.testing.assert_allclose(smoothed(m, once), once, atol=1e-14)


def test_each_part_leaves_the_other() -> None:
    parts = {}
    for kind in ("volumetric", "deviatoric"):
        m = model(kind)
        tensor = field(3, m)
        change = smoothed(m, tensor) - tensor
        parts[kind] = (
            np.abs(change[:, 0] + change[:, 1]).max(),
            np.abs(np.c_[change[:, 0] - change[:, 1], change[:, 2]]).max(),
        )
    assert parts["volumetric"][1] < 1e-14 < 0.5 < parts["volumetric"][0]
    assert parts["deviatoric"][0] < 1e-14 < 0.5 < parts["deviatoric"][1]


@pytest.mark.parametrize("where", ["cell", "node"])
@pytest.mark.parametrize("kind", KINDS)
def test_adjoint(kind: str, where: str) -> None:
    """sum V sigma~ : D = sum V sigma : D~, to round-off; with unequal weights it is not."""
    m = model(f"{kind}{',' if ':' in kind else ':'}where={where}")
    sigma, D = field(4, m), field(5, m)
    weights = [1.0, 1.0, 2.0]

    def power(a: Floats, b: Floats, V: Floats) -> float:
        return float((V[:, None] * a * b * weights).sum())

    V = volumes(m)
    one, other = power(smoothed(m, sigma), D, V), power(sigma, smoothed(m, D), V)
    scale = power(np.abs(sigma), np.abs(D), V)
    assert abs(one - other) < 1e-13 * scale
    V = m.particles.V0
    assert abs(power(smoothed(m, sigma), D, V) - power(sigma, smoothed(m, D), V)) > 1e-5 * scale


def test_one_particle_in_a_cell_is_its_mean() -> None:
    m = model("full:beta=0.9", ppc=1)
    m.particles.x = m.particles.X.copy()
    tensor = field(6, m)
    np.testing.assert_allclose(smoothed(m, tensor), tensor, atol=1e-14)


@pytest.mark.parametrize(("kind", "left"), [("volumetric", 0.5), ("deviatoric", 0.5), ("full:beta=0.9", 0.1)])
def test_hourglass(kind: str, left: float) -> None:
    """v_x ~ (x - x_c)(y - y_c) on one cell: half of its strain energy is in each part, and both would take it all."""
    grid = Grid(DX, np.zeros(2), np.full(2, DX))
    p = Cpdi().populate(rectangle(np.zeros(2), np.full(2, DX), DX, 9), 1.0)
    m = Model(grid, p, Cpdi(), LAW, box(grid, "free"), 1e-4, smoothing=create(SMOOTHINGS, kind))
    away = p.x - DX / 2
    D = np.stack([away[:, 1], 0 * away[:, 0], away[:, 0] / 2], axis=1)
    rest = smoothed(m, D)
    if kind == "volumetric":
        np.testing.assert_allclose(rest[:, 0], D[:, 0] / 2, atol=1e-15)
    elif kind == "deviatoric":
        np.testing.assert_allclose(rest, np.stack([D[:, 0] / 2, D[:, 0] / 2, 0 * D[:, 0]], axis=1), atol=1e-15)
    else:
        np.testing.assert_allclose(rest, left * D, atol=1e-15)


def test_full_smoothing_of_cells_is_refused() -> None:
    with pytest.raises(ValueError, match="must be below 1 with both parts"):
        create(SMOOTHINGS, "full:beta=1")


def test_nodes_keep_constants_and_not_lines() -> None:
    m = model("volumetric:where=node")
    m.particles.x = m.particles.X.copy()
    m.particles.F[:] = np.eye(2)
    m.particles.F_old[:] = [1, 0, 0, 1]
    tensor = np.zeros((len(m.particles), 3))
    tensor[:, 0] = tensor[:, 1] = m.particles.x[:, 0]
    middle = (np.abs(m.particles.x - [0.45, 0.5]) < 0.11).all(axis=1)
    change = np.abs(smoothed(m, tensor) - tensor)[:, 0] / DX
    assert change[middle].max() < 0.2  # a linear field, far from the edge, up to half a cell's share
    assert change.max() > 0.2


@pytest.mark.parametrize("rate", ["green_naghdi", "jaumann", "logarithmic"])
@pytest.mark.parametrize("kind", ["volumetric", "deviatoric", "fbar", "full:beta=0.5", "deviatoric:into=history"])
def test_a_uniform_motion_is_not_smoothed(kind: str, rate: str) -> None:
    """Strain and turn together, the same in all particles: with smoothing as without, to round-off."""
    ends = []
    for smoothing in (None, kind):
        m = model(smoothing, Hypoelastic(E=1e3, rho0=1.0, rate=rate))
        p = m.particles
        p.F[:], p.F_old[:] = np.eye(2), [1, 0, 0, 1]
        for step in range(20):
            a = 0.05 * (step + 1)
            p.F[:] = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) @ [[1 + a, 0.3 * a], [0, 1 - 0.5 * a]]
            felt = m.smoothing.strain(m, p.x) if m.smoothing else None
            LAW.__class__(E=1e3, rho0=1.0, rate=rate).update(p, 1.0, felt)
        ends.append(p.sigma.copy())
    np.testing.assert_allclose(ends[1], ends[0], rtol=1e-11, atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_the_law_sees_the_smoothed_strain_and_the_spin(kind: str) -> None:
    """From the F that it is given, the step's gradient is smoothed D + W."""
    m = model(kind)
    p = m.particles
    p.F = p.F + 1e-2 * np.random.default_rng(7).normal(size=p.F.shape)
    assert m.smoothing
    felt = m.smoothing.strain(m, p.x)
    F0 = p.F_old.reshape(-1, 2, 2)
    L, L_felt = ((F - F0) @ np.linalg.inv((F + F0) / 2) for F in (p.F, felt))
    D, W = (L + L.transpose(0, 2, 1)) / 2, (L - L.transpose(0, 2, 1)) / 2
    plane = smoothed(m, np.stack([D[:, 0, 0], D[:, 1, 1], D[:, 0, 1]], axis=1))
    want = plane[:, [0, 2, 2, 1]].reshape(-1, 2, 2) + W
    np.testing.assert_allclose(L_felt, want, atol=1e-14)


def test_fbar_has_one_volume_ratio_a_cell() -> None:
    m = model("fbar:where=cell")
    p = m.particles
    p.F = p.F @ (np.eye(2) + 0.05 * np.random.default_rng(8).normal(size=p.F.shape))
    assert m.smoothing
    felt = m.smoothing.strain(m, p.x)
    ratio = np.linalg.det(felt) / np.linalg.det(p.F_old.reshape(-1, 2, 2))
    for cell in np.unique(cells(m)):
        assert np.ptp(ratio[cells(m) == cell]) < 1e-13
    assert np.ptp(ratio) > 1e-2
    angle = lambda F: np.arctan2(F[:, 1, 0] - F[:, 0, 1], F[:, 0, 0] + F[:, 1, 1])  # noqa: E731
    np.testing.assert_allclose(angle(felt), angle(p.F), atol=1e-14)


FUNCTIONS = ("neo_hookean", "hencky")


@pytest.mark.parametrize("where", ["cell", "node"])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_fbar_of_a_function_of_F_projects_the_volume_ratio(name: str, where: str) -> None:
    """F-bar has the mean of det F by initial volumes, the rotation and the stretch ratio of F; beta takes a part."""
    m = model(f"fbar:where={where}", create(MATERIALS, name))
    p = m.particles
    p.F = p.F @ (np.eye(2) + 0.05 * np.random.default_rng(8).normal(size=p.F.shape))
    assert m.smoothing
    seen, J = m.smoothing.strain(m, p.x), np.linalg.det(p.F)
    ratio = np.linalg.det(seen)
    np.testing.assert_allclose(seen / np.sqrt(ratio)[:, None, None], p.F / np.sqrt(J)[:, None, None], atol=1e-14)
    if where == "cell":
        for cell in np.unique(cells(m)):
            inside = cells(m) == cell
            np.testing.assert_allclose(ratio[inside], np.average(J[inside], weights=p.V0[inside]), atol=1e-13)
    assert (p.V0 * ratio).sum() == pytest.approx((p.V0 * J).sum(), rel=1e-13)  # the body keeps its volume
    assert np.abs(ratio - J).max() > 0.02
    half = create(SMOOTHINGS, f"fbar:where={where},beta=0.5").strain(m, p.x)
    np.testing.assert_allclose(np.linalg.det(half), (ratio + J) / 2, atol=1e-13)


@pytest.mark.parametrize("kind", ["fbar", "volumetric", "volumetric:of=rate"])
def test_the_stress_of_a_step_is_that_of_fbar_and_F_stays(kind: str) -> None:
    """After a step sigma is the function of F-bar, and F what the velocities made of it."""
    law: Any = create(MATERIALS, "hencky")
    ends = []
    for smoothing in (None, kind):
        m = model(smoothing, law)
        m.particles.sigma[:] = 0.0
        advance(m, lambda p, t: None)
        ends.append(m)
    plain, smooth = ends
    np.testing.assert_array_equal(smooth.particles.F, plain.particles.F)
    assert smooth.smoothing
    seen = smooth.smoothing.bar(smooth)
    known = Particles(plain.particles.X, plain.particles.m, plain.particles.V0, plain.particles.domain)
    known.F = seen
    law.update(known, 1.0)
    np.testing.assert_array_equal(smooth.particles.sigma, known.sigma)
    assert np.abs(smooth.particles.sigma - plain.particles.sigma).max() > 1e-3 * np.abs(plain.particles.sigma).max()


@pytest.mark.parametrize("kind", ["deviatoric", "full", "full:of=rate", "volumetric:into=history"])
def test_a_function_of_F_has_no_rate_to_smooth(kind: str) -> None:
    with pytest.raises(ValueError, match="take fbar, volumetric, or deviatoric:of=stress"):
        create(SMOOTHINGS, kind).check(create(MATERIALS, "neo_hookean"))


def outside(sigma: Floats) -> float:
    """Share of stresses (n,3) xx, yy, xy outside the cone of 31 degrees, in the plane."""
    s, t = -(sigma[:, 0] + sigma[:, 1]) / 2, np.hypot((sigma[:, 0] - sigma[:, 1]) / 2, sigma[:, 2])
    return float((t > np.sin(np.radians(31)) * s * (1 + 1e-12)).mean())


def test_admissibility() -> None:
    """Means of whole stresses stay in a convex cone; a part alone leaves it."""
    m = model("volumetric")
    rng, count = np.random.default_rng(9), len(m.particles)
    s = rng.exponential(1.0, count)
    t, angle = s * np.sin(np.radians(31)) * rng.random(count), rng.uniform(0, np.pi, count)
    sigma = np.stack([-s + t * np.cos(2 * angle), -s - t * np.cos(2 * angle), t * np.sin(2 * angle)], axis=1)
    assert outside(sigma) == 0
    volumetric = outside(smoothed(m, sigma))
    deviatoric = outside(smoothed(model("deviatoric"), sigma))
    m = model("full:beta=0.999999")
    assert outside(smoothed(m, sigma)) == 0
    assert 0.05 < deviatoric < 0.4
    assert 0.05 < volumetric < 0.4


@pytest.mark.parametrize("stress", ["usl", "musl", "usf"])
@pytest.mark.parametrize("kind", ["volumetric", "deviatoric", "full", "fbar"])
def test_it_runs_with_every_order_of_the_step(kind: str, stress: str) -> None:
    """And changes the outcome, of a block that falls on the floor."""
    from mpm_verify.solver.model import Scheme

    ends = []
    for smoothing in (None, kind):
        m = model(smoothing, MohrCoulomb(E=1e4, rho0=1.0))
        m.scheme = Scheme(stress=stress)
        m.particles.v[:] = np.random.default_rng(3).normal(size=m.particles.v.shape)

        def load(p: Any, t: float) -> None:
            p.b[:] = [0, -10]

        for _ in range(20):
            advance(m, load)
        ends.append(m.particles.in_initial_order("x"))
    assert np.isfinite(ends[1]).all()
    assert np.abs(ends[1] - ends[0]).max() > 1e-9


@pytest.mark.parametrize("name", available(SMOOTHINGS))
def test_refusals(name: str) -> None:
    for parameters, says in (
        ("where=edge", "must be one of"),
        ("beta=0", "must lie above 0"),
        ("into=x", "must be one"),
    ):
        with pytest.raises(ValueError, match=says):
            create(SMOOTHINGS, f"{name}:{parameters}")
    with pytest.raises(ValueError, match="must have a material in rate form"):
        model(name, Hypoelastic(rate="truesdell"))
    with pytest.raises(ValueError, match="must be rate"):
        create(SMOOTHINGS, "fbar:of=stress")
