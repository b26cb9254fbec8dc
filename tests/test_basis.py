"""Shape functions through the compiled fill of each basis: identities, an independent implementation, the box."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BSpline

from mpm_verify.solver._jit import BLOCK
from mpm_verify.solver.layout import SIDES, Layout, rectangle
from mpm_verify.solver.plugins import available, create
from mpm_verify.solver.state import PAD, Floats, Grid

LIMITED = "cpdi:limit=0.45"  # half diagonals are 0.35 cells before they deform
BASES = [*available("mpm_verify.solver.basis"), LIMITED]
DX, NX, NY, ORIGIN = 0.13, 23, 19, np.array([-0.7, 0.4])  # nothing square, nothing at zero
EXACT = 1e-13
KINDS = {name: ["near I", "far from I"] for name in BASES}
KINDS["cpgimp"] = ["near I"]  # turned by a right angle, its domain has no width
EACH = [(name, kind) for name in BASES for kind in KINDS[name]]


@dataclass
class Table:
    """What a fill wrote, as (n, K) arrays; dN (n, K, 2)."""

    ok: bool
    node: Any
    N: Floats
    dN: Floats


def fill(name: str, x: Floats, F: Floats, r0: Floats, box: Any = (0.0, NX - 1.0, 0.0, NY - 1.0)) -> Table:
    """Call the kernel of basis `name` on up to BLOCK particles, and unpack the layout of solver/weights.py."""
    basis, n = create("mpm_verify.solver.basis", name), len(x)
    K, domain = basis.support, basis.domain(*bodies(x, F, r0))
    table, node = np.full(3 * K * BLOCK, -7.0), np.full(K * BLOCK, -7, np.int64)
    ok = basis.fill(x.ravel(), F.ravel(), domain.ravel(), *ORIGIN, 1 / DX, NX, NY, *map(float, box), table, node)
    N, gx, gy = table.reshape(3, K, BLOCK)[:, :, :n].transpose(0, 2, 1)
    return Table(ok, node.reshape(K, BLOCK)[:, :n].T, N, np.stack([gx, gy], axis=-1))


def bodies(x: Floats, F: Floats, r0: Floats) -> tuple[Layout, Any]:
    """A layout with domains r0 around x, and the map that deforms each by its F."""

    def place(places: Floats) -> Floats:
        with np.errstate(invalid="ignore"):  # of places that are not finite
            apart = places.reshape(len(x), -1, 2) - x[:, None]
            return (x[:, None] + np.einsum("pab,pcb->pca", F, apart)).reshape(-1, 2)

    return Layout(x, 4 * np.linalg.det(r0), r0), place


def particles(rng: np.random.Generator, kind: str, n: int = BLOCK) -> tuple[Floats, Floats, Floats]:
    """Random places two cells from the walls, half sides of a quarter cell, and F near I or far from it."""
    x = ORIGIN + DX * (PAD + 2 + rng.random((n, 2)) * (np.array([NX, NY]) - 2 * PAD - 5))
    r0 = np.tile(0.25 * DX * np.eye(2), (n, 1, 1))
    if kind == "near I":
        return x, np.eye(2) + 0.05 * rng.standard_normal((n, 2, 2)), r0
    turn, shear, stretch = rng.uniform(-np.pi, np.pi, n), rng.uniform(-1, 1, n), rng.uniform(0.5, 2.2, (n, 2))
    c, s = np.cos(turn), np.sin(turn)
    R = np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], -2)
    U = np.stack([np.stack([stretch[:, 0], shear], -1), np.stack([0 * s, stretch[:, 1]], -1)], -2)
    return x, R @ U, r0


def place(node: Any) -> Floats:
    """Places of nodes, (..., 2)."""
    return ORIGIN + DX * np.stack(np.divmod(node, NY), axis=-1)


@pytest.mark.parametrize(("name", "kind"), EACH)
def test_identities(name: str, kind: str) -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        x, F, r0 = particles(rng, kind)
        t = fill(name, x, F, r0)
        assert t.ok
        away = (place(t.node) - x[:, None]) / DX  # in cells from the particle: the scale of the round-off
        if create("mpm_verify.solver.basis", name).reference:
            away = np.einsum("pab,pkb->pka", F, away)  # where F has taken the nodes
        gradient = t.dN * DX
        size = max(1.0, np.abs(gradient).sum(axis=1).max())  # narrow domains have large gradients
        assert np.abs(t.N.sum(axis=1) - 1).max() < EXACT
        assert np.abs(gradient.sum(axis=1)).max() < EXACT * size
        assert np.abs(np.einsum("pk,pka->pa", t.N, away)).max() < EXACT * NX
        L = np.einsum("pkb,pka->pab", gradient, away)
        assert np.abs(L - np.eye(2)).max() < EXACT * size


def hat(x: Floats) -> tuple[Floats, Floats]:
    """Value (NX*NY,) and gradient (NX*NY, 2) at the point x of all bilinear hat functions, one by one."""
    xi = (x - place(np.arange(NX * NY))) / DX
    one = np.maximum(0, 1 - np.abs(xi))
    slope = np.where(np.abs(xi) < 1, -np.sign(xi), 0) / DX
    return one[:, 0] * one[:, 1], np.stack([slope[:, 0] * one[:, 1], one[:, 0] * slope[:, 1]], axis=-1)


def reference_mpm(x: Floats, F: Floats, r0: Floats) -> tuple[Floats, Floats]:
    return hat(x)


def reference_tlmpm(x: Floats, F: Floats, r0: Floats) -> tuple[Floats, Floats]:
    """Hat functions at X, gradients by x: dN/dx = dN/dX F^-1."""
    N, dN = hat(x)
    return N, dN @ np.linalg.inv(F)


def reference_gimp(x: Floats, F: Floats, r0: Floats) -> tuple[Floats, Floats]:
    """Piecewise, as printed by Bardenhagen & Kober; half length l <= half a cell, gradient by its definition."""
    return averaged(x, np.abs(r0).sum(axis=0))


def reference_cpgimp(x: Floats, F: Floats, r0: Floats) -> tuple[Floats, Floats]:
    return averaged(x, np.abs(np.diag(F)) * np.abs(r0).sum(axis=0))


def averaged(x: Floats, half: Floats) -> tuple[Floats, Floats]:
    """Mean of the hats over a rectangle by Gauss points between all kinks, which is exact; and of their gradients."""
    points, weights = np.polynomial.legendre.leggauss(2)
    N, dN = np.zeros(NX * NY), np.zeros((NX * NY, 2))
    cuts = []
    for a in (0, 1):
        lines = ORIGIN[a] + DX * np.arange(max(NX, NY))
        ends = x[a] + half[a] * np.array([-1, 1])
        cuts.append(np.sort(np.r_[ends, lines[(lines > ends[0]) & (lines < ends[1])]]))
    for left, right in zip(cuts[0][:-1], cuts[0][1:], strict=True):
        for low, high in zip(cuts[1][:-1], cuts[1][1:], strict=True):
            for p, wp in zip(points, weights, strict=True):
                for q, wq in zip(points, weights, strict=True):
                    at = np.array([(left + right + p * (right - left)) / 2, (low + high + q * (high - low)) / 2])
                    share = wp * wq / 4 * (right - left) * (high - low) / (4 * half.prod())
                    value, gradient = hat(at)
                    N, dN = N + share * value, dN + share * gradient
    return N, dN


def spline(degree: int) -> Any:
    """Products of SciPy's B-splines, far from the walls."""

    def reference(x: Floats, F: Floats, r0: Floats) -> tuple[Floats, Floats]:
        one = BSpline.basis_element(np.arange(degree + 2) - (degree + 1) / 2, extrapolate=False)
        s = (x - place(np.arange(NX * NY))) / DX
        value, slope = np.nan_to_num(one(s)), np.nan_to_num(one.derivative()(s)) / DX
        return value[:, 0] * value[:, 1], np.stack([slope[:, 0] * value[:, 1], value[:, 0] * slope[:, 1]], axis=-1)

    return reference


