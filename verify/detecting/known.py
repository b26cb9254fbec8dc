"""Known answers of what the numbers rest on: norms against plain NumPy, exact fields against differences of them."""

from typing import Any

import numpy as np

from mpm_verify.cases.judging.records import Outcome
from mpm_verify.cases.mms.exact import manufactured
from mpm_verify.cases.mms.norms import Norms, compare, new_sums
from mpm_verify.cases.mms.run import QUANTITIES
from mpm_verify.mms.components import AXES, COMPONENTS, square
from mpm_verify.mms.discretisation import axisymmetric, time_steps
from mpm_verify.mms.manufacture import Field, Manufactured
from mpm_verify.solver.plugins import SOLUTIONS, create
from mpm_verify.solver.state import Floats, Particles

Answer = tuple[str, str]
DERIVED = ("axis_aligned", "clamped_shear", "swirl", "generalised_vortex", "bar1d", "cylinder_rz")
STEP, CLOSE = 2e-4, 1e-5  # of differences, and of what they find


def first_wrong(found: dict[str, float], bound: float) -> Answer:
    """FAIL with the name of the first distance above the bound, or PASS."""
    wrong = next((name for name, distance in found.items() if not distance <= bound), "")
    return (str(Outcome.FAIL), wrong) if wrong else (str(Outcome.PASS), "")


def distance(found: Floats, expected: Floats) -> float:
    """Largest difference over the largest number."""
    return float(np.abs(found - expected).max() / max(float(np.abs(expected).max()), 1e-300))


def derivation() -> Answer:
    """Velocity, F, P, sigma, body force and volumes of solutions, by differences of displacement and energy."""
    found: dict[str, float] = {}
    for name in DERIVED:
        solution = create(SOLUTIONS, name)
        exact = manufactured(name, solution.material)
        found |= {f"{name}: {key}": value for key, value in residuals(exact, solution)}
        steps, dt = time_steps(solution, 0.01, 0.4)
        found[f"{name}: duration"] = abs(steps * dt / solution.duration - 1)
    return first_wrong(found, CLOSE)


def residuals(exact: Manufactured, solution: Any) -> list[tuple[str, float]]:
    """Distances of each exact field from what it must be."""
    lower, upper = np.asarray(solution.lower), np.asarray(solution.upper)
    d, around = len(lower), axisymmetric(solution)
    X = lower + (upper - lower) * np.random.default_rng(7).uniform(0.1, 0.9, (9, d))
    if hasattr(solution, "inner"):  # a ring
        X = X[:3]
    t, h = 0.31 * float(solution.duration), STEP * float((upper - lower).max())
    k = STEP * float(solution.duration)
    F = np.tile(np.eye(3), (len(X), 1, 1))
    F[:, :d, :d] += np.stack([by_axis(lambda Y: exact.u(Y, t), X, a, h) for a in range(d)], axis=2)
    F[:, 2, 2] += exact.u(X, t)[:, 0] / X[:, 0] if around else 0.0
    P = np.array([piola(exact, f) for f in F])
    sigma = P @ F.transpose(0, 2, 1) / np.linalg.det(F)[:, None, None]
    flat = np.stack([sigma[:, AXES.index(end[0]), AXES.index(end[1])] for end in COMPONENTS[d]], axis=1)
    acceleration = central(lambda s: exact.v(X, s), t, k)
    b, shown = acceleration - divergence(exact, X, t, h, around) / exact.rho0, slice(3 if around else d)
    found = [
        ("v", distance(exact.v(X, t), central(lambda s: exact.u(X, s), t, k))),
        ("F", distance(tensor(exact.F, X, t), F[:, shown, shown])),
        ("P", distance(tensor(exact.P, X, t), P[:, shown, shown])),
        ("sigma", distance(exact.sigma(X, t), flat)),
        ("b", distance(exact.b(X, t), b)),
    ]
    return [*found, ("volume", volume(solution))] if around else found


def tensor(field: Field, X: Floats, t: float) -> Floats:
    """Tensors of a field at X as square matrices."""
    return square(field(X, t).reshape(len(X), -1))


