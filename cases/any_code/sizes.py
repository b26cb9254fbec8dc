"""Two columns that say how fine a level is, h and a number of cells: they have to say the same."""

from collections.abc import Sequence
from math import log
from statistics import median

CELLS = ("cells", "nx", "ncells", "n_cells", "num_cells")  # names that mean cells of the grid and nothing else
POWERS = (1, 2, 3)  # cells along a side, in a plane, in space
NEAR = 0.1  # in the logarithm: sizes may be rounded, and meshes not alike


def apart(sizes: Sequence[tuple[float, float]]) -> tuple[int, float] | None:
    """Row whose size and number of cells are not those of the others; None where all agree.

    Parameters
    ----------
    sizes
        Cell size h and number of cells of each row.

    Returns
    -------
    (int, float) or None
        The row, and h times cells in the others.
    """
    tried = [furthest(sizes, power) for power in POWERS]
    if not sizes or min(miss for _, miss, _ in tried) <= NEAR:
        return None
    at, _, usual = tried[0]
    return at, usual


def furthest(sizes: Sequence[tuple[float, float]], power: int) -> tuple[int, float, float]:
    """Row whose h^power cells is furthest from the median of all, how far in the logarithm, and that median."""
    found = [h**power * cells for h, cells in sizes]
    usual = median(found) if found else 1.0
    misses = [abs(log(one / usual)) for one in found]
    at = max(range(len(found)), key=misses.__getitem__, default=0)
    return at, max(misses, default=0.0), usual
