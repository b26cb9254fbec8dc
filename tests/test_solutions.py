"""The solutions on rings, in a bar and with swirl: closed forms, edges without traction, invariants, bounds."""

from functools import cache
from typing import Any

import numpy as np
import pytest
import sympy as sp

from mpm_verify.cases.mms.execute import setup
from mpm_verify.cases.mms.run import Run
from mpm_verify.mms.exact import ROOM, ROWS
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.solver._jit import BLOCK
from mpm_verify.solver.plugins import create, load
from mpm_verify.solver.state import Floats
from mpm_verify.solver.step import advance

NAMES = ["generalised_vortex", "expanding_ring", "bar", "swirl"]
EXTRA = [
    "generalised_vortex:A=-0.7,rate=2.5,inner=0.5,outer=1.7",
    "expanding_ring:A=-0.15,inner=1.1,outer=1.9,C=30",
    "bar:A=0.2,n=2,axis=1,phase=0.6,L=3,C=40",
    "swirl:A=-1.2,B=-0.25,L=0.7,C=30",
]
every = pytest.mark.parametrize("text", [*NAMES, *EXTRA])
RADII = {"generalised_vortex": (0.75, 1.25), "expanding_ring": (0.4, 0.6)}
COMPLEX_STEP = 1e-30
STENCIL = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))  # sixth order


@cache
def made(text: str, material: str = "") -> tuple[Any, Any, Manufactured]:
    """Solution, material (its own unless another is named), fields."""
    solution = create("mpm_verify.mms.solutions", text)
    law = create("mpm_verify.solver.material", material or solution.material)
    return solution, law, manufacture(solution, law, law.rho0)


def places(solution: Any, count: int = 60) -> Floats:
    """Places of particles, drawn by lot."""
    X = solution.layout(float(solution.upper[0] - solution.lower[0]) / 32, 4).X
    return np.random.default_rng(5).permutation(X)[:count]


def times(solution: Any, count: int = 5) -> Floats:
    """The start, and times drawn by lot."""
    return np.array([0.0, *(solution.duration * np.random.default_rng(6).random(count - 1))])


def block(exact: Manufactured, X: Floats, t: float) -> dict[str, Floats]:
    """What the compiled kernel gives for up to BLOCK places."""
    out = np.full(ROOM * BLOCK, np.nan)
    exact.kernel.fill(exact.kernel.columns(X).ravel(), exact.kernel.scalars(t, t), len(X), out)
    rows = out.reshape(ROOM, BLOCK)[:, : len(X)]
    return {name: rows[list(of)].T for name, of in ROWS.items()}


def circle(R: float, count: int = 37) -> tuple[Floats, Floats]:
    """Places on a circle and their outward normals."""
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False) + 0.1
    N = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return R * N, N


def traction(text: str, material: str = "") -> float:
    """Largest traction P N on both edges of a ring and at several times."""
    solution, _, exact = made(text, material)
    edges = [circle(R) for R in (solution.inner, solution.outer)]
    return max(
        float(np.abs(np.einsum("pij,pj->pi", exact.P(X, t), N)).max())
        for X, N in edges
        for t in solution.duration * np.linspace(0.05, 0.95, 9)
    )


def textbook_stress(F: Floats, lam: float, mu: float) -> Floats:
    """P = mu (F - F^-T) + lam ln J F^-T."""
    inverse = np.linalg.inv(F).transpose(0, 2, 1)
    return mu * (F - inverse) + lam * np.log(np.linalg.det(F))[:, None, None] * inverse


