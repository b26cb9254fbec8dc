"""Gaps and overlaps between the domains of neighbours, measured while a run goes on."""

from dataclasses import InitVar, dataclass, field

import numpy as np

from mms.manufacture import Manufactured
from solver.layout import Layout
from solver.state import Floats, Ints
from solver.step import Model

LOOKS = 16  # in a run
SAMPLE = 2000  # particles, about


@dataclass
class Gaps:
    """How far domains are from tiling the body: rms distance of their corners from where the exact motion takes them.

    In shares of the particle spacing, the largest of all looks. Neighbours share the corners of the layout, so a corner
    that is not there leaves a gap or overlaps. `most` is None for methods that know points only.
    """

    exact: Manufactured
    layout: InitVar[Layout]
    most: float | None = None
    chosen: Ints = field(init=False)
    corners: Floats = field(init=False)  # of the chosen particles at reference, (n,4,2)
    spacing: float = field(init=False)

    def __post_init__(self, layout: Layout) -> None:
        self.chosen = np.arange(0, len(layout), max(1, len(layout) // SAMPLE))
        self.corners, self.spacing = layout.corners[self.chosen], float(np.sqrt(layout.V0.mean()))

    def look(self, model: Model) -> None:
        """Measure now."""
        p, row = model.particles, np.empty(len(model.particles), np.int64)
        row[p.id] = np.arange(len(p))
        rows = row[self.chosen]
        corners = model.basis.corners(p.x[rows], p.F[rows], p.domain[rows])
        if corners is not None:
            apart = corners - self.exact.x(self.corners.reshape(-1, 2), model.time).reshape(corners.shape)
            distance = float(np.sqrt(np.mean(np.sum(apart**2, axis=-1)))) / self.spacing
            self.most = max(self.most or 0.0, distance)
