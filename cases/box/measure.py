"""Measures of sand in a box: what carries no stress, what the rows carry, where the surface is.

Rows are sevenths of the column's height, the last one open above. Of a row of height h

    weight    sum V sigma_yy / h over the sum of m g r, r rising from 0 at its lower edge to 1 at its upper one
    K         sum V sigma_xx over sum V sigma_yy; K_low of all rows with their middle below two thirds of the height

In equilibrium the first is 1 to round-off where weights are hats and edges of rows are those of cells: the sum of the
forces at the nodes above, whose weights add up to r in the lowest row of cells. Top: in each strip of a cell's width
the mean height of the highest particles, as many as a cell has, and half a cell. All of this is exact for particles of
a regular layout in the stress of their weight.
"""

from math import nan
from typing import Any

import numpy as np

from mpm_verify.cases.box.run import LOW, ROWS, Run
from mpm_verify.solver.model import Model, Observer
from mpm_verify.solver.state import Floats

LOOKS = 400  # of a run
SETTLED = 0.9  # of the duration: from then on looks are averaged, over some periods of the column's own oscillation


def measured(run: Run, x: Floats, m: Floats, V: Floats, sigma: Floats) -> dict[str, Any]:
    """Numbers of particles at x (P,2) with masses m, volumes V and stresses sigma (P,4), and of each row, (ROWS,)."""
    h = run.height / ROWS
    row = np.clip(np.floor(x[:, 1] / h).astype(int), 0, ROWS - 1)
    load = [float((m * np.clip(x[:, 1] / h - k, 0, 1)).sum()) * run.g * h for k in range(ROWS)]
    carried = [np.bincount(row, -V * sigma[:, axis], ROWS) for axis in (0, 1)]
    with np.errstate(all="ignore"):
        weight, K = carried[1] / load, carried[0] / carried[1]
        lowest = carried[1][0] / V[row == 0].sum()
    return {
        "free": float((sigma == 0).all(axis=1).mean()),
        "top": top(run, x) / run.height,
        "largest": float(-sigma[:, 1].min() / lowest) if lowest > 0 else nan,
        "weight": weight,
        "K": K,
        "K_low": float(carried[0][:LOW].sum() / carried[1][:LOW].sum()) if lowest > 0 else nan,
    }


def top(run: Run, x: Floats) -> float:
    """Height of the surface of particles at x (P,2), mean over strips as wide as a cell, with enough in them."""
    strip = np.clip((x[:, 0] / run.dx).astype(int), 0, run.cells - 1)
    heights = (np.sort(x[strip == k, 1])[-run.ppc :] for k in range(run.cells))
    return float(np.mean([y.mean() for y in heights if len(y) == run.ppc])) + 0.5 * run.dx


class Measure(Observer):
    """Observer that measures LOOKS times."""

    def __init__(self, run: Run, steps: int) -> None:
        self.run, self.steps = run, steps
        self.looks: list[dict[str, Any]] = []

    def after_step(self, model: Model) -> None:
        """Look where it is due."""
        if model.steps * LOOKS // self.steps != (model.steps - 1) * LOOKS // self.steps:
            self.look(model)

    def look(self, model: Model) -> None:
        """Measure now."""
        p, grid, memory = model.particles, model.grid, model.material.memory
        V = p.V0 * p.J
        velocity = grid.velocity
        looked = {"t": model.time, **measured(self.run, p.x, p.m, V, p.sigma)}
        moving = 0.5 * float((grid.mass[:, None] * velocity**2).sum())
        looked["moving"] = moving / (float(p.m.sum()) * self.run.g * self.run.height)
        whole = float(p.V0.sum())
        looked["volume"] = float(V.sum()) / whole
        for name, column in {"void": "void", "dilated": "eps_v_p"}.items():
            of = p.history[:, memory.index(column)] if column in memory else np.zeros(len(p))
            looked[name] = float((p.V0 * of).sum()) / whole
        self.looks.append(looked)

    def curves(self) -> dict[str, Floats]:
        """Columns over time (T,), of rows (T,ROWS)."""
        return {name: np.array([look[name] for look in self.looks]) for name in (self.looks[0] if self.looks else ())}


def settled(run: Run, curves: dict[str, Floats]) -> dict[str, float]:
    """Means over the last looks; `largest` is the largest of them. Rows have their number behind the name, from 1."""
    last = curves["t"] > SETTLED * run.duration * (1 + 1e-9)
    found: dict[str, float] = {}
    for name, column in curves.items():
        if name in ("weight", "K"):
            found |= {f"{name}_{k + 1}": float(column[last, k].mean()) for k in range(ROWS)}
        elif name != "t":
            found[name] = float(column[last].max() if name == "largest" else column[last].mean())
    return found