def reference_cpdi(x: Floats, F: Floats, r0: Floats) -> tuple[Floats, Floats]:
    """Weights of CPDI from the corners; not from side vectors."""
    r1, r2 = (F @ r0.T).T
    return quadrilateral(np.array([x - r1 - r2, x + r1 - r2, x + r1 + r2, x - r1 + r2]))


def reference_limited(x: Floats, F: Floats, r0: Floats) -> tuple[Floats, Floats]:
    """Corners no further from the middle than the limit."""
    away = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ (F @ r0.T).T
    distance, limit = np.hypot(*away.T)[:, None], float(LIMITED.partition("=")[2]) * DX
    return quadrilateral(x + np.where(distance > limit, away / distance * limit, away))


def quadrilateral(corner: Floats) -> tuple[Floats, Floats]:
    """The general form for quadrilaterals, here parallelograms, with the shoelace area."""
    (x1, y1), (x2, y2), (x3, y3), (x4, y4) = corner
    V = shoelace(corner)
    S = [hat(c)[0] for c in corner]
    ends = [(y2 - y4, x4 - x2), (y3 - y1, x1 - x3), (y4 - y2, x2 - x4), (y1 - y3, x3 - x1)]
    return sum(S) / 4, sum(np.outer(s, e) for s, e in zip(S, ends, strict=True)) / (2 * V)


