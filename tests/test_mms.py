"""Manufactured solutions against finite differences of their own displacement, the compiled kernel against NumPy."""

import inspect
import sys
from dataclasses import fields
from functools import cache
from typing import Any

import numpy as np
import pytest
import sympy as sp
from fixtures_export import PLANE, SOLID

from mpm_verify.mms.exact import ROOM, ROWS
from mpm_verify.mms.hoist import Hoist
from mpm_verify.mms.manufacture import Field, Manufactured, manufacture
from mpm_verify.solver._jit import BLOCK
from mpm_verify.solver.plugins import available, create, load
from mpm_verify.solver.state import Floats

EXTRA = {  # parameters of one's own: other sides, speeds and phases show factors that are one by default
    "axis_aligned": ["phase=0.785", "A=0.2,L=2,C=30,phase=-1.1"],
    "clamped_shear": ["G=0.03,L=0.5,C=40", "G=0.2,L=3"],
    "affine": ["a=-0.2,b=0.15,c=0.2,d=0.1,L=2,C=30"],
    "bump": ["A=0.05", "A=0.1,L=2,C=30"],
    "bar": ["A=0.2,n=2,axis=1,phase=0.6,L=3,C=40"],
    "expanding_ring": ["A=-0.15,inner=1.1,outer=1.9,C=30"],
    "generalised_vortex": ["A=-0.7,rate=2.5,inner=0.5,outer=1.7"],
    "swirl": ["A=-1.2,B=-0.25,L=0.7,C=30"],
}


def parameters(name: str) -> list[str]:
    """Names of the parameters of a solution."""
    return [item.name for item in fields(load("mpm_verify.mms.solutions", name))]


SOLUTIONS = [f"{name}:{extra}".rstrip(":") for name in PLANE for extra in ("", *EXTRA.get(name, []))]
MATERIALS = ["neo_hookean", "neo_hookean:E=70,nu=0.45,rho0=3", "linear_elastic:E=200,nu=0.1,rho0=2"]
every = pytest.mark.parametrize("text", SOLUTIONS)
COMPLEX_STEP = 1e-30
ROTATES = ("generalised_vortex",)  # by an angle that mixes place and time, so sines are left in the kernel


class Case:
    """A solution in a body, with random places inside it and random times."""

    def __init__(self, text: str, material: str = "neo_hookean") -> None:
        self.solution, self.material = (
            create("mpm_verify.mms.solutions", text),
            create("mpm_verify.solver.material", material),
        )
        self.exact: Manufactured = manufacture(self.solution, self.material, self.material.rho0)
        rng = np.random.default_rng(1)
        self.L, self.period = self.solution.L, self.solution.L / self.solution.C
        inside = self.solution.layout(float(self.solution.upper[0] - self.solution.lower[0]) / 32, 4).X
        self.X = rng.permutation(inside)[:60] + 1e-3 * self.L * rng.uniform(-1, 1, (60, 2))
        self.times = [0.0, *(self.solution.duration * rng.random(4))]


@cache
def derived(text: str) -> Case:
    """Derived once for all tests."""
    return Case(text)


@pytest.fixture
def case(text: str) -> Case:
    return derived(text)


STENCIL = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))  # sixth order: at h = 5e-3 of a length truncation is below 1e-9


def in_time(f: Field, X: Floats, t: float, h: float) -> Floats:
    """df/dt."""
    return sum(c * (f(X, t + k * h) - f(X, t - k * h)) for k, c in STENCIL) / h


def in_place(f: Field, X: Floats, t: float, h: float, axis: int) -> Floats:
    """df/dX_axis."""
    e = h * np.eye(2)[axis]
    return sum(c * (f(X + k * e, t) - f(X - k * e, t)) for k, c in STENCIL) / h


def close(a: Floats, b: Floats, tolerance: float, size: float = 0.0) -> None:
    """To a tolerance relative to the largest value, or to `size` where both may vanish."""
    np.testing.assert_allclose(a, b, rtol=0, atol=tolerance * max(np.abs(b).max(), size))


