"""Time steps of a run: whole ones that fill its duration."""

from math import ceil
from typing import Any


def time_steps(solution: Any, dx: float, courant: float) -> tuple[int, float]:
    """Number of steps of length courant dx / C at most that fill the duration, and their length."""
    steps = ceil(solution.duration / (courant * dx / solution.C) * (1 - 1e-12))
    return steps, solution.duration / steps


def width(solution: Any) -> float:
    """Extent along x, the one that cells are counted along."""
    return float(solution.upper[0] - solution.lower[0])
