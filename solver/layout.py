"""Layouts of particles at the start, whose domains tile a body without gaps or overlaps."""

from dataclasses import dataclass
from math import pi

import numpy as np

from mpm_verify.solver.state import Floats, Ints

Offset = tuple[float, float]
CENTRED: Offset = (0.0, 0.0)
SIDES = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])  # corners by half sides, counter-clockwise


@dataclass(frozen=True)
class Layout:
    """Reference positions and domains of P particles.

    Parameters
    ----------
    X
        Reference positions (P,2), or (P,3), or (P,1).
    V0
        Areas (P,), or volumes or lengths, of the parallelograms of `r0`, and of the pieces of the body that the
        particles stand for; in axisymmetry volumes per radian.
    r0
        Half side vectors (P,2,2), or (P,3,3), or (P,1,1), one a row.
    bent
        Corners (P,4,2) of those pieces where they are not the parallelograms.
    """

    X: Floats
    V0: Floats
    r0: Floats
    bent: Floats | None = None

    def __len__(self) -> int:
        return len(self.X)

    @property
    def corners(self) -> Floats:
        """Corners (P,4,2) of the pieces, counter-clockwise; adjacent pieces share them."""
        return parallelograms(self.X, self.r0) if self.bent is None else self.bent


def shared_corners(layout: Layout) -> tuple[Floats, Ints]:
    """Corners of all pieces, each once.

    Parameters
    ----------
    layout
        Layout of P pieces.

    Returns
    -------
    positions : ndarray
        Reference positions (C,2) of the corners.
    number : ndarray
        Which four of them belong to each piece, (P,4).
    """
    corners = layout.corners.reshape(-1, 2)
    quantum = 1.047e-7 * np.ptp(corners, axis=0).max()  # an odd one: a corner half-way between two would be two
    steps = np.rint((corners - corners.min(axis=0)) / quantum).astype(np.int64)
    _, first, number = np.unique(steps @ (1 << 32, 1), return_index=True, return_inverse=True)
    return corners[first], number.reshape(-1, 4)


def parallelograms(centre: Floats, r: Floats) -> Floats:
    """Corners (P,4,2) of the parallelograms with half side vectors r (P,2,2), one a row."""
    corners: Floats = centre[:, None, :] + np.einsum("cs,psa->pca", SIDES, r)
    return corners


def per_side(ppc: int, dimension: int = 2) -> int:
    """Particles along a side of a cell with `ppc` of them. Raises ValueError unless that is a square, or cube, number.

    A cell has as many sides as the `dimension` says.
    """
    side: int = round(max(ppc, 0) ** (1 / dimension))
    if side < 1 or side**dimension != ppc:
        power, choices = (("whole", "1, 2, 3, 4"), ("square", "1, 4, 9, 16"), ("cube", "1, 8, 27, 64"))[dimension - 1]
        raise ValueError(f"{ppc} particles per cell is not a {power} number; choose {choices}, ...")
    return side


def rectangle(lower: Floats, upper: Floats, dx: float, ppc: int, offset: Offset = CENTRED) -> Layout:
    """Regular layout of a rectangle, column by column, or of a block.

    Parameters
    ----------
    lower, upper
        Corners of the rectangle or block, (d,).
    dx
        Side of a grid cell.
    ppc
        Particles in each cell, a square number; of a block a cube number, of a line any number.
    offset
        Shift of all faces between particles along x and y, as a fraction of their spacing, each in (-1/2, 1/2). The
        body's own edges stay, so the first and last domains are wider or narrower. A block takes none.

    Returns
    -------
    Layout
        Rectangular domains.

    Raises
    ------
    ValueError
        For another `ppc` or offset.
    """
    step, shift = dx / per_side(ppc, len(lower)), (*offset, 0.0)
    return graded([faces(lower[a], upper[a], step, shift[a]) for a in range(len(lower))])


def faces(first: float, last: float, step: float, offset: float) -> Floats:
    """Coordinates (n+1,) of the faces between n particles on one axis, the ends included."""
    if not -0.5 < offset < 0.5:
        raise ValueError(f"an offset of {offset} spacings must lie between -0.5 and 0.5")
    count = int(np.rint((last - first) / step))
    positions: Floats = first + step * (np.arange(count + 1, dtype=np.float64) + offset)
    positions[0], positions[-1] = first, last
    return positions


def graded(edges: list[Floats]) -> Layout:
    """Layout of rectangles between faces, column by column.

    Parameters
    ----------
    edges
        Coordinates of the faces on each axis, (n+1,) each.
    """
    d = len(edges)
    centre = np.stack(np.meshgrid(*[(e[1:] + e[:-1]) / 2 for e in edges], indexing="ij"), axis=-1).reshape(-1, d)
    half = np.stack(np.meshgrid(*[np.diff(e) / 2 for e in edges], indexing="ij"), axis=-1).reshape(-1, d)
    r0 = half[:, :, None] * np.eye(d)
    return Layout(centre, 2.0**d * half.prod(axis=1), r0)


def annulus(inner: float, outer: float, dx: float, ppc: int) -> Layout:
    """Layout of rings around the origin, each cut into the same number of pieces, so that corners meet.

    Ring by ring outwards. A piece has its exact area; its position is at the middle of its radii and angles.

    Parameters
    ----------
    inner, outer
        Radii of the body.
    dx
        Side of a grid cell.
    ppc
        Particles in each cell, a square number: their spacing is that of the pieces, radially and, at the middle
        radius, on the circle.

    Returns
    -------
    Layout
        Pieces with bent corners.

    Raises
    ------
    ValueError
        Unless `ppc` is a square number.
    """
    step = dx / per_side(ppc)
    rings = max(1, round((outer - inner) / step))
    pieces = max(8, round(pi * (outer + inner) / step))
    R, wide = np.linspace(inner, outer, rings + 1), 2 * pi / pieces
    middle, centre = np.meshgrid((R[1:] + R[:-1]) / 2, wide * (np.arange(pieces) + 0.5), indexing="ij")
    radius, angle = middle.ravel(), centre.ravel()
    out = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    round_ = np.stack([-out[:, 1], out[:, 0]], axis=-1)
    thick = (outer - inner) / rings
    r0 = np.stack([0.5 * thick * out, (0.5 * wide * radius)[:, None] * round_], axis=1)
    corner_radius = radius[:, None] + 0.5 * thick * SIDES[:, 0]
    corner_angle = angle[:, None] + 0.5 * wide * SIDES[:, 1]
    corners = corner_radius[..., None] * np.stack([np.cos(corner_angle), np.sin(corner_angle)], axis=-1)
    return Layout(radius[:, None] * out, thick * wide * radius, r0, corners)
