"""Shape of a heap by the positions of its particles: front, connected part, surfaces, height at the wall, crowding.

`surface`, the recorded one, is the height below which 99 % of the mass of a strip lies. That is too low: by a hundredth
where the top is level, and by the half spacing between a centre and the edge of what it stands for. `levelled` mends
both: mass is spread over squares of the area J V0, and the heights of some fractions of it are extrapolated to all of
it. It is exact where the density of the upper two fifths is even, whatever it is, and the top falls evenly.
`by_volume` is the volume J V0 over the width of a strip: what the heap would be if particles took their own volume.
"""

from math import ceil
from typing import Any

import numpy as np
from scipy import ndimage

from mpm_verify.solver.state import Floats

FRACTION = 0.99  # of the mass of a strip, below its height
ABOVE = 0.05  # of it, above the heights from which the levelled top is extrapolated
ROWS = 4  # of a strip's width, in which heights are interpolated


def quantile(x: Floats, m: Floats, fraction: float) -> float:
    """Position below which this fraction of the mass lies."""
    order = np.argsort(x)
    below = np.cumsum(m[order])
    return float(x[order[np.searchsorted(below, fraction * below[-1])]])


def connected(x: Floats, side: float) -> Any:
    """Mask of the particles (P,) of the heap that reaches the wall, by squares that touch."""
    cell = np.maximum(np.floor(x / side).astype(int), 0)
    there = np.zeros(cell.max(axis=0) + 1, dtype=bool)
    there[cell[:, 0], cell[:, 1]] = True
    labels, _ = ndimage.label(there, np.ones((3, 3)))
    number = labels[cell[:, 0], cell[:, 1]]
    at_wall = number[cell[:, 0] == cell[:, 0].min()]
    return number == np.bincount(at_wall).argmax()


def surface(x: Floats, m: Floats, strip: float, strips: int) -> Floats:
    """Height (strips,) below which FRACTION of the mass of each strip lies; zero where there is none."""
    number, heights = np.clip((x[:, 0] / strip).astype(int), 0, strips - 1), np.zeros(strips)
    order = np.argsort(number, kind="stable")
    bounds = np.searchsorted(number[order], np.arange(strips + 1))
    for k in range(strips):
        rows = order[bounds[k] : bounds[k + 1]]
        if len(rows):
            heights[k] = quantile(x[rows, 1], m[rows], FRACTION)
    return heights


def levelled(x: Floats, m: Floats, V: Floats, strip: float, strips: int) -> Floats:
    """Mean height (strips,) of the top of each strip, zero where there is none: its sum by the width is the area.

    The last two strips, which the heap may fill in part, have the height of their mass at the density before them.
    """
    mass = masses(x, m, V, strip, strips)
    below, found = np.cumsum(mass, axis=1), np.zeros(strips)
    whole = below[:, -1]
    there = np.flatnonzero(whole > 1e-9 * m.mean())
    found[there] = strip / ROWS * extrapolated(below[there] / whole[there, None], ROWS / 4)
    for k in there[-2:] if len(there) > 2 else ():
        found[k] = whole[k] * found[there[-3]] / whole[there[-3]]
    return found


def extrapolated(below: Floats, slack: float) -> Floats:
    """Height (n,) of the top, in rows, from the fractions (n,rows) of the mass that are below the upper ends of rows.

    A line through eight heights, of ABOVE to eight times that from the top, goes on to all of the mass. They are lower,
    and fewer, where `slack`, by which the top may lie below its mean, is more than ABOVE of the height.
    """
    high = height_of(below, np.full((len(below), 1), 1 - ABOVE))
    above = np.clip(slack / high, ABOVE, 0.5)
    count, k = np.minimum(8, np.floor(1 / above)), np.arange(1, 9)
    weights = (4 * count + 2 - 6 * k) / (count * (count - 1))  # of a straight line by least squares, at k = 0
    found: Floats = (np.where(k <= count, weights, 0) * height_of(below, 1 - above * k)).sum(axis=1)
    return found


