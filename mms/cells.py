"""Cells that fill a rectangle: square, counted on its width, and a whole number of them on its height."""

from fractions import Fraction
from itertools import pairwise
from math import ceil, floor, log
from typing import Any

MOST = 64  # parts that the width may be cut into
ROWS = 2  # rows of cells, at the least
COARSER, FINER = 0.85, 4  # factors to the usual cells: with more a study takes another sort of time


def ratio(solution: Any) -> Fraction | None:
    """Height over width of the body's box; None where it is no ratio of small whole numbers."""
    width, height = (float(side) for side in solution.upper - solution.lower)
    found = Fraction(height / width).limit_denominator(MOST)
    return found if abs(found - height / width) <= 1e-9 * height / width else None


def fitting(solution: Any, usual: tuple[int, ...]) -> tuple[int, ...]:
    """Numbers of cells that fill the body, near the `usual` ones and refined as they are; these where they fit.

    The usual counts are scaled, and rounded to what fits; a scale counts by how unevenly that refines, and by how much
    finer or coarser it ends. Where none will do, the levels are the first multiples of what fits.
    """
    sides = ratio(solution)
    if sides is None or all(fits(count, sides) for count in usual):
        return usual
    least = sides.denominator * ceil(ROWS / sides.numerator)
    usual = tuple(sorted(set(usual)))
    first = range(least, FINER * usual[0] + 1, sides.denominator)
    scales = [count / usual[0] for count in first if count >= COARSER * usual[0]]
    scaled = [tuple(nearest(scale * count, sides.denominator) for count in usual) for scale in scales]
    kept = [cells for cells in scaled if all(a < b for a, b in pairwise(cells)) and cells[-1] <= FINER * usual[-1]]
    if not kept:
        return tuple(least + sides.denominator * number for number in range(len(usual)))
    return min(kept, key=lambda cells: (uneven(cells, usual) + abs(log(cells[-1] / usual[-1])) / 4, cells))


def fits(count: int, sides: Fraction) -> bool:
    """Whether so many cells on the width fill the height, where `sides` is height over width."""
    return (count * sides).denominator == 1


def nearest(count: float, unit: int) -> int:
    """Multiple of `unit` nearest to a count, at least one."""
    return max(1, floor(count / unit + 0.5)) * unit


def uneven(cells: tuple[int, ...], usual: tuple[int, ...]) -> float:
    """Distance of the most different refinement from the usual one, as a difference of logarithms."""
    steps = zip(pairwise(cells), pairwise(usual), strict=True)
    return max((abs(log(b * p / (a * q))) for (a, b), (p, q) in steps), default=0.0)


def check_cells(name: str, solution: Any, cells: tuple[int, ...]) -> None:
    """Raise ValueError, with what to type, for cells that do not fill the rectangle."""
    sides = ratio(solution)
    width, height = (float(side) for side in solution.upper - solution.lower)
    if sides is None:
        raise ValueError(
            f"{name}: no square cells fill a rectangle of {width:g} x {height:g}; the ratio of the sides must be "
            f"one of whole numbers up to {MOST}, as in 1 x 0.7"
        )
    wrong = [count for count in cells if not fits(count, sides)]
    if wrong:
        typed = ",".join(map(str, fitting(solution, cells)))
        raise ValueError(
            f"{name}: {wrong[0]} cells over the width of {width:g} do not fill the height of {height:g}; take "
            f"multiples of {sides.denominator}: --cells {typed}"
        )