@every
def test_residual_of_the_momentum_balance(text: str) -> None:
    """rho0 (u'' - b) = Div P, where F and v are complex steps of the displacement, and P is the textbook's."""
    solution, law, exact = made(text)
    symbols, time = sp.symbols("X Y"), sp.Symbol("t")
    u: Any = sp.lambdify((*symbols, time), list(solution.displacement(symbols, time)), "numpy")

    def step(X: Floats, t: float, direction: int) -> Floats:
        """Derivative of u by X, Y or t."""
        at = [X[:, 0].astype(complex), X[:, 1].astype(complex), np.full(len(X), t, complex)]
        at[direction] += 1j * COMPLEX_STEP
        return np.stack([np.broadcast_to(c, len(X)) for c in u(*at)], axis=-1).imag / COMPLEX_STEP

    def stress(X: Floats, t: float) -> Floats:
        F = np.eye(2) + np.stack([step(X, t, 0), step(X, t, 1)], axis=-1)
        return textbook_stress(F, law.lam, law.mu)

    X, h, tau = places(solution), 1e-3 * solution.L, 2e-3 * solution.L / solution.C
    moves = 0.0
    for t in times(solution):
        acceleration = sum(c * (step(X, t + k * tau, 2) - step(X, t - k * tau, 2)) for k, c in STENCIL) / tau
        divergence = np.zeros_like(X)
        for axis in (0, 1):
            e = h * np.eye(2)[axis]
            divergence += sum(c * (stress(X + k * e, t) - stress(X - k * e, t))[..., axis] for k, c in STENCIL) / h
        residual = acceleration - divergence / law.rho0 - exact.b(X, t)
        moves = max(moves, float(np.abs(acceleration).max()))
        size = np.abs(acceleration).max() + np.abs(divergence).max() / law.rho0
        assert np.abs(residual).max() <= 1e-8 * max(size, 1e-2 * moves)
        np.testing.assert_allclose(exact.P(X, t), stress(X, t), rtol=0, atol=1e-12 * law.E)
        np.testing.assert_allclose(exact.v(X, t), step(X, t, 2), rtol=0, atol=1e-12 * solution.C)
    assert moves > 0


@pytest.mark.slow
@every
def test_the_kernel_gives_what_numpy_gives(text: str) -> None:
    solution, law, exact = made(text)
    X = places(solution, BLOCK)
    for t in times(solution):
        for name, values in block(exact, X, t).items():
            other = getattr(exact, name)(X, t).reshape(values.shape)
            size = {"u": solution.L, "v": solution.C, "F": 1, "sigma": law.E, "b": np.abs(other).max()}[name]
            np.testing.assert_allclose(values, other, rtol=0, atol=1e-12 * size, err_msg=name)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("R", "angle", "t", "b"),
    [
        (0.85, 0.7, 0.3, (12.3670436, 1.4437543)),
        (1.1, 2.0, 0.2, (-5.4435488, -5.0879421)),
        (1.2, -1.0, 0.5, (-11.5698593, -22.5705666)),
    ],
)
def test_body_force_of_the_vortex(R: float, angle: float, t: float, b: tuple[float, float]) -> None:
    """Recorded values, and the closed form in polar components, by the NumPy functions and by the kernel.

    The values were recorded with mu = 384.615, so with E = 999.999; with E = 1000 they differ by up to 2.2e-5.
    """
    X = R * np.array([[np.cos(angle), np.sin(angle)]])
    recorded = made("generalised_vortex", "neo_hookean:E=999.999,rho0=1000")[2]
    np.testing.assert_allclose(recorded.b(X, t)[0], b, rtol=0, atol=1e-6)
    np.testing.assert_allclose(block(recorded, X, t)["b"][0], b, rtol=0, atol=1e-6)
    _, law, exact = made("generalised_vortex")
    s = R - 1.0
    h, dh = 1 - 32 * s**2 + 256 * s**4, -64 * s + 1024 * s**3
    wave, mu = np.sin(np.pi * t), law.mu / law.rho0
    radial = R * (mu * (wave * dh) ** 2 - (np.pi * np.cos(np.pi * t) * h) ** 2)
    hoop = -R * np.pi**2 * wave * h - mu * wave * (3 * dh + R * (-64 + 3072 * s**2))
    beta = angle + wave * h
    closed = [np.cos(beta) * radial - np.sin(beta) * hoop, np.sin(beta) * radial + np.cos(beta) * hoop]
    np.testing.assert_allclose(exact.b(X, t)[0], closed, rtol=1e-11)
    np.testing.assert_allclose(block(exact, X, t)["b"][0], closed, rtol=1e-11)