def shoelace(corner: Floats) -> float:
    x, y = corner.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


REFERENCE = {
    "mpm": reference_mpm,
    "tlmpm": reference_tlmpm,
    "gimp": reference_gimp,
    "cpgimp": reference_cpgimp,
    "bspline2": spline(2),
    "bspline3": spline(3),
    "cpdi": reference_cpdi,
    LIMITED: reference_limited,
    "cpdi2": reference_cpdi,  # the same while the domain is a parallelogram; test_quadrilaterals has the others
}


@pytest.mark.parametrize(("name", "kind"), EACH)
def test_against_plain_numpy(name: str, kind: str) -> None:
    if name not in REFERENCE:
        pytest.skip(f"write an independent implementation of {name} here")
    x, F, r0 = particles(np.random.default_rng(2), kind)
    t = fill(name, x, F, r0)
    for p in range(len(x)):
        N, dN = REFERENCE[name](x[p], F[p], r0[p])
        mine, slope = np.zeros(NX * NY), np.zeros((NX * NY, 2))
        np.add.at(mine, t.node[p], t.N[p])  # one node may come up several times
        np.add.at(slope, t.node[p], t.dN[p])
        assert np.abs(mine - N).max() < EXACT
        assert np.abs(slope - dN).max() * DX < EXACT * max(1.0, np.abs(t.dN[p] * DX).sum())


@pytest.mark.parametrize("name", BASES)
def test_a_narrower_box_is_refused_on_each_side(name: str) -> None:
    """The box that just holds all support nodes is taken; one column or row less on any side is not."""
    rng = np.random.default_rng(3)
    for kind in KINDS[name]:
        for x, F, r0 in zip(*particles(rng, kind), strict=True):
            one = x[None], F[None], r0[None]
            i, j = np.divmod(fill(name, *one).node, NY)
            box = np.array([i.min(), i.max(), j.min(), j.max()], dtype=float)
            assert fill(name, *one, box).ok
            for side, inwards in enumerate((1, -1, 1, -1)):
                assert not fill(name, *one, box + inwards * (np.arange(4) == side)).ok