@every
def test_velocity_and_deformation(case: Case) -> None:
    """v and F are the derivatives of u."""
    for t in case.times:
        rate = in_time(case.exact.u, case.X, t, 5e-3 * case.period)
        close(case.exact.v(case.X, t), rate, 1e-8, size=1e-3 * case.solution.C)
        slope = np.stack([in_place(case.exact.u, case.X, t, 2.5e-3 * case.L, axis) for axis in (0, 1)], axis=-1)
        close(case.exact.F(case.X, t), np.eye(2) + slope, 1e-9)
        close(case.exact.x(case.X, t), case.X + case.exact.u(case.X, t), 1e-15)


@pytest.mark.parametrize("material", MATERIALS)
@every
def test_momentum_balance(text: str, material: str) -> None:
    """rho0 (u'' - b) = Div P, with u'' and Div P by finite differences of displacement and stress."""
    case = Case(text, material)
    exact, X = case.exact, case.X
    largest = 0.0
    for t in case.times:
        acceleration = in_time(lambda X, t: in_time(exact.u, X, t, 1e-2 * case.period), X, t, 1e-2 * case.period)
        columns = [in_place(exact.P, X, t, 2.5e-3 * case.L, axis)[:, :, axis] for axis in (0, 1)]
        divergence = columns[0] + columns[1]
        b = exact.b(X, t)
        scale = max(np.abs(acceleration).max(), np.abs(divergence).max() / case.material.rho0)
        # twice a sixth-order stencil of a wave with h = 1/100 of its length: (2 pi / 100)^6 / 140 = 4e-10
        close(acceleration - divergence / case.material.rho0, b, 1e-7, size=scale)
        largest = max(largest, scale)
    assert largest > 0


@pytest.mark.parametrize("material", MATERIALS)
@every
def test_stress_follows_from_the_energy(text: str, material: str) -> None:
    """P = dW/dF by the complex step, and sigma = P F^T / J, zz among them."""
    case = Case(text, material)
    for t in case.times:
        F = np.tile(np.eye(3), (len(case.X), 1, 1))
        F[:, :2, :2] = case.exact.F(case.X, t)
        P = np.empty_like(F)
        for i in range(3):
            for j in range(3):
                moved = F.astype(complex)
                moved[:, i, j] += 1j * COMPLEX_STEP
                components = [[moved[:, a, b] for b in range(3)] for a in range(3)]
                P[:, i, j] = case.material.energy(components, np.log).imag / COMPLEX_STEP
        sigma = P @ F.transpose(0, 2, 1) / np.linalg.det(F)[:, None, None]
        close(case.exact.P(case.X, t), P[:, :2, :2], 1e-11, size=case.material.E * 1e-3)
        close(case.exact.sigma(case.X, t), sigma[:, [0, 1, 2, 0], [0, 1, 2, 1]], 1e-11, size=case.material.E * 1e-3)


@every
def test_boundary_conditions(case: Case) -> None:
    """Fixed: nothing moves on the walls. Roller: nothing moves through them, and no shear pulls along them."""
    s, wall = np.linspace(0, case.L, 41), []
    if case.solution.boundary == "free":
        return no_traction(case)
    assert case.solution.boundary in ("fixed", "roller", "moving"), "a new kind of wall needs its check here"
    for t in (*case.times, 0.37 * case.period):
        for normal in (0, 1):
            for at in (case.solution.lower[normal], case.solution.upper[normal]):
                X = np.empty((len(s), 2))
                X[:, normal], X[:, 1 - normal] = at, s
                u, P = case.exact.u(X, t), case.exact.P(X, t)
                wall.append(np.abs(u).max())
                if case.solution.boundary == "fixed":
                    assert np.abs(u).max() < 1e-15 * case.L
                elif case.solution.boundary == "roller":
                    assert np.abs(u[:, normal]).max() < 1e-15 * case.L
                    assert np.abs(P[:, 1 - normal, normal]).max() < 1e-12 * case.material.E
    inside = max(np.abs(case.exact.u(case.X, t)).max() for t in case.times)
    assert inside > 1e-3 * case.L  # it moves inside, so that the walls mean something
    assert (max(wall) > 0.1 * inside) == (case.solution.boundary != "fixed")


def no_traction(case: Case) -> None:
    """Free edges: P N = 0 in the solution's own material; inside the body is under stress."""
    law = create("mpm_verify.solver.material", case.solution.material)
    exact = manufacture(case.solution, law, law.rho0)
    if not hasattr(case.solution, "inner"):
        return no_traction_on_a_square(case)
    angle = np.linspace(0, 2 * np.pi, 41)
    N = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    for t in case.times[1:]:
        assert np.abs(exact.P(case.X, t)).max() > 1e-3 * law.E
        for R in (case.solution.inner, case.solution.outer):
            assert np.abs(np.einsum("pij,pj->pi", exact.P(R * N, t), N)).max() < 1e-12 * law.E