@pytest.mark.parametrize("text", ["generalised_vortex", EXTRA[0]])
def test_invariants_of_the_vortex(text: str) -> None:
    """Volume is kept; the edges neither move nor pull; half-way the middle is turned by A."""
    solution, law, exact = made(text)
    for t in times(solution):
        assert np.abs(np.linalg.det(exact.F(places(solution), t)) - 1).max() < 1e-12
        for R in (solution.inner, solution.outer):
            assert np.abs(exact.u(circle(R)[0], t)).max() < 1e-14
    assert traction(text) < 1e-12 * law.mu
    X, N = circle((solution.inner + solution.outer) / 2)
    half = 0.5 / solution.rate
    turned = N @ np.array([[np.cos(solution.A), np.sin(solution.A)], [-np.sin(solution.A), np.cos(solution.A)]])
    np.testing.assert_allclose(exact.x(X, half), np.hypot(*X[0]) * turned, atol=1e-14)


def test_stretch_of_the_vortex() -> None:
    """The stretch and the speeds that its docstring states; a wave and the motion pass 0.6 of a cell in a step."""
    solution, law, exact = made("generalised_vortex")
    R = np.linspace(0.75, 1.25, 2001)
    X = np.stack([R, 0 * R], axis=-1)
    stretch = np.linalg.svd(exact.F(X, 0.5), compute_uv=False).max()
    assert stretch == pytest.approx(7.2, abs=0.05)
    fastest = np.hypot(*exact.v(X, 0.0).T).max()
    assert fastest == pytest.approx(3.1, abs=0.1)
    wave = stretch * np.sqrt(law.mu / law.rho0)
    assert wave == pytest.approx(4.4, abs=0.1)
    assert 0.4 * (wave + fastest) / solution.C == pytest.approx(0.6, abs=0.02)
    assert np.abs(exact.v(X, 0.5)).max() < 1e-14


@pytest.mark.parametrize("text", ["expanding_ring", EXTRA[1]])
def test_free_edges_of_the_ring(text: str) -> None:
    """No traction with nu = 0; with nu = 0.3 there is one, so the material is part of the solution."""
    solution, _, exact = made(text)
    assert traction(text, "neo_hookean:E=1e7,nu=0,rho0=1000") < 1e-12 * 1e7
    assert traction(text, "neo_hookean:E=1e7,nu=0.3,rho0=1000") > 1e-2 * 1e7
    X, N = circle(solution.outer)
    for t in times(solution):
        wave = np.sin(np.pi * solution.C * t / (solution.inner + solution.outer))
        np.testing.assert_allclose(exact.u(X, t), solution.A * wave * N, rtol=0, atol=1e-14)
    np.testing.assert_allclose(exact.u(X, solution.duration), 0, atol=1e-14)  # one period


@pytest.mark.parametrize("text", ["bar", "bar:n=3,A=0.05,phase=0.4,L=2,C=30"])
def test_closed_form_of_the_bar(text: str) -> None:
    """Body force along the axis, none across; the y bar is the x bar with its axes changed, bit by bit."""
    solution, law, exact = made(text)
    X, k, w = places(solution), solution.n * np.pi / solution.L, solution.C * np.pi / solution.L
    bar, upright = exact, made(f"{text}{',' if ':' in text else ':'}axis=1")[2]
    for t in times(solution):
        wave = solution.A * np.sin(w * t + solution.phase)
        u, F = wave * np.sin(k * X[:, 0]), 1 + wave * k * np.cos(k * X[:, 0])
        b = -(w**2) * u + k**2 * u / law.rho0 * (law.mu + (law.mu + law.lam * (1 - np.log(F))) / F**2)
        np.testing.assert_allclose(bar.b(X, t)[:, 0], b, rtol=1e-9, atol=1e-9 * w**2 * solution.A)
        np.testing.assert_array_equal(bar.b(X, t)[:, 1], 0)
        turned = np.ascontiguousarray(X[:, ::-1])
        np.testing.assert_array_equal(upright.u(turned, t)[:, ::-1], bar.u(X, t))
        np.testing.assert_array_equal(upright.b(turned, t)[:, ::-1], bar.b(X, t))
        np.testing.assert_array_equal(upright.F(turned, t)[:, ::-1, ::-1], bar.F(X, t))
        np.testing.assert_array_equal(upright.sigma(turned, t)[:, [1, 0, 2, 3]], bar.sigma(X, t))


