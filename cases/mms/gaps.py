"""Gaps and overlaps between adjacent domains, measured while a run goes on."""

from dataclasses import InitVar, dataclass, field

import numpy as np

from mpm_verify.solver.layout import Layout, shared_corners
from mpm_verify.solver.model import Model, Observer
from mpm_verify.solver.state import Floats, Ints

LOOKS = 16  # in a run
PATCHES, PATCH = 8, 200  # particles are looked at in so many patches, and so many in each


@dataclass
class Gaps(Observer):
    """Observer of how far domains are from tiling the body: rms distance of the copies of a corner from their middle.

    Adjacent domains of the layout share corners; where each has its own, there is a gap or an overlap. In units of the
    particle spacing, the largest of all looks, one `every` so many steps. `most` is None for methods that know points
    only.
    """

    layout: InitVar[Layout]
    every: int = 1
    most: float | None = None
    chosen: Ints = field(init=False)  # particles, by their rows in the layout
    owner: Ints = field(init=False)  # of each corner of theirs, (n*4,): which shared corner it is a copy of
    spacing: float = field(init=False)

    def __post_init__(self, layout: Layout) -> None:
        self.chosen, self.spacing = patches(layout.X), float(np.sqrt(layout.V0.mean()))
        bent = None if layout.bent is None else layout.bent[self.chosen]
        part = Layout(layout.X[self.chosen], layout.V0[self.chosen], layout.r0[self.chosen], bent)
        self.owner = shared_corners(part)[1].reshape(-1)

    def after_step(self, model: Model) -> None:
        """Measure after the first step, and when it is time again."""
        if (model.steps - 1) % self.every == 0:
            self.look(model)

    def look(self, model: Model) -> None:
        """Measure now."""
        p, row = model.particles, np.empty(len(model.particles), np.int64)
        row[p.id] = np.arange(len(p))
        rows = row[self.chosen]
        corners = model.basis.corners(p.x[rows], p.F[rows], p.domain[rows], model.grid.dx)
        if corners is not None:
            self.most = max(self.most or 0.0, self.apart(corners.reshape(-1, 2)) / self.spacing)

    def apart(self, corners: Floats) -> float:
        """Root mean square distance of copies (n,2) from the middle of those of their corner."""
        copies = np.bincount(self.owner)
        middle = np.stack([np.bincount(self.owner, corners[:, a]) / copies for a in (0, 1)], axis=-1)
        several = copies[self.owner] > 1
        away = (corners - middle[self.owner])[several]
        return float(np.sqrt(np.mean(np.sum(away**2, axis=1)))) if several.any() else 0.0


def patches(X: Floats) -> Ints:
    """Rows of particles in some patches of the body; all particles where there are few."""
    if len(X) <= PATCHES * PATCH:
        return np.arange(len(X))
    seeds = X[np.linspace(0, len(X) - 1, PATCHES + 2).astype(np.int64)[1:-1]]
    near = [np.argpartition(((X - seed) ** 2).sum(axis=1), PATCH)[:PATCH] for seed in seeds]
    return np.unique(np.concatenate(near))