def no_traction_on_a_square(case: Case) -> None:
    """And the edges rest; so exactly, where X and Y are put into the expressions as symbols."""
    fields, L = case.exact.fields, sp.nsimplify(case.solution.L)
    for symbol in fields.X:
        for at in (0, L):
            exact = [sp.nsimplify(e).subs(symbol, at) for e in (*fields.u, *fields.F)]
            assert [sp.simplify(e) for e in exact] == [0, 0, 1, 0, 0, 1]
    P = [e.xreplace(dict(zip(list(fields.inner)[:4], (1, 0, 0, 1), strict=True))) for e in fields.P]
    assert [float(e) for e in P] == [0, 0, 0, 0]
    strain = np.abs(case.exact.F(case.X, case.times[1]) - np.eye(2)).max()
    assert np.abs(case.exact.P(case.X, case.times[1])).max() > strain * case.material.mu > 0


def test_moving_walls_follow_the_body() -> None:
    """The velocity that affine gives its nodes is that of the material point there, half a step later."""
    case = Case("affine")
    t, dt = 0.3 * case.period, 1e-3 * case.period
    x = case.exact.x(case.X, t)
    nodes = np.concatenate([[[0.0, 0.0], [0.0, 0.1]], x])  # the first two tell the cell size
    held, velocity, rate = case.solution.walls(nodes, t, dt)
    assert held.shape == velocity.shape == rate.shape == nodes.shape
    close(velocity[2:], case.exact.v(case.X, t + dt / 2), 1e-13)
    close(rate[2:], in_time(case.exact.v, case.X, t, 5e-3 * case.period), 1e-8)
    outside = case.solution.walls(np.array([[0, 0], [0, 0.1], [-0.3, 0.5], [0.5, 1.3], [0.5, 0.5]]), t, dt)[0]
    assert outside[2:].tolist() == [[True, True], [True, True], [False, False]]


@pytest.mark.parametrize(
    ("X", "Y", "t", "u", "b"),
    [
        (0.1, 0.2, 0.005, (0.0293892626146, -0.0475528258148), (8125.36371951, -23016.6379476)),
        (0.3, 0.7, 0.0025, (0.0336249255982, 0.0336249255982), (16543.6057253, 12995.4981253)),
        (0.9, 0.35, 0.0012, (-0.0108189091537, -0.0148909509584), (-3689.33118697, -5285.77425383)),
    ],
)
def test_reference_values(X: float, Y: float, t: float, u: Any, b: Any) -> None:
    """Recorded values: L = 1, A = 0.05, C = 100, E = 1e4, nu = 0.3, rho0 = 1."""
    exact = manufacture(
        create("mpm_verify.mms.solutions", "axis_aligned"), create("mpm_verify.solver.material", "neo_hookean"), 1.0
    )
    np.testing.assert_allclose(exact.u(np.array([[X, Y]]), t)[0], u, rtol=1e-9)
    np.testing.assert_allclose(exact.b(np.array([[X, Y]]), t)[0], b, rtol=1e-9)


@pytest.mark.parametrize(
    ("material", "count"),
    [
        *(pytest.param(m, BLOCK, marks=[pytest.mark.slow] if m != MATERIALS[0] else []) for m in MATERIALS),
        (MATERIALS[0], 1),
        (MATERIALS[0], BLOCK - 1),
    ],
)
@every
def test_compiled_kernel(text: str, material: str, count: int) -> None:
    """Row by row what the NumPy functions give, v at a time of its own; places beyond the block stay untouched."""
    case = Case(text, material)
    kernel, X = case.exact.kernel, case.X[:count]
    for t in case.times:
        behind = 0.01 * case.period
        out = np.full(ROOM * BLOCK, np.nan)
        kernel.fill(kernel.columns(X).ravel(), kernel.scalars(t, t - behind), count, out)
        rows = out.reshape(ROOM, BLOCK)
        for name, of in ROWS.items():
            at = t - behind if name == "v" else t
            values = getattr(case.exact, name)(X, at).reshape(count, -1)
            size = {"sigma": case.material.E, "b": 1e-3 * case.solution.C**2 / case.L}.get(name, 1e-3)
            close(rows[list(of), :count].T, values, 1e-12, size=size)
        assert np.isnan(rows[:, count:]).all()


