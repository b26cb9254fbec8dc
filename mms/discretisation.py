"""Grid and time steps that a solution is run with: cells along the width, steps that fill the duration."""

from math import ceil
from typing import Any

import numpy as np

from mpm_verify.solver.state import Floats


def dimension(solution: Any) -> int:
    """Number of coordinates of a solution: 1, uniaxial strain; 2, plane strain or axisymmetric; or 3."""
    return len(solution.lower)


def axisymmetric(solution: Any) -> bool:
    """Whether the two coordinates of a solution, or of its class, are the radius and the axis."""
    return bool(getattr(solution, "axisymmetric", False))


def width(solution: Any) -> float:
    """Extent of the body's box along x, a length: the one that cells are counted along."""
    return float(solution.upper[0] - solution.lower[0])


def grid_box(solution: Any, dx: float) -> tuple[Floats, Floats]:
    """Lower and upper corner of the grid, (d,) each: the body's box and whole cells of side dx beyond it."""
    below, above = dx * np.ceil(np.broadcast_to(solution.margin, (2, len(solution.lower))) / dx)
    return solution.lower - below, solution.upper + above


def time_steps(solution: Any, dx: float, courant: float, whole: bool = False, multiple: int = 1) -> tuple[int, float]:
    """Number of steps of length courant dx / C at most that fill the duration, a multiple, and their length.

    `whole` steps have that length, and the last one may end later.
    """
    steps = ceil(solution.duration / (courant * dx / solution.C) * (1 - 1e-12) / multiple) * multiple
    if whole:
        return steps, courant * dx / solution.C
    return steps, solution.duration / steps


def output_steps(steps: int, count: int) -> tuple[int, ...]:
    """Output steps: `count` of the numbers 1 to `steps` at most, spread evenly, the last among them."""
    return tuple(sorted({max(1, round(steps * k / count)) for k in range(1, count + 1)}))


def boundary_kinds(solution: Any) -> tuple[str, ...]:
    """Kinds of the sides of a solution, left and right first, which may state one for all."""
    given = solution.boundary
    return (given,) * (2 * dimension(solution)) if isinstance(given, str) else tuple(given)
