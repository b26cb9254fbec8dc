"""Shape functions through the compiled fill of each basis: identities, an independent implementation, the box."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from solver._jit import BLOCK
from solver.plugins import available, load
from solver.state import Floats, Grid, fill_rectangle

BASES = available("solver.basis")
DX, NX, NY, ORIGIN = 0.13, 23, 19, np.array([-0.7, 0.4])  # nothing square, nothing at zero
EXACT = 1e-13


@dataclass
class Table:
    """What a fill wrote, as (n, K) arrays; dN (n, K, 2)."""

    ok: bool
    node: Any
    N: Floats
    dN: Floats


def fill(name: str, x: Floats, F: Floats, r0: Floats, box: Any = (0.0, NX - 1.0, 0.0, NY - 1.0)) -> Table:
    """Call the kernel of basis `name` on up to BLOCK particles, and unpack the layout of solver/weights.py."""
    K, n = load("solver.basis", name).support, len(x)
    table, node = np.full(3 * K * BLOCK, -7.0), np.full(K * BLOCK, -7, np.int64)
    kernel = load("solver.basis", name).fill
    ok = kernel(x.ravel(), F.ravel(), r0.ravel(), *ORIGIN, 1 / DX, NY, *map(float, box), table, node)
    N, gx, gy = table.reshape(3, K, BLOCK)[:, :, :n].transpose(0, 2, 1)
    return Table(ok, node.reshape(K, BLOCK)[:, :n].T, N, np.stack([gx, gy], axis=-1))


def particles(rng: np.random.Generator, kind: str, n: int = BLOCK) -> tuple[Floats, Floats, Floats]:
    """Random places two cells from the edge, half sides of a quarter cell, and F near I or far from it."""
    x = ORIGIN + DX * (2 + rng.random((n, 2)) * (np.array([NX, NY]) - 5))
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


@pytest.mark.parametrize("kind", ["near I", "far from I"])
@pytest.mark.parametrize("name", BASES)
def test_identities(name: str, kind: str) -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        x, F, r0 = particles(rng, kind)
        t = fill(name, x, F, r0)
        assert t.ok
        away = (place(t.node) - x[:, None]) / DX  # in cells from the particle: the scale of the round-off
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


def reference_cpdi(x: Floats, F: Floats, r0: Floats) -> tuple[Floats, Floats]:
    """The general form for quadrilaterals, from the corners and the shoelace area, not from side vectors."""
    (r1, r2), S = (F @ r0.T).T, []
    corner = np.array([x - r1 - r2, x + r1 - r2, x + r1 + r2, x - r1 + r2])
    (x1, y1), (x2, y2), (x3, y3), (x4, y4) = corner
    V = shoelace(corner)
    S = [hat(c)[0] for c in corner]
    ends = [(y2 - y4, x4 - x2), (y3 - y1, x1 - x3), (y4 - y2, x2 - x4), (y1 - y3, x3 - x1)]
    return sum(S) / 4, sum(np.outer(s, e) for s, e in zip(S, ends, strict=True)) / (2 * V)


def shoelace(corner: Floats) -> float:
    x, y = corner.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


REFERENCE = {"mpm": reference_mpm, "cpdi": reference_cpdi}


@pytest.mark.parametrize("kind", ["near I", "far from I"])
@pytest.mark.parametrize("name", BASES)
def test_against_plain_numpy(name: str, kind: str) -> None:
    assert name in REFERENCE, f"the new basis {name} needs an independent implementation here"
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
    """The box that just holds all neighbours is taken; one column or row less on any side is not."""
    rng = np.random.default_rng(3)
    for kind in ("near I", "far from I"):
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
def test_nan_in_a_domain_refuses_the_block(entry: int) -> None:
    x, F, r0 = particles(np.random.default_rng(5), "near I")
    F.reshape(-1, 4)[3, entry] = np.nan
    assert not fill("cpdi", x, F, r0).ok


@pytest.mark.parametrize("count", [1, 2, 7, BLOCK - 1])
@pytest.mark.parametrize("name", BASES)
def test_short_blocks(name: str, count: int) -> None:
    """The first rows of a block do not depend on how many follow, to the bit, and no other row is written."""
    x, F, r0 = particles(np.random.default_rng(6), "far from I")
    whole, part = fill(name, x, F, r0), fill(name, x[:count], F[:count], r0[:count])
    for array in ("node", "N", "dN"):
        np.testing.assert_array_equal(getattr(part, array), getattr(whole, array)[:count])
    K = load("solver.basis", name).support
    table, node = np.full(3 * K * BLOCK, -7.0), np.full(K * BLOCK, -7, np.int64)
    one = x[:count].ravel(), F[:count].ravel(), r0[:count].ravel()
    load("solver.basis", name).fill(*one, *ORIGIN, 1 / DX, NY, 0.0, NX - 1.0, 0.0, NY - 1.0, table, node)
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


@pytest.mark.parametrize("ppc", [1, 4, 9, 16])
def test_domains_tile_the_body_and_follow_det_f(ppc: int) -> None:
    """The area of a domain from its corners is det F V0: the volume in the forces is that of the weights."""
    grid = Grid(0.1, np.array([-0.2, 0.3]), np.array([0.6, 0.9]))
    p = fill_rectangle(grid, ppc, 2.0)
    assert len(p) == ppc * 48
    assert p.V0.sum() == pytest.approx(0.48, rel=EXACT)
    assert p.m.sum() == pytest.approx(0.96, rel=EXACT)
    F = particles(np.random.default_rng(7), "far from I", len(p))[1]
    for row in range(len(p)):
        r1, r2 = (F[row] @ p.r0[row].T).T
        area = shoelace(np.array([-r1 - r2, r1 - r2, r1 + r2, r2 - r1]))
        assert area == pytest.approx(np.linalg.det(F[row]) * p.V0[row], rel=1e-12)
    lows = {tuple(corner) for corner in np.rint((p.X - p.r0.sum(axis=1)) / (0.1 / np.sqrt(ppc)) * 10).astype(int)}
    assert len(lows) == len(p)  # no two domains on the same place


@pytest.mark.parametrize("ppc", [0, -4, 2, 3, 5, 8])
def test_counts_that_are_no_squares(ppc: int) -> None:
    with pytest.raises(ValueError, match="no square number"):
        fill_rectangle(Grid(0.1, np.zeros(2), np.ones(2)), ppc, 1.0)


def test_a_domain_of_broken_cells() -> None:
    with pytest.raises(ValueError, match="whole number of cells"):
        Grid(0.3, np.zeros(2), np.ones(2))
