"""Check of a user's solution: smooth, finite, F invertible everywhere and always, a boundary that the solver has."""

from typing import Any

import numpy as np
import sympy as sp

from mpm_verify.mms.cells import check_cells
from mpm_verify.mms.discretisation import dimension
from mpm_verify.mms.edges import examine
from mpm_verify.mms.manufacture import manufacture
from mpm_verify.mms.measure import Sampler, WaveMaterial, filled, largest
from mpm_verify.mms.solutions._own import sides
from mpm_verify.solver.state import Floats

POINTS, TIMES = 33, 33  # on a side and over the duration, for what has to be finite
FINE = (49, 97, 97)  # times and positions that look for the least det F
STARTS = 24  # samples from which the search for the least det F starts
LEAST_DET = 1e-6

SMOOTH = (sp.sin, sp.cos, sp.tan, sp.asin, sp.acos, sp.atan, sp.sinh, sp.cosh, sp.tanh, sp.exp, sp.log)
NODES = (sp.Symbol, sp.Number, sp.NumberSymbol, sp.Add, sp.Mul, sp.Pow, *SMOOTH)


def check(solution: Any, material: WaveMaterial, cells: tuple[int, ...] = ()) -> None:
    """Check that a user's solution is one.

    Sampled, then sought from the samples: what happens within less than a hundredth of the body can be missed.

    Parameters
    ----------
    solution
        Solution of a user's file.
    material
        Constitutive model with an energy.
    cells
        Numbers of cells on the width that a study is to have.

    Raises
    ------
    ValueError
        One line that says what is wrong, and where and when.
    """
    name = str(getattr(solution, "path", type(solution).__name__))
    if dimension(solution) != 2:
        raise ValueError(f"{name}: a solution of your own has two dimensions; lower and upper are two numbers each")
    check_cells(name, solution, cells)
    smooth(name, solution)
    exact = manufacture(solution, material, material.rho0)  # type: ignore[arg-type]
    sampler = Sampler(exact)
    times = np.linspace(0.0, solution.duration, TIMES)
    X = lattice(solution, POINTS)
    s = sampler(X, times)
    for quantity, values in (("u", s.u), ("v", s.v), ("F", s.F), ("the acceleration", s.acceleration)):
        finite(name, quantity, values, X, times)
    if largest(s.u) == 0:
        raise ValueError(f"{name}: nothing moves, u = 0 everywhere")
    invertible(name, solution, sampler)
    for quantity, values in (("the stress", s.sigma), ("the body force", s.b)):
        finite(name, quantity, values, X, times)
    kinds = sides(solution)
    if "moving" not in kinds and (wrong := examine(solution, exact, material).wrong(kinds)):
        raise ValueError(f"{name}: {wrong}")


def smooth(name: str, solution: Any) -> None:
    """Raise ValueError for functions that lack a derivative, or that the compiled kernel does not know."""
    u = solution.displacement(sp.symbols("X Y", real=True), sp.Symbol("t", real=True))
    for component, node in ((c, node) for c in u for node in sp.preorder_traversal(c)):
        if component.has(sp.nan, sp.zoo, sp.oo, sp.I) or not isinstance(node, NODES):
            allowed = ", ".join(f.__name__ for f in SMOOTH)
            raise ValueError(f"{name}: displacement has {str(node)[:60]}; use numbers, powers, sqrt and {allowed}")


def lattice(solution: Any, count: int) -> Floats:
    """Reference positions (count^2, 2) in rows, the edges included."""
    axes = [np.linspace(solution.lower[a], solution.upper[a], count) for a in (0, 1)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)


def finite(name: str, quantity: str, values: Floats, X: Floats, times: Floats) -> None:
    """Raise ValueError with the first time and a position where `values` (T,P,...) are not finite."""
    bad = ~np.isfinite(values.reshape(len(times), len(X), -1)).all(axis=-1)
    if bad.any():
        k, p = np.argwhere(bad)[0]
        raise ValueError(f"{name}: {quantity} is not finite at {where(X[p], times[k])}")


def where(X: Floats, t: float) -> str:
    """Text of a reference position and a time."""
    return f"(X, Y) = ({X[0]:.6g}, {X[1]:.6g}), t = {t:.6g}"


def invertible(name: str, solution: Any, sampler: Sampler) -> None:
    """Raise ValueError where det F, at its least, is not above zero."""
    at, J = least_det(solution, sampler)
    if not J > LEAST_DET:
        raise ValueError(f"{name}: F is not invertible: det F = {J:.3g} at {where(at[1:], at[0])}")


def least_det(solution: Any, sampler: Sampler) -> tuple[Floats, float]:
    """Point (t, X, Y) and det F where it is least: the lowest of the sampled minima, each followed to its bottom."""
    from scipy.ndimage import minimum_filter
    from scipy.optimize import minimize

    low = np.array([0.0, *solution.lower])
    high = np.array([solution.duration, *solution.upper])
    axes = [np.linspace(0.0, 1.0, count) for count in FINE]
    J = determinant(sampler, low, high, *np.meshgrid(*axes, indexing="ij", sparse=True))
    bottoms = np.argwhere(minimum_filter(J, size=3) == J)
    lowest = bottoms[np.argsort(J[tuple(bottoms.T)], kind="stable")[:STARTS]]
    best, least = lowest[0] / (np.array(FINE) - 1), float(J[tuple(lowest[0])])
    for start in lowest / (np.array(FINE) - 1):
        found = minimize(
            lambda at: float(determinant(sampler, low, high, *at)), start, bounds=[(0, 1)] * 3, method="L-BFGS-B"
        )
        if found.fun < least:
            best, least = found.x, float(found.fun)
    return low + best * (high - low), least


def determinant(sampler: Sampler, low: Floats, high: Floats, *at: Any) -> Floats:
    """Determinant of F at fractions `at` of the duration, the width and the height."""
    t, X, Y = (low[a] + at[a] * (high[a] - low[a]) for a in range(3))
    F = filled(sampler.F(X, Y, t), np.broadcast_shapes(np.shape(t), np.shape(X), np.shape(Y)))
    J: Floats = F[..., 0] * F[..., 3] - F[..., 1] * F[..., 2]
    return J
