"""Two columns that say how fine a level is, h and a number of cells: they have to say the same."""

from collections.abc import Sequence
from math import log
from statistics import median

CELLS = ("cells", "nx", "ncells", "n_cells", "num_cells")  # names that mean cells of the grid and nothing else
POWERS = (1, 2, 3)  # cells along a side, in a plane, in space
NEAR = 0.1  # in the logarithm: sizes may be rounded, and meshes not alike


def apart(sizes: Sequence[tuple[float, float]]) -> tuple[int, int, float] | None:
    """Row whose size and number of cells are not those of the others; None where all agree.

    Parameters
    ----------
    sizes
        Cell size h and number of cells of each row of one refinement.

    Returns
    -------
    (int, int, float) or None
        The row, the power of h by which most of the others agree, and that power of h times cells in them.
    """
    tried = [(power, misses(sizes, power)) for power in POWERS]
    if not sizes or min(max(off) for _, (off, _) in tried) <= NEAR:
        return None
    power, (off, usual) = min(tried, key=lambda one: median(one[1][0]))
    return off.index(max(off)), power, usual


def misses(sizes: Sequence[tuple[float, float]], power: int) -> tuple[list[float], float]:
    """Distance of h^power cells of each row from the median of all, in the logarithm, and that median."""
    found = [h**power * cells for h, cells in sizes]
    usual = median(found) if found else 1.0
    return [abs(log(one / usual)) for one in found], usual