def height_of(below: Floats, fraction: Floats) -> Floats:
    """Heights (n,k), in rows, below which fractions (n,k) of the mass lie, at least a hair; mass is even in a row."""
    below, fraction = np.insert(below, 0, 0.0, axis=1), np.maximum(fraction, 1e-12)
    row = (below[:, None] < fraction[..., None]).sum(axis=2).clip(1, below.shape[1] - 1)
    low, high = (np.take_along_axis(below, row - shift, axis=1) for shift in (1, 0))
    found: Floats = row - 1 + (fraction - low) / (high - low)
    return found


def masses(x: Floats, m: Floats, V: Floats, strip: float, strips: int) -> Floats:
    """Mass (strips,rows) of particles spread over the squares of their volumes; ROWS rows are as high as a strip."""
    half, row = squares(V, strip) / 2, strip / ROWS
    column, across = overlaps(x[:, 0], half, strip, strips)
    rows = ceil(float((x[:, 1] + half).max()) / row) + 1
    level, upright = overlaps(x[:, 1], half, row, rows)
    found = np.zeros(strips * rows)
    for k, width in zip(column.T, across.T, strict=True):
        for j, height in zip(level.T, upright.T, strict=True):
            found += np.bincount(k * rows + j, m * width * height, len(found))
    return found.reshape(strips, rows)


def by_volume(x: Floats, V: Floats, strip: float, strips: int) -> Floats:
    """Volume (P,) over the width of each strip (strips,), of squares that may lie in several: sums are kept."""
    column, across = overlaps(x[:, 0], squares(V, strip) / 2, strip, strips)
    found: Floats = np.bincount(column.ravel(), (V[:, None] * across).ravel(), strips) / strip
    return found


def squares(V: Floats, strip: float) -> Floats:
    """Side (P,) of the square of each particle's volume; at most a strip, which bounds what one can cover."""
    return np.clip(np.sqrt(np.maximum(np.nan_to_num(V), 0)), 1e-6 * strip, strip)


def overlaps(x: Floats, half: Floats, size: float, count: int) -> tuple[Any, Floats]:
    """Cells (P,n) that the intervals x - half to x + half touch, and the fraction (P,n) of each interval in them.

    What is outside of all cells counts for the first or the last.
    """
    low, high = (x - half) / size, (x + half) / size
    first = np.floor(low)
    cell = first[:, None] + np.arange(int((np.floor(high) - first).max()) + 1)
    part = np.minimum(high[:, None], cell + 1) - np.maximum(low[:, None], cell)
    return np.clip(cell, 0, count - 1).astype(int), np.maximum(part, 0) / (high - low)[:, None]


def at_wall(heights: Floats, strip: float) -> float:
    """Height at the wall: a line through the heights of strips, by repeated medians, extrapolated to x = 0.

    Right of a straight surface, whatever up to half of the strips less one hold.

    References
    ----------
    Siegel, Biometrika 69 (1982) 242, doi:10.1093/biomet/69.1.242.
    """
    x = strip * (np.arange(len(heights)) + 0.5)
    others = ~np.eye(len(x), dtype=bool)
    rise, run = np.subtract.outer(heights, heights), np.subtract.outer(x, x)
    slopes = [np.median(rise[k, others[k]] / run[k, others[k]]) for k in range(len(x))]
    return float(np.median(heights - np.median(slopes) * x))


def crowding(x: Floats, V: Floats, side: float) -> float:
    """Volume over space, in squares that have particles and such a square above them; NaN where there are none."""
    cell = np.maximum(np.floor(x / side + 1e-9).astype(int), 0)
    volume = np.zeros((cell[:, 0].max() + 1, cell[:, 1].max() + 2))
    np.add.at(volume, (cell[:, 0], cell[:, 1]), V)
    within = (volume[:, :-1] > 0) & (volume[:, 1:] > 0)
    return float(volume[:, :-1][within].mean() / side**2) if within.any() else float("nan")
