"""Where particles lie at first: layouts whose domains tile a body without gaps or overlaps."""

from dataclasses import dataclass
from math import isqrt, pi

import numpy as np

from mpm_verify.solver.state import Floats, Ints

Offset = tuple[float, float]
CENTRED: Offset = (0.0, 0.0)
SIDES = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])  # of the corners, counter-clockwise


@dataclass(frozen=True)
class Layout:
    """Reference places X (P,2), volumes V0 (P,), half side vectors r0 (P,2,2) one a row.

    V0 is the area of the parallelogram of r0, and of the piece of the body that the particle stands for. `bent` (P,4,2)
    has the corners of that piece where it is not the parallelogram.
    """

    X: Floats
    V0: Floats
    r0: Floats
    bent: Floats | None = None

    def __len__(self) -> int:
        return len(self.X)

    @property
    def corners(self) -> Floats:
        """Corners (P,4,2) of the pieces, counter-clockwise; neighbours share them."""
        return parallelograms(self.X, self.r0) if self.bent is None else self.bent


def shared_corners(layout: Layout) -> tuple[Floats, Ints]:
    """Places (C,2) of the corners of all pieces, each once, and for each piece which four are its own, (P,4)."""
    corners = layout.corners.reshape(-1, 2)
    quantum = 1.047e-7 * np.ptp(corners, axis=0).max()  # no round number: a corner half-way between two would be two
    steps = np.rint((corners - corners.min(axis=0)) / quantum).astype(np.int64)
    _, first, number = np.unique(steps @ (1 << 32, 1), return_index=True, return_inverse=True)
    return corners[first], number.reshape(-1, 4)


def parallelograms(centre: Floats, r: Floats) -> Floats:
    """Corners (P,4,2) of the parallelograms with half side vectors r (P,2,2), one a row."""
    corners: Floats = centre[:, None, :] + np.einsum("cs,psa->pca", SIDES, r)
    return corners


def per_side(ppc: int) -> int:
    """Particles along a cell's side. Raises ValueError where `ppc` is no square number."""
    side = isqrt(max(ppc, 0))
    if side < 1 or side * side != ppc:
        raise ValueError(f"{ppc} particles per cell is no square number; choose 1, 4, 9, 16, ...")
    return side


def rectangle(lower: Floats, upper: Floats, dx: float, ppc: int, offset: Offset = CENTRED) -> Layout:
    """Regular layout of `ppc` particles in each cell of side `dx`, column by column.

    `offset`, each part in (-1/2, 1/2), shifts all faces between particles by that share of their spacing; the body's
    own edges stay, so the first and last domains are wider or narrower. Raises ValueError for another offset or `ppc`.
    """
    step = dx / per_side(ppc)
    return graded([faces(lower[a], upper[a], step, offset[a]) for a in (0, 1)])


def faces(first: float, last: float, step: float, offset: float) -> Floats:
    """Faces between particles along one axis, the ends included."""
    if not -0.5 < offset < 0.5:
        raise ValueError(f"an offset of {offset} spacings must lie between -0.5 and 0.5")
    count = int(np.rint((last - first) / step))
    places: Floats = first + step * (np.arange(count + 1, dtype=np.float64) + offset)
    places[0], places[-1] = first, last
    return places


def graded(edges: list[Floats]) -> Layout:
    """Rectangles between the given faces along x and y, column by column."""
    centre = np.stack(np.meshgrid(*[(e[1:] + e[:-1]) / 2 for e in edges], indexing="ij"), axis=-1).reshape(-1, 2)
    half = np.stack(np.meshgrid(*[np.diff(e) / 2 for e in edges], indexing="ij"), axis=-1).reshape(-1, 2)
    r0 = half[:, :, None] * np.eye(2)
    return Layout(centre, 4.0 * half.prod(axis=1), r0)


def annulus(inner: float, outer: float, dx: float, ppc: int) -> Layout:
    """Rings around the origin, each cut into the same number of pieces, so that corners meet; ring by ring outwards.

    The spacing is that of `ppc` particles in a cell of side `dx`, along the radius and, at the middle radius, along the
    circle. A piece has its exact area; its place is at the middle of its radii and angles.
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
