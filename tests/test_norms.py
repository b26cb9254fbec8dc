"""The four norms against plain NumPy, and what the printed one shows when nothing improves."""

import re
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.judging.fit import local_orders
from mpm_verify.cases.mms.norms import CHUNK, SUMS, Norms, compare, new_sums
from mpm_verify.cases.mms.run import NORMS, QUANTITIES, Run
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.reports.sentences.norms import printed
from mpm_verify.solver.material.neo_hookean import NeoHookean
from mpm_verify.solver.plugins import create
from mpm_verify.solver.state import Floats, Particles

TIMES = (0.001, 0.0034, 0.0102)
BEHIND = 2.5e-4


@pytest.fixture(scope="module")
def exact() -> Manufactured:
    return manufacture(create("mpm_verify.mms.solutions", "clamped_shear"), NeoHookean(), 1.0)


def body(count: int, rng: np.random.Generator, unequal: bool = True) -> Particles:
    X = rng.random((count, 2))
    V0 = rng.uniform(0.2, 3.0, count) if unequal else np.full(count, 0.7)
    return Particles(X, V0.copy(), V0, np.zeros((count, 0)))


def planted(exact: Manufactured, p: Particles, rng: np.random.Generator, norms: Norms) -> list[dict[str, Floats]]:
    """Add known errors to the exact state at several times and let the kernel find them; one dict a time."""
    p.carried = exact.kernel.columns(p.X)
    errors, shares = [], new_sums(p)
    for n, t in enumerate(TIMES):
        size = {"u": 1e-3, "v": 0.1, "F": 1e-2, "sigma": 30.0}
        shape = {"u": (2,), "v": (2,), "F": (2, 2), "sigma": (4,)}
        e = {q: (n + 1) * size[q] * rng.standard_normal((len(p), *shape[q])) for q in QUANTITIES}
        p.x, p.v = exact.x(p.X, t) + e["u"], exact.v(p.X, t - BEHIND) + e["v"]
        p.F, p.sigma = exact.F(p.X, t) + e["F"], exact.sigma(p.X, t) + e["sigma"]
        scalars = exact.kernel.scalars(t, t - BEHIND)
        compare(
            exact.kernel.fill, p.carried, scalars, p.X, p.x, p.v, p.F, p.sigma, p.V0, p.b, shares,
        )  # fmt: skip
        norms.add(shares)
        errors.append(e)
        b = exact.b(p.X, t)
        np.testing.assert_allclose(p.b, b, atol=1e-11 * np.abs(b).max())
    return errors


@pytest.mark.parametrize("count", [1, 31, 32, 33, 500, CHUNK, 2 * CHUNK + 77])
@pytest.mark.parametrize("unequal", [False, True])
def test_against_plain_numpy(exact: Manufactured, count: int, unequal: bool) -> None:
    rng = np.random.default_rng(count)
    p = body(count, rng, unequal)
    norms = Norms(count, float(p.V0.mean()))
    steps = planted(exact, p, rng, norms)
    found = norms.errors()
    weight = p.V0 / p.V0.mean()
    for quantity in QUANTITIES:
        squares = []
        for e in steps:
            full = e[quantity].reshape(count, -1)
            if quantity == "sigma":  # xx, yy, zz, xy: as a 3 x 3 tensor xy counts twice
                full = full * np.sqrt([1, 1, 1, 2])
            squares.append((full**2).sum(axis=1))
        total = sum((weight * s).sum() for s in squares)
        points = len(TIMES) * count
        expected = {
            "rms": np.sqrt(total / points),
            "max": np.sqrt(max(s.max() for s in squares)),
            "final": np.sqrt((weight * squares[-1]).sum() / count),
            "printed": np.sqrt(total) / points,
        }
        assert set(found[quantity]) == set(expected) == set(NORMS)
        for norm in NORMS:
            assert found[quantity][norm] == pytest.approx(expected[norm], rel=1e-9), (quantity, norm)


def test_exact_state_has_no_error(exact: Manufactured) -> None:
    """To round-off: of places of size one for u, of the size of the field for the others."""
    p, t = body(1000, np.random.default_rng(1)), TIMES[1]
    p.carried, shares, norms = exact.kernel.columns(p.X), new_sums(p), Norms(1000, float(p.V0.mean()))
    p.x, p.v, p.F, p.sigma = exact.x(p.X, t), exact.v(p.X, t), exact.F(p.X, t), exact.sigma(p.X, t)
    compare(
        exact.kernel.fill, p.carried, exact.kernel.scalars(t, t), p.X, p.x, p.v, p.F, p.sigma, p.V0, p.b, shares
    )  # fmt: skip
    norms.add(shares)
    for quantity, size in (("u", 1), ("v", np.abs(p.v).max()), ("F", 1), ("sigma", np.abs(p.sigma).max())):
        assert norms.errors()[quantity]["max"] < 2e-14 * size