def test_the_bar_crosses_cells() -> None:
    """F and the way that the default goes on 64 cells, as its docstring states them."""
    _, _, exact = made("bar")
    X = np.stack([np.linspace(0, 1, 1001), np.full(1001, 0.5)], axis=-1)
    F = exact.F(X, 0.005)[:, 0, 0]
    assert (F.min(), F.max()) == pytest.approx((0.686, 1.314), abs=1e-3)
    assert 64 * np.abs(exact.u(X, 0.005)).max() == pytest.approx(6.4)


def extremes(text: str) -> dict[str, tuple[float, float]]:
    """Smallest and largest J, stretch, rotation (degrees) and shear (F^T F)_xy over a fine sampling."""
    solution, _, exact = made(text)
    grid = np.stack(np.meshgrid(*[np.linspace(0, solution.L, 81)] * 2), axis=-1).reshape(-1, 2)
    found: dict[str, list[Floats]] = {"J": [], "stretch": [], "rotation": [], "shear": []}
    for t in np.linspace(0, solution.duration, 65):
        F = exact.F(grid, t)
        found["J"].append(np.linalg.det(F))
        found["stretch"].append(np.linalg.svd(F, compute_uv=False))
        found["rotation"].append(np.degrees(np.arctan2(F[:, 1, 0] - F[:, 0, 1], F[:, 0, 0] + F[:, 1, 1])))
        found["shear"].append((F.transpose(0, 2, 1) @ F)[:, 0, 1])
    return {name: (float(np.min(values)), float(np.max(values))) for name, values in found.items()}


