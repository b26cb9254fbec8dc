"""Check of a user's solution: smooth, finite, F invertible everywhere and always, a boundary that the solver has."""

from typing import Any

import numpy as np
import sympy as sp

from mpm_verify.mms.cells import check_cells
from mpm_verify.mms.components import at, square
from mpm_verify.mms.discretisation import axisymmetric, dimension, grid_box, width
from mpm_verify.mms.edges import Edges, examine, lattice
from mpm_verify.mms.manufacture import manufacture
from mpm_verify.mms.measure import Sampler, WaveMaterial, filled, largest
from mpm_verify.mms.solutions._own import HELD, sides, symbols
from mpm_verify.solver.state import Floats

POINTS, TIMES = {1: 257, 2: 33, 3: 9}, 33  # on a side and over the duration, for what has to be finite
FINE, SOLID_FINE = (49, 97, 97), (17, 25, 25, 25)  # times and positions that look for the least det F
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
    check_axis(name, solution)
    check_cells(name, solution, cells)
    smooth(name, solution)
    exact = manufacture(solution, material, material.rho0)  # type: ignore[arg-type]
    sampler = Sampler(exact)
    times = np.linspace(0.0, solution.duration, TIMES)
    X = lattice(solution, POINTS[dimension(solution)])
    s = sampler(X, times)
    for quantity, values in (("u", s.u), ("v", s.v), ("F", s.F), ("the acceleration", s.acceleration)):
        finite(name, quantity, values, X, times)
    if largest(s.u) == 0:
        raise ValueError(f"{name}: nothing moves, u = 0 everywhere")
    invertible(name, solution, sampler)
    for quantity, values in (("the stress", s.sigma), ("the body force", s.b)):
        finite(name, quantity, values, X, times)
    kinds = sides(solution)
    if "moving" not in kinds:
        edges = examine(solution, exact, material)
        check_on_axis(name, solution, kinds, edges)
        if wrong := edges.wrong(kinds):
            raise ValueError(f"{name}: {wrong}")
    check_room(name, solution, cells)


def check_axis(name: str, solution: Any) -> None:
    """Raise ValueError where an axisymmetric body has not the coordinates radius and axis, from the axis outwards."""
    if axisymmetric(solution) and (dimension(solution) != 2 or solution.lower[0] < 0):
        raise ValueError(
            f"{name}: an axisymmetric body has a radius and an axis: lower and upper are two numbers each, and "
            "that of lower is a radius of 0 or more"
        )


def check_on_axis(name: str, solution: Any, kinds: tuple[str, ...], edges: Edges) -> None:
    """Raise ValueError where the motion has a kink on the axis, or something is to hold or pull there."""
    if not axisymmetric(solution) or solution.lower[0] > 0:
        return
    axis = edges.sides[0]
    if "roller" not in edges.possible(axis):
        wrong = edges.told(axis, edges.miss(axis, "roller")[1])
        raise ValueError(
            f"{name}: the left edge is the axis, where the radial displacement and the shear traction vanish, as of a "
            f"u_x that is odd in the radius and a u_y that is even; its {wrong}"
        )
    if kinds[0] not in HELD:
        raise ValueError(f"{name}: the left edge is the axis and cannot be {kinds[0]}: name it roller")


def check_room(name: str, solution: Any, cells: tuple[int, ...]) -> None:
    """Raise ValueError where the grid beside an inner edge that moves would reach beyond the axis."""
    for count in cells if axisymmetric(solution) else ():
        if (reached := grid_box(solution, width(solution) / count)[0][0]) < 0:
            raise ValueError(
                f"{name}: with {count} cells the grid beside the inner edge, which moves, begins at a radius of "
                f"{reached:.3g}; take more cells, or a larger radius in lower"
            )


def smooth(name: str, solution: Any) -> None:
    """Raise ValueError for functions that lack a derivative, or that the compiled kernel does not know."""
    u = solution.displacement(*symbols(solution))
    for component, node in ((c, node) for c in u for node in sp.preorder_traversal(c)):
        if component.has(sp.nan, sp.zoo, sp.oo, sp.I) or not isinstance(node, NODES):
            allowed = ", ".join(f.__name__ for f in SMOOTH)
            raise ValueError(f"{name}: displacement has {str(node)[:60]}; use numbers, powers, sqrt and {allowed}")


def finite(name: str, quantity: str, values: Floats, X: Floats, times: Floats) -> None:
    """Raise ValueError with the first time and a position where `values` (T,P,...) are not finite."""
    bad = ~np.isfinite(values.reshape(len(times), len(X), -1)).all(axis=-1)
    if bad.any():
        k, p = np.argwhere(bad)[0]
        raise ValueError(f"{name}: {quantity} is not finite at {where(X[p], times[k])}")


def where(X: Floats, t: float) -> str:
    """Text of a reference position and a time."""
    return f"{at(X, 6)}, t = {t:.6g}"


def invertible(name: str, solution: Any, sampler: Sampler) -> None:
    """Raise ValueError where det F, at its least, is not above zero."""
    least, J = least_det(solution, sampler)
    if not J > LEAST_DET:
        raise ValueError(f"{name}: F is not invertible: det F = {J:.3g} at {where(least[1:], least[0])}")


def least_det(solution: Any, sampler: Sampler) -> tuple[Floats, float]:
    """Point (t, X, Y) and det F where it is least: the lowest of the sampled minima, each followed to its bottom.

    There are as many coordinates as the solution has.
    """
    from scipy.ndimage import minimum_filter
    from scipy.optimize import minimize

    low = np.array([0.0, *solution.lower])
    high = np.array([solution.duration, *solution.upper])
    counts = SOLID_FINE if dimension(solution) == 3 else FINE[: len(low)]
    axes = [np.linspace(0.0, 1.0, count) for count in counts]
    J = determinant(sampler, low, high, *np.meshgrid(*axes, indexing="ij", sparse=True))
    bottoms = np.argwhere(minimum_filter(J, size=3) == J)
    lowest = bottoms[np.argsort(J[tuple(bottoms.T)], kind="stable")[:STARTS]]
    best, least = lowest[0] / (np.array(counts) - 1), float(J[tuple(lowest[0])])
    for start in lowest / (np.array(counts) - 1):
        found = minimize(
            lambda at: float(determinant(sampler, low, high, *at)), start, bounds=[(0, 1)] * len(low), method="L-BFGS-B"
        )
        if found.fun < least:
            best, least = found.x, float(found.fun)
    return low + best * (high - low), least


def determinant(sampler: Sampler, low: Floats, high: Floats, *at: Any) -> Floats:
    """Determinant of F at fractions `at` of the duration and of the sides."""
    t, X, *rest = (low[a] + at[a] * (high[a] - low[a]) for a in range(len(low)))
    X = np.maximum(X, sampler.least)
    F = filled(sampler.F(X, *rest, t), np.broadcast_shapes(*(np.shape(one) for one in (t, X, *rest))))
    if len(low) != 3:
        return np.linalg.det(square(F))
    J: Floats = F[..., 0] * F[..., 3] - F[..., 1] * F[..., 2]
    return J * F[..., 4] if F.shape[-1] == 5 else J