def divergence(exact: Manufactured, X: Floats, t: float, h: float, around: bool) -> Floats:
    """Div P (P,d) by differences; around an axis Div (X P), less the hoop stress, over X."""
    d = X.shape[1]

    def column(Y: Floats, axis: int) -> Floats:
        return tensor(exact.P, Y, t)[:, :d, axis] * (Y[:, :1] if around else 1.0)

    found: Floats = sum(by_axis(lambda Y, a=a: column(Y, a), X, a, h) for a in range(d))
    if around:
        found[:, 0] -= tensor(exact.P, X, t)[:, 2, 2]
        found /= X[:, :1]
    return found


def volume(solution: Any) -> float:
    """Relative distance of 2 pi times the volumes per radian from that of the body, which has a rectangle's section."""
    (inner, below), (outer, above) = solution.lower, solution.upper
    whole = np.pi * (outer**2 - inner**2) * (above - below)
    return float(abs(2 * np.pi * float(solution.layout((outer - inner) / 4, 4).V0.sum()) / whole - 1))


def central(f, t: float, step: float):  # type: ignore[no-untyped-def]
    """Derivative of f at t, of fourth order."""
    return (8 * (f(t + step) - f(t - step)) - (f(t + 2 * step) - f(t - 2 * step))) / (12 * step)


def by_axis(f, X: Floats, axis: int, step: float):  # type: ignore[no-untyped-def]
    """Derivative of a field along an axis of X."""
    along = np.eye(X.shape[1])[axis]
    return central(lambda s: f(X + s * along), 0.0, step)


def piola(exact: Manufactured, F: Floats) -> Floats:
    """First Piola stress (3,3) of F (3,3), by complex steps in the energy."""
    whole = F.astype(complex)
    P = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            moved = whole.copy()
            moved[i, j] += 1e-30j
            P[i, j] = np.imag(exact.material.energy(moved, np.log)) / 1e-30
    return P


def norms() -> Answer:
    """Norms of known errors of 200 particles of unequal volume at three times, and the body force that goes with."""
    exact, rng = manufactured("clamped_shear", "neo_hookean"), np.random.default_rng(11)
    X, V0 = rng.random((200, 2)), rng.uniform(0.3, 2.0, 200)
    p = Particles(X, V0.copy(), V0, np.zeros((200, 0)))
    p.carried = exact.kernel.columns(X)
    made, sums, weight = Norms(200, float(V0.mean())), new_sums(p), V0 / V0.mean()
    squares = {q: [] for q in QUANTITIES}  # type: ignore[var-annotated]
    forces = 0.0
    for t in (0.001, 0.0034, 0.0102):
        e = {q: rng.standard_normal((200, n)) for q, n in {"u": 2, "v": 2, "F": 4, "sigma": 4}.items()}
        p.x, p.v = exact.x(X, t) + e["u"], exact.v(X, t - 1e-4) + 10 * e["v"]
        p.F, p.sigma = exact.F(X, t) + e["F"].reshape(-1, 2, 2), exact.sigma(X, t) + 1e4 * e["sigma"]
        compare(
            exact.kernel.fill,
            p.carried,
            exact.kernel.scalars(t, t - 1e-4),
            p.X,
            p.x,
            p.v,
            p.F,
            p.sigma,
            p.V0,
            p.b,
            sums,
        )
        made.add(sums)
        forces = max(forces, distance(p.b, exact.b(X, t)))
        for q, size, parts in (("u", 1, 1), ("v", 10, 1), ("F", 1, 1), ("sigma", 1e4, np.array([1, 1, 1, 2]))):
            squares[q].append((parts * (size * e[q]) ** 2).sum(axis=1))
    found = {"b": forces / 10}
    for q, values in made.errors().items():
        square = np.array(squares[q])
        known = {
            "rms": np.sqrt((weight * square).mean()),
            "max": np.sqrt(square.max()),
            "final": np.sqrt((weight * square[-1]).mean()),
            "printed": np.sqrt((weight * square).sum()) / square.size,
        }
        found |= {f"{q} in {name}": abs(values[name] / value - 1) for name, value in known.items()}
    return first_wrong(found, 1e-9)
