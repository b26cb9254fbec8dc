"""Cells that fill a body: square or cubic, counted on its width, and whole numbers of them on its other sides."""

from fractions import Fraction
from itertools import pairwise
from math import ceil, floor, lcm, log
from typing import Any

BOXES = {2: "rectangle", 3: "box"}
MOST = 64  # parts that the width may be cut into
ROWS = 2  # rows of cells, at the least
COARSER, FINER = 0.85, 4  # factors to the usual cells: with more a study takes another sort of time


def ratios(solution: Any) -> tuple[Fraction, ...] | None:
    """Other sides of the body's box over its width, none of a line; None where one is no ratio of small numbers."""
    width, *others = (float(side) for side in solution.upper - solution.lower)
    found = tuple(Fraction(side / width).limit_denominator(MOST) for side in others)
    near = (abs(f - side / width) <= 1e-9 * side / width for f, side in zip(found, others, strict=True))
    return found if all(near) else None


def unit(sides: tuple[Fraction, ...]) -> int:
    """Number of cells on the width whose multiples fill the other sides."""
    return lcm(*(side.denominator for side in sides))


def fitting(solution: Any, usual: tuple[int, ...]) -> tuple[int, ...]:
    """Numbers of cells that fill the body, near the `usual` ones and refined as they are; these where they fit.

    The usual counts are scaled, and rounded to what fits; a scale counts by how unevenly that refines, and by how much
    finer or coarser it ends. Where none will do, the levels are the first multiples of what fits.
    """
    sides = ratios(solution)
    if sides is None or all(fits(count, sides) for count in usual):
        return usual
    whole = unit(sides)
    least = whole * ceil(ROWS / (whole * min(sides)))
    usual = tuple(sorted(set(usual)))
    first = range(least, FINER * usual[0] + 1, whole)
    scales = [count / usual[0] for count in first if count >= COARSER * usual[0]]
    scaled = [tuple(nearest(scale * count, whole) for count in usual) for scale in scales]
    kept = [cells for cells in scaled if all(a < b for a, b in pairwise(cells)) and cells[-1] <= FINER * usual[-1]]
    if not kept:
        return tuple(least + whole * number for number in range(len(usual)))
    return min(kept, key=lambda cells: (uneven(cells, usual) + abs(log(cells[-1] / usual[-1])) / 4, cells))


def fits(count: int, sides: tuple[Fraction, ...]) -> bool:
    """Whether so many cells on the width fill the other sides, which are given over the width."""
    return count % unit(sides) == 0


def nearest(count: float, unit: int) -> int:
    """Multiple of `unit` nearest to a count, at least one."""
    return max(1, floor(count / unit + 0.5)) * unit


def uneven(cells: tuple[int, ...], usual: tuple[int, ...]) -> float:
    """Distance of the most different refinement from the usual one, as a difference of logarithms."""
    steps = zip(pairwise(cells), pairwise(usual), strict=True)
    return max((abs(log(b * p / (a * q))) for (a, b), (p, q) in steps), default=0.0)


def check_cells(name: str, solution: Any, cells: tuple[int, ...]) -> None:
    """Raise ValueError, with what to type, for cells that do not fill the body."""
    sides, extent = ratios(solution), [f"{side:g}" for side in solution.upper - solution.lower]
    if sides is None:
        raise ValueError(
            f"{name}: no square cells fill a {BOXES[len(extent)]} of {' x '.join(extent)}; the ratio of the sides must "
            f"be one of whole numbers up to {MOST}, as in 1 x 0.7"
        )
    wrong = [count for count in cells if not fits(count, sides)]
    if wrong:
        typed, what = ",".join(map(str, fitting(solution, cells))), "height" if len(sides) == 1 else "sides"
        raise ValueError(
            f"{name}: {wrong[0]} cells over the width of {extent[0]} do not fill the {what} of "
            f"{' and '.join(extent[1:])}; take multiples of {unit(sides)}: --cells {typed}"
        )