def test_extremes_of_the_swirl() -> None:
    """What its docstring states."""
    found = extremes("swirl")
    assert found["J"] == pytest.approx((0.657, 1.324), abs=2e-3)
    assert found["stretch"] == pytest.approx((0.587, 1.596), abs=2e-3)
    assert found["rotation"][1] == pytest.approx(52.0, abs=0.1)
    assert max(np.abs(found["shear"])) == pytest.approx(0.877, abs=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("A", [-1.499, 0.0, 0.75, 1.499])
@pytest.mark.parametrize("B", [-0.299, 0.0, 0.299])
def test_the_swirl_stays_invertible_inside_its_bounds(A: float, B: float) -> None:
    solution, _, exact = made(f"swirl:A={A},B={B}")
    X = np.stack(np.meshgrid(*[np.linspace(0, 1, 81)] * 2), axis=-1).reshape(-1, 2)
    assert min(np.linalg.det(exact.F(X, t)).min() for t in np.linspace(0, solution.duration, 33)) > 0.26


def test_the_swirl_starts_with_velocity_and_acceleration() -> None:
    """Both, unlike those with a sine alone; and the body turns and swells at once."""
    solution, _, exact = made("swirl")
    X, tau = places(solution), 1e-5 * solution.duration
    acceleration = (exact.v(X, tau) - exact.v(X, -tau)) / (2 * tau)
    assert np.abs(exact.v(X, 0.0)).max() > 0.03 * solution.C
    assert np.abs(acceleration).max() > 0.3 * solution.C**2 / solution.L


@pytest.mark.parametrize("name", ["generalised_vortex", "expanding_ring"])
def test_rings_have_room(name: str) -> None:
    """The area is exact, domains lie between the radii, and two cells of clearance are left on each side."""
    solution = load("mpm_verify.mms.solutions", name)()
    inner, outer = RADII[name]
    for cells in (8, 16, 33):
        dx = float(solution.upper[0] - solution.lower[0]) / cells
        layout = solution.layout(dx, 4)
        R = np.hypot(*layout.X.T)
        assert layout.V0.sum() == pytest.approx(np.pi * (outer**2 - inner**2), rel=1e-13)
        assert inner < R.min() < R.max() < outer
        exact = made(name)[2]
        reach = max(np.abs(exact.x(circle(outer)[0], t)).max() for t in np.linspace(0, solution.duration, 33))
        assert solution.upper[0] + solution.margin >= reach + 2 * dx - 1e-12


@pytest.mark.parametrize(
    "text",
    ["generalised_vortex:A=2", "generalised_vortex:rate=0", "generalised_vortex:inner=0", "generalised_vortex:C=0",
     "expanding_ring:inner=0.7", "expanding_ring:inner=0.2", "expanding_ring:A=0.39", "expanding_ring:C=-1",
     "expanding_ring:outer=nan", "bar:A=0.32", "bar:A=0.17,n=2", "bar:n=0", "bar:n=1.5", "bar:axis=2", "bar:axis=0.5",
     "swirl:A=1.5", "swirl:A=-1.6", "swirl:B=0.3", "swirl:B=-0.4", "swirl:L=0"],
)  # fmt: skip
def test_bad_parameters(text: str) -> None:
    with pytest.raises(ValueError, match=r"must be"):
        create("mpm_verify.mms.solutions", text)


def test_the_ring_keeps_its_stretches_below_its_bound() -> None:
    """The bound on A is the one at which the hoop stretch vanishes: just below it, det F is above zero and small."""
    _, _, exact = made("expanding_ring:A=0.38")
    X = np.concatenate([circle(R)[0] for R in np.linspace(0.4, 0.6, 21)])
    J = [np.linalg.det(exact.F(X, t)).min() for t in np.linspace(0, 0.02, 41)]
    assert 0 < min(J) < 0.05


def over_frames(method: str, solution: str, cells: int, frames: int = 16) -> float:
    """Error of u, its rms over the particles and over output steps that are spread over the run."""
    model, comparison, steps = setup(Run(method, solution, "neo_hookean", cells))
    chosen, squares = {round(steps * k / frames) for k in range(1, frames + 1)}, []
    for _ in range(steps):
        advance(model, comparison)
        if model.steps in chosen:
            p = model.particles
            squares.append(((p.x - comparison.exact.x(p.X, model.time)) ** 2).sum(axis=1).mean())
    return float(np.sqrt(np.mean(squares)))


DIGITS = [  # of programs that were written apart from this one, unless said
    ("mpm", "bump", (4.139e-8, 1.079e-8, 2.737e-9)),
    ("bspline2", "bump", (8.378e-8, 1.864e-8, 4.595e-9)),
    ("mpm", "clamped_shear:G=1e-6", (7.253e-8, 1.787e-8, 4.415e-9)),
    ("gimp", "bump:A=0.05", (4.772e-3, 1.145e-3)),  # the other program: 4.779e-3 1.147e-3
    ("mpm", "bump:A=0.05", (6.970e-3, 6.164e-3)),
]


@pytest.mark.parametrize(("method", "solution", "errors"), DIGITS)
def test_digits_of_other_programs(method: str, solution: str, errors: tuple[float, ...]) -> None:
    """Four digits on 8, 16 and 32 cells: bump has no wall, so a grid of another width gives the same."""
    measured = [over_frames(method, solution, cells) for cells in (8, 16, 32)[: len(errors)]]
    assert [float(f"{error:.3e}") for error in measured] == list(errors)
