"""Edges of a benchmark as another solver reads them: what each holds, what pulls at it, and nodes that are pushed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.benchmark.pressed import Smooth
from mpm_verify.mms.export.case import numbers
from mpm_verify.solver.boundary import MovingWalls
from mpm_verify.solver.friction import FrictionalWalls
from mpm_verify.solver.model import Model
from mpm_verify.solver.pushed import PushedWalls
from mpm_verify.solver.sides import SIDES
from mpm_verify.solver.state import Floats, Grid

Mask = NDArray[np.bool_]
KINDS = {(False, False): "free", (True, False): "roller", (True, True): "fixed"}  # normal and tangential held
FRICTIONAL, PUSHED = "frictional", "pushed"
SLACK = 1e-9  # of a cell


@dataclass(frozen=True)
class EdgeRecord:
    """Side of the grid.

    Parameters
    ----------
    kind
        free, roller, fixed, frictional, or pushed where all of its nodes are; corners left out where others are.
    friction
        Friction coefficient of one that is frictional.
    traction
        Force per reference area on that side of the body, (x, y).
    """

    kind: str
    friction: float
    traction: tuple[float, ...]


@dataclass(frozen=True)
class PushedRecord:
    """Nodes with a given velocity on an axis, that of a travel; they stay where they are.

    Parameters
    ----------
    lower, upper
        Corners of the rectangle of nodes, lengths.
    axis
        Axis of the travel, x or y.
    surface
        rough, where these nodes do not move on the other axis, or smooth.
    formula
        Travel at the time t, by distance and duration.
    distance, duration
        Length along the axis, and time.
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    axis: str
    surface: str
    formula: str
    distance: float
    duration: float


def edges(model: Model) -> dict[str, EdgeRecord]:
    """Sides of the grid by name: what each holds, and what pulls at it. Raises ValueError for what no record has."""
    return {side: EdgeRecord(*held(model, number), traction(model, number)) for number, side in enumerate(SIDES)}


def held(model: Model, number: int) -> tuple[str, float]:
    """Kind and friction coefficient of a side, by its nodes that are not pushed, without those of the corners."""
    grid, walls, axis = model.grid, model.walls, number // 2
    if isinstance(walls, MovingWalls) or (isinstance(walls, FrictionalWalls) and isinstance(walls.still, MovingWalls)):
        raise ValueError("walls by a rule have no record; a benchmark that is exported has those of a box, or pushed")
    across, on = grid.nodes[:, 1 - axis], inside(grid) & side(grid, number)
    slack = SLACK * grid.dx
    middle: Mask = on & (across > grid.lower[1 - axis] + slack) & (across < grid.upper[1 - axis] - slack)
    corners = not bool(middle.any())  # a body of one cell's width: what holds them along the side is the next one
    there: Mask = on if corners else middle
    if isinstance(walls, PushedWalls):
        there = there & ~walls.there
        if not there.any():
            return PUSHED, 0.0
    found = {(bool(row[axis]), bool(row[1 - axis]) and not corners) for row in model.walls.held[there]}
    kinds = {(KINDS.get(row, ""), 0.0) for row in found}
    if isinstance(walls, FrictionalWalls) and walls.normal[there, axis].any():
        kinds = {(FRICTIONAL if row[axis] else "", float(mu[axis])) for row, mu in
                 zip(walls.normal[there], walls.mu[there], strict=True)}  # fmt: skip
    if len(kinds) != 1 or not next(iter(kinds))[0]:
        raise ValueError(f"nodes of the {SIDES[number]} edge differ, or slide along it alone; neither has a record")
    return kinds.pop()


def side(grid: Grid, number: int) -> Mask:
    """Nodes (n,) on a side of the grid."""
    end = (grid.lower, grid.upper)[number % 2]
    found: Mask = np.abs(grid.nodes[:, number // 2] - end[number // 2]) < SLACK * grid.dx
    return found


def inside(grid: Grid) -> Mask:
    """Nodes (n,) in the box of the grid: those behind its sides are held alike."""
    slack = SLACK * grid.dx
    along: Mask = (grid.nodes > grid.lower - slack) & (grid.nodes < grid.upper + slack)
    found: Mask = along[:, 0] & along[:, 1]
    return found


def traction(model: Model, number: int) -> tuple[float, ...]:
    """Traction on a side of the body at t = 0. Raises ValueError unless it is constant."""
    normal = np.zeros(2)
    normal[number // 2] = 2.0 * (number % 2) - 1.0
    surface = model.surface
    on = (surface.N @ normal > 1 - SLACK) if surface else np.zeros(0, dtype=bool)
    if surface is None or not on.any():
        return 0.0, 0.0
    found: list[Floats] = [surface.given.stress(surface.X[on], t) @ normal for t in (0.0, model.dt)]
    if surface.faces.driven.any() or np.ptp(np.concatenate(found), axis=0).any():
        raise ValueError(f"what pulls at the {SIDES[number]} edge varies, or drives it; neither has a record")
    return numbers(found[0][0])


def pushed_nodes(model: Model) -> tuple[PushedRecord, ...]:
    """Nodes that are pushed, if any. Raises ValueError where they fill no rectangle, or their travel has no formula."""
    walls, grid = model.walls, model.grid
    if not isinstance(walls, PushedWalls):
        return ()
    there = walls.there & inside(grid)
    nodes, travel = grid.nodes[there], walls.travel
    lower, upper = nodes.min(axis=0), nodes.max(axis=0)
    if len(nodes) != np.prod(np.rint((upper - lower) / grid.dx) + 1):
        raise ValueError("nodes that are pushed fill no rectangle, and have no record")
    if not isinstance(travel, Smooth):
        raise ValueError("the travel of pushed nodes has no formula; take cases/benchmark/pressed.py: Smooth")
    rough = bool(walls.held[there, 1 - walls.axis].all())
    return (
        PushedRecord(
            numbers(lower), numbers(upper), "xy"[walls.axis], "rough" if rough else "smooth", travel.formula,
            travel.distance, travel.duration,
        ),
    )  # fmt: skip
