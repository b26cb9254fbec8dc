"""Grid and Particles: structures of arrays, float64, C order; plane strain, one system of units."""

from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PAD = 2  # ghost cells beyond the domain: corners of particle domains reach behind the walls


@dataclass
class Grid:
    """Square cells over a rectangle, and `PAD` ghost cells around it; node (i, j) has the number i*ny + j.

    `momentum`, `force`, `velocity` and `acceleration` (n,2) are halves of two (n,4) arrays, so that a particle reaches
    both with one cache line.

    Parameters
    ----------
    dx
        Side of a cell.
    lower, upper
        Corners of the domain without ghost cells, (2,).

    Attributes
    ----------
    nx, ny
        Nodes on x and on y, those of ghost cells included; n = nx ny.
    origin
        Position of node 0, (2,).
    mass
        Mass of the nodes, (n,).
    momentum_force
        Momentum and force that the particles give, (n,4).
    velocity_acceleration
        Velocity and acceleration that they take, (n,4).

    Raises
    ------
    ValueError
        Unless a whole number of cells fills the domain.
    """

    dx: float
    lower: Floats
    upper: Floats
    nx: int = field(init=False)
    ny: int = field(init=False)
    origin: Floats = field(init=False)
    mass: Floats = field(init=False)
    momentum_force: Floats = field(init=False)
    velocity_acceleration: Floats = field(init=False)

    def __post_init__(self) -> None:
        cells = np.rint((self.upper - self.lower) / self.dx).astype(int)
        if (cells < 1).any() or not np.allclose(cells * self.dx, self.upper - self.lower):
            raise ValueError(
                f"the domain {self.lower} to {self.upper} is not a whole number of cells of side {self.dx}"
            )
        self.nx, self.ny = (int(c) + 1 + 2 * PAD for c in cells)
        self.origin = self.lower - PAD * self.dx
        self.mass = np.zeros(self.nx * self.ny)
        self.momentum_force = np.zeros((self.nx * self.ny, 4))
        self.velocity_acceleration = np.zeros((self.nx * self.ny, 4))

    momentum = property(lambda self: self.momentum_force[:, :2])
    force = property(lambda self: self.momentum_force[:, 2:])
    velocity = property(lambda self: self.velocity_acceleration[:, :2])
    acceleration = property(lambda self: self.velocity_acceleration[:, 2:])

    @cached_property
    def nodes(self) -> Floats:
        """Positions of the nodes, (n,2); not to be written."""
        i, j = np.divmod(np.arange(self.nx * self.ny), self.ny)
        nodes: Floats = self.origin + self.dx * np.stack([i, j], axis=1)
        nodes.flags.writeable = False
        return nodes

    def cell(self, x: Floats) -> Ints:
        """Column and row (..., 2) of the cells of positions x (..., 2), counted from the domain's lower corner."""
        cells: Ints = np.floor((x - self.lower) / self.dx).astype(np.int64)
        return cells


@dataclass
class Particles:
    """State of P particles; rows are kept in an order that suits the grid.

    Parameters
    ----------
    X
        Reference position, (P,2).
    m, V0
        Mass and initial volume, (P,).
    domain
        What the basis keeps of the particle's domain, (P,W).

    Attributes
    ----------
    x, v, b
        Position, velocity, body force per mass, (P,2).
    F
        Deformation gradient, (P,2,2).
    sigma
        Cauchy stress xx, yy, zz, xy, tension positive, (P,4).
    carried
        Numbers of the caller that travel with their particle, (P,C).
    affine_velocity
        What a transfer keeps of the velocity besides v, (P,4 or 0), see solver/transfers/apic.py.
    F_old, history, work
        What a material in rate form keeps: F at the end of the last step (P,4 or 0), its memory of the path (P,H), and
        work (P,2 or 0), see solver/objective.py.
    sigma_smoothed
        Stress of the internal force where smoothing makes it another one than sigma, (P,4 or 0).
    id
        Row in the initial layout, (P,).
    """

    X: Floats
    m: Floats
    V0: Floats
    domain: Floats
    x: Floats = field(init=False)
    v: Floats = field(init=False)
    b: Floats = field(init=False)
    F: Floats = field(init=False)
    sigma: Floats = field(init=False)
    carried: Floats = field(init=False)
    affine_velocity: Floats = field(init=False)
    F_old: Floats = field(init=False)
    history: Floats = field(init=False)
    work: Floats = field(init=False)
    sigma_smoothed: Floats = field(init=False)
    id: Ints = field(init=False)

    def __post_init__(self) -> None:
        count = len(self.X)
        self.x, self.v, self.b = self.X.copy(), np.zeros((count, 2)), np.zeros((count, 2))
        self.F, self.sigma = np.tile(np.eye(2), (count, 1, 1)), np.zeros((count, 4))
        self.carried, self.affine_velocity, self.id = np.zeros((count, 0)), np.zeros((count, 0)), np.arange(count)
        self.F_old, self.history, self.sigma_smoothed = np.zeros((count, 0)), np.zeros((count, 0)), np.zeros((count, 0))
        self.work = np.zeros((count, 0))

    def __len__(self) -> int:
        return len(self.X)

    @property
    def J(self) -> Floats:
        """Determinant of F, (P,)."""
        F: Floats = self.F
        return F[:, 0, 0] * F[:, 1, 1] - F[:, 0, 1] * F[:, 1, 0]

    def reorder(self, order: Ints) -> None:
        """Permute the rows of every array."""
        for item in fields(self):
            setattr(self, item.name, np.ascontiguousarray(getattr(self, item.name)[order]))

    def in_initial_order(self, name: str) -> Any:
        """Array `name` with its rows as in the initial layout."""
        found = getattr(self, name)
        array = np.empty_like(found)
        array[self.id] = found
        return array