def constant(steps: int, particles: int, error: float) -> dict[str, Any]:
    """Norms of the same error of every particle at every step."""
    norms = Norms(particles, 0.25)
    shares = np.zeros((1, SUMS))
    shares[0, :4] = 0.25 * particles * error**2  # weighted by V0
    shares[0, 4:] = error**2
    for _ in range(steps):
        norms.add(shares)
    return norms.errors()


@pytest.mark.parametrize(("steps", "particles"), [(1, 1), (10, 64), (40, 256), (160, 1024)])
def test_a_constant_error(steps: int, particles: int) -> None:
    """rms, max and final are that error; the norm as printed in eq. (7) shrinks with every step and particle."""
    for norms in constant(steps, particles, 3e-3).values():
        for norm in ("rms", "max", "final"):
            assert norms[norm] == pytest.approx(3e-3, rel=1e-13)
        assert norms["printed"] == pytest.approx(3e-3 / np.sqrt(steps * particles), rel=1e-13)


@pytest.mark.parametrize("order", [0, 1, 2, -0.85])
def test_the_printed_norm_adds_an_order_and_a_half(order: float) -> None:
    """At fixed particles per cell and Courant number in 2-D, whatever the order of the method, none among them."""
    cells = np.array([8, 16, 32, 64])
    h = 1 / cells
    found = [constant(5 * n, 4 * n * n, float(n) ** -order)["u"] for n in cells.tolist()]
    for norm, expected in (("rms", order), ("printed", order + 1.5)):
        rates = local_orders(h, np.array([e[norm] for e in found]))
        np.testing.assert_allclose(rates, expected, atol=1e-12)


def test_more_particles_improve_the_printed_norm_alone() -> None:
    """1, 4, 9 particles per cell: the printed norm falls to a half and a third, and nothing is better."""
    found = [constant(40, ppc * 64, 1e-3)["u"] for ppc in (1, 4, 9)]
    assert [found[0]["printed"] / e["printed"] for e in found] == pytest.approx([1, 2, 3], rel=1e-12)
    assert [found[0]["rms"] / e["rms"] for e in found] == pytest.approx([1, 1, 1], rel=1e-12)


def test_nan_is_not_hidden(exact: Manufactured) -> None:
    """A NaN in one particle shows in the sums; a largest value alone would pass it over."""
    p, t = body(100, np.random.default_rng(2)), TIMES[0]
    p.carried, shares, norms = exact.kernel.columns(p.X), new_sums(p), Norms(100, float(p.V0.mean()))
    p.x, p.v, p.F, p.sigma = exact.x(p.X, t), exact.v(p.X, t), exact.F(p.X, t), exact.sigma(p.X, t)
    p.v[57, 1] = np.nan
    compare(
        exact.kernel.fill, p.carried, exact.kernel.scalars(t, t), p.X, p.x, p.v, p.F, p.sigma, p.V0, p.b, shares
    )  # fmt: skip
    norms.add(shares)
    assert np.isnan(norms.errors()["v"]["rms"])


def shrinks(d: int, finer: bool, ppc: int, frames: bool) -> float:
    """Factor by which the printed norm of a constant error falls on cells half as wide, or with more particles."""
    steps = np.array([16, 16 if frames else 16 * 2**finer])
    particles = np.array([4**d, (4 * 2**finer) ** d * ppc])
    sizes = [np.sqrt(n * m * 0.25) / (n * m) for n, m in zip(steps, particles, strict=True)]
    return float(sizes[0] / sizes[1])


@pytest.mark.parametrize("solver", ["", "mine {case} {out}"])
@pytest.mark.parametrize("d", [1, 2, 3])
def test_what_the_page_says_of_the_printed_norm(d: int, solver: str) -> None:
    """A constant error in one, two and three dimensions; frames of a solver of one's own are as many on each grid."""
    numbers = {"√2": 2**0.5, "2": 2.0, "3": 3.0, "√8": 8**0.5, "4": 4.0, "√27": 27**0.5}
    orders = {"half an order": 0.5, "an order": 1.0, "1.5 orders": 1.5, "2 orders": 2.0}
    run = Run("cpdi", "bump", "neo_hookean", 8, 4, 0.4, dim=d, solver=solver)
    said = re.search(r"printed by (\S+) more .* adds (.*) in (\d)-D, .* 1 → (\d+) → (\d+) .* by (\S+) and (\S+) though",
                     printed([run, run]))  # fmt: skip
    assert said
    factor = shrinks(d, True, 1, bool(solver))
    assert numbers[said[1]] == pytest.approx(factor)
    assert (orders[said[2]], int(said[3])) == (pytest.approx(np.log2(factor)), d)
    for count, by in ((said[4], said[6]), (said[5], said[7])):
        assert numbers[by] == pytest.approx(shrinks(d, False, int(count), bool(solver)))