@every
def test_source_of_the_kernel(case: Case) -> None:
    """No powers, which Numba makes loops of, and nothing left in it that depends on the place or the time alone.

    A rotation by an angle that mixes both leaves its sines there.
    """
    module = sys.modules[case.exact.kernel.fill.py_func.__module__]
    source = inspect.getsource(module)
    assert "def exact(c, s, n, out)" in source
    rotates = type(case.solution).__module__.endswith(ROTATES)
    for word in ("**", "pow") + (() if rotates else ("sin", "cos")):
        assert word not in source
    assert not rotates or all(call.startswith(("(v", "(w", "(c")) for call in source.split("math.sin")[1:])


@every
def test_columns_depend_on_the_place_alone(case: Case) -> None:
    """And scalars on the times alone: rows of X permuted permute the columns, and the shapes do not change."""
    kernel = case.exact.kernel
    table, order = kernel.columns(case.X), np.random.default_rng(3).permutation(len(case.X))
    np.testing.assert_array_equal(kernel.columns(case.X[order]), table[order])
    assert table.flags.c_contiguous
    assert len(table) == len(case.X)
    assert kernel.scalars(0.1, 0.2).shape == kernel.scalars(0.0, 0.0).shape
    assert np.isfinite(table).all()


def test_hoist() -> None:
    """Columns hold X and Y, scalars the times, the rest neither; and put together again they are the expression."""
    X, Y, t, s = sp.symbols("X Y t s", real=True)
    expressions = [
        3 * sp.sin(2 * X) * sp.cos(Y) * sp.sin(t) + sp.cos(t + s),
        1 + X * sp.exp(t * X),
        -4 * sp.sin(2 * X) * sp.cos(Y) / (1 + sp.sin(t) * Y),
        sp.log(1 + t * X) ** 2 + sp.pi,
    ]
    hoist = Hoist((X, Y), (t, s))
    hoisted = [hoist(e) for e in expressions]
    assert all(e.free_symbols <= {X, Y} for e in hoist.columns)
    assert all(e.free_symbols <= {t, s} for e in hoist.scalars)
    back = {symbol: e for e, symbol in {**hoist.columns, **hoist.scalars}.items()}
    numbers = {X: 0.3, Y: 0.7, t: 0.11, s: -0.4}
    for before, after in zip(expressions, hoisted, strict=True):
        assert not after.free_symbols & {X, Y, t, s}
        assert float(after.xreplace(back).subs(numbers)) == pytest.approx(float(before.subs(numbers)), rel=1e-14)
    assert len([e for e in hoist.columns if e == sp.sin(2 * X) * sp.cos(Y)]) == 1  # shared by two expressions


@pytest.mark.parametrize(
    "text",
    ["axis_aligned:A=0.16", "axis_aligned:A=-0.2", "axis_aligned:A=0.1,L=0.5", "clamped_shear:G=0.2", "affine:a=0.3",
     "bump:A=0.123", "bump:A=-0.3,L=2",
     *(f"{name}:{size}={bad}" for name in available("mpm_verify.mms.solutions") for size in ("L", "C", "inner", "outer")
       if size in parameters(name) for bad in ("0", "-1", "nan"))],
)  # fmt: skip
def test_bad_parameters(text: str) -> None:
    with pytest.raises(ValueError, match="must be"):
        create("mpm_verify.mms.solutions", text)


@pytest.mark.parametrize("name", [*PLANE, *SOLID])
def test_the_body_never_turns_inside_out(name: str) -> None:
    """At the bounds of the parameters and below, det F > 0 everywhere and always."""
    solution = load("mpm_verify.mms.solutions", name)()
    exact = manufacture(solution, create("mpm_verify.solver.material", "neo_hookean"), 1.0)
    X = solution.layout(float(solution.upper[0] - solution.lower[0]) / 20, 8 if name in SOLID else 4).X
    J = [np.linalg.det(exact.F(X, t)).min() for t in np.linspace(0, solution.duration, 33)]
    assert min(J) > 0.3