@pytest.mark.parametrize("name", BASES)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e300])
def test_one_bad_place_refuses_the_block(name: str, bad: float) -> None:
    for axis in (0, 1):
        x, F, r0 = particles(np.random.default_rng(4), "near I")
        assert fill(name, x, F, r0).ok
        x[BLOCK // 2, axis] = bad
        assert not fill(name, x, F, r0).ok


@pytest.mark.parametrize("entry", range(4))
@pytest.mark.parametrize("name", ["cpdi", "cpdi2", LIMITED])
def test_nan_in_a_domain_refuses_the_block(name: str, entry: int) -> None:
    x, F, r0 = particles(np.random.default_rng(5), "near I")
    F.reshape(-1, 4)[3, entry] = np.nan
    assert not fill(name, x, F, r0).ok


@pytest.mark.parametrize("stretch", [np.nan, 0.0, 8.0])
def test_cpgimp_refuses_what_its_neighbours_cannot_hold(stretch: float) -> None:
    """Refusal: at a quarter turn F_xx is nothing, and beyond half lengths of a cell four nodes do not suffice."""
    x, F, r0 = particles(np.random.default_rng(5), "near I")
    F[3, 1, 1] = stretch
    assert not fill("cpgimp", x, F, r0).ok


def test_gimp_refuses_domains_wider_than_a_cell() -> None:
    x, F, r0 = particles(np.random.default_rng(5), "near I")
    assert fill("gimp", x, F, 1.99 * r0).ok
    assert not fill("gimp", x, F, 2.01 * r0).ok


def test_quadrilaterals() -> None:
    """CPDI2 on crooked domains: partition of unity, the centroid, Gauss points in the bilinear map, inside out."""
    rng, basis = np.random.default_rng(8), create("mpm_verify.solver.basis", "cpdi2")
    for _ in range(50):
        x, F, r0 = particles(rng, "far from I", 1)
        corner = bodies(x, F, r0)[1](bodies(x, F, r0)[0].corners.reshape(-1, 2)) + 0.05 * DX * rng.random((4, 2))
        table, node = np.zeros(48 * BLOCK), np.zeros(16 * BLOCK, np.int64)
        whole = (0.0, NX - 1.0, 0.0, NY - 1.0)
        assert basis.fill(x.ravel(), F.ravel(), corner.ravel(), *ORIGIN, 1 / DX, NX, NY, *whole, table, node)
        N, gx, gy = table.reshape(3, 16, BLOCK)[:, :, 0]
        value, gradient = np.zeros(NX * NY), np.zeros((NX * NY, 2))
        np.add.at(value, node.reshape(16, BLOCK)[:, 0], N)
        np.add.at(gradient, node.reshape(16, BLOCK)[:, 0], np.stack([gx, gy], -1))
        area, centroid, mean, slope = 0.0, np.zeros(2), np.zeros(NX * NY), np.zeros((NX * NY, 2))
        S = np.array([hat(c)[0] for c in corner])
        for xi, eta in np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / np.sqrt(3):
            shape = (1 + SIDES[:, 0] * xi) * (1 + SIDES[:, 1] * eta) / 4
            by = np.stack([SIDES[:, 0] * (1 + SIDES[:, 1] * eta), SIDES[:, 1] * (1 + SIDES[:, 0] * xi)]) / 4
            jacobian = by @ corner
            share = float(np.linalg.det(jacobian))
            area, centroid, mean = area + share, centroid + share * (shape @ corner), mean + share * (shape @ S)
            slope += share * (np.linalg.inv(jacobian) @ by @ S).T
        size = max(1.0, np.abs(gradient).sum() * DX)
        assert np.abs(value - mean / area).max() < EXACT * size
        assert np.abs(gradient - slope / area).max() * DX < EXACT * size
        assert np.abs(value @ place(np.arange(NX * NY)) - centroid / area).max() < EXACT * size
        turned = corner[[0, 3, 2, 1]].ravel()
        assert not basis.fill(x.ravel(), F.ravel(), turned, *ORIGIN, 1 / DX, NX, NY, *whole, table, node)


@pytest.mark.parametrize("name", ["bspline2", "bspline3"])
def test_splines_at_walls(name: str) -> None:
    """Behind-the-wall nodes have no weight; linear fields stay exact, and the wall node has its own value."""
    rng = np.random.default_rng(9)
    low, high = np.array([PAD, PAD]), np.array([NX, NY]) - 1 - PAD
    for s in (*rng.random((200, 2)), np.array([0.0, 0.0]), np.array([0.5, 1.0])):
        for at in (low + 1.5 * s, high - 1.5 * s, np.array([low[0] + s[0], high[1] - s[1]])):
            t = fill(name, (ORIGIN + DX * at)[None], np.eye(2)[None], 0.25 * DX * np.eye(2)[None])
            index = np.stack(np.divmod(t.node[0], NY), -1)
            behind = ((index < low) | (index > high)).any(axis=1)
            assert t.ok
            assert np.abs(t.N[0][behind]).max(initial=0.0) == 0.0
            assert np.abs(t.dN[0][behind]).max(initial=0.0) == 0.0
            assert t.N.sum() == pytest.approx(1, abs=EXACT)
            np.testing.assert_allclose(t.N[0] @ index, at, rtol=0, atol=EXACT * NX)
            np.testing.assert_allclose(DX * t.dN[0].T @ index, np.eye(2), rtol=0, atol=EXACT * NX)
    corner = fill(name, (ORIGIN + DX * low)[None], np.eye(2)[None], 0.25 * DX * np.eye(2)[None])
    assert corner.N[0][corner.node[0] == low[0] * NY + low[1]] == pytest.approx(1, abs=EXACT)


@pytest.mark.parametrize("name", ["bspline2", "bspline3"])
def test_splines_are_smooth(name: str) -> None:
    """Values and slopes, continuous where a particle passes from one set of neighbours to the next, walls too."""
    for cell in np.arange(PAD, NX - 1 - PAD, 0.5):
        sides = []
        for shift in (-1e-9, 1e-9):
            at = np.array([cell + 0.5 + shift, 7.3])
            t = fill(name, (ORIGIN + DX * at)[None], np.eye(2)[None], 0.25 * DX * np.eye(2)[None])
            N, dN = np.zeros(NX * NY), np.zeros((NX * NY, 2))
            np.add.at(N, t.node[0], t.N[0])
            np.add.at(dN, t.node[0], t.dN[0] * DX)
            sides.append((N, dN))
        assert np.abs(sides[1][0] - sides[0][0]).max() < 1e-8
        assert np.abs(sides[1][1] - sides[0][1]).max() < 1e-8


@pytest.mark.parametrize("count", [1, 2, 7, BLOCK - 1])
@pytest.mark.parametrize("name", BASES)
def test_short_blocks(name: str, count: int) -> None:
    """The first rows of a block do not depend on how many follow, to the bit, and no other row is written."""
    x, F, r0 = particles(np.random.default_rng(6), KINDS[name][-1])
    whole, part = fill(name, x, F, r0), fill(name, x[:count], F[:count], r0[:count])
    for array in ("node", "N", "dN"):
        np.testing.assert_array_equal(getattr(part, array), getattr(whole, array)[:count])
    basis = create("mpm_verify.solver.basis", name)
    K = basis.support
    table, node = np.full(3 * K * BLOCK, -7.0), np.full(K * BLOCK, -7, np.int64)
    domain = basis.domain(*bodies(x[:count], F[:count], r0[:count]))
    one = x[:count].ravel(), F[:count].ravel(), domain.ravel()
    basis.fill(*one, *ORIGIN, 1 / DX, NX, NY, 0.0, NX - 1.0, 0.0, NY - 1.0, table, node)
    assert (table.reshape(-1, BLOCK)[:, count:] == -7).all()
    assert (node.reshape(-1, BLOCK)[:, count:] == -7).all()


@pytest.mark.parametrize("name", BASES)
def test_on_a_node(name: str) -> None:
    """Ties go one way: a particle on a node still has a partition of unity and its own place."""
    x = place(np.array([5 * NY + 5]))
    t = fill(name, x, np.eye(2)[None], 0.25 * DX * np.eye(2)[None])
    assert t.ok
    assert t.N.sum() == pytest.approx(1, abs=EXACT)
    np.testing.assert_allclose(t.N @ place(t.node)[0], x, atol=EXACT)


def test_a_limit_cuts_long_domains_alone() -> None:
    """What is shorter has the bits of CPDI without one; `cut` says which, `corners` gives what the fill takes."""
    x, F, r0 = particles(np.random.default_rng(10), "far from I")
    basis = create("mpm_verify.solver.basis", LIMITED)
    domain, whole = basis.domain(*bodies(x, F, r0)), create("mpm_verify.solver.basis", "cpdi")
    cut = basis.cut(F, domain, DX)
    assert 3 < cut.sum() < len(x) - 3
    free, limited = fill("cpdi", x, F, r0), fill(LIMITED, x, F, r0)
    close = np.abs(limited.dN - free.dN).max(axis=(1, 2)) < 1e-12 / DX
    np.testing.assert_array_equal(close, ~cut)
    corners = basis.corners(x, F, domain, DX)
    assert np.linalg.norm(corners - x[:, None], axis=2).max() == pytest.approx(basis.limit * DX, rel=1e-12)
    uncut = whole.corners(x, F, domain[:, :4], DX)
    np.testing.assert_allclose(corners[~cut], uncut[~cut], atol=1e-15)
    assert not whole.cut(F, domain[:, :4], DX).any()


@pytest.mark.parametrize("limit", ["0", "-1"])
def test_a_limit_above_zero(limit: str) -> None:
    with pytest.raises(ValueError, match="must be above zero"):
        create("mpm_verify.solver.basis", f"cpdi:limit={limit}")


@pytest.mark.parametrize("ppc", [1, 4, 9, 16])
def test_domains_tile_the_body_and_follow_det_f(ppc: int) -> None:
    """The area of a domain from its corners is det F V0: the volume in the forces is that of the weights."""
    p = rectangle(np.array([-0.2, 0.3]), np.array([0.6, 0.9]), 0.1, ppc)
    assert len(p) == ppc * 48
    assert p.V0.sum() == pytest.approx(0.48, rel=EXACT)
    F = particles(np.random.default_rng(7), "far from I", len(p))[1]
    for row in range(len(p)):
        r1, r2 = (F[row] @ p.r0[row].T).T
        area = shoelace(np.array([-r1 - r2, r1 - r2, r1 + r2, r2 - r1]))
        assert area == pytest.approx(np.linalg.det(F[row]) * p.V0[row], rel=1e-12)
    lows = {tuple(corner) for corner in np.rint((p.X - p.r0.sum(axis=1)) / (0.1 / np.sqrt(ppc)) * 10).astype(int)}
    assert len(lows) == len(p)  # no two domains on the same place


@pytest.mark.parametrize("ppc", [0, -4, 2, 3, 5, 8])
def test_counts_that_are_no_squares(ppc: int) -> None:
    with pytest.raises(ValueError, match="not a square number"):
        rectangle(np.zeros(2), np.ones(2), 0.1, ppc)


def test_a_domain_of_broken_cells() -> None:
    with pytest.raises(ValueError, match="whole number of cells"):
        Grid(0.3, np.zeros(2), np.ones(2))
