"""Edge of a body that is pulled or driven: forces at points of the edge, handed to the nodes around them.

Pulled: the traction P N per reference area, at two Gauss points of each face of a boundary particle's domain at
reference. Where they reach the grid depends on the method:
    domains with corners (CPDI, CPDI2)   the field on a face of a domain is linear between its two corners, so a point
                                         acts through both, each by its weight; a uniform stress is balanced exactly
    all others                           surface particles: the points themselves, moved with the velocity of the grid,
                                         act through the grid's field there, hat functions or the splines of the basis
Driven: the displacement is prescribed weakly, as by Nitsche, for nodes lie beside the edge. The force is the traction
that the boundary particle's own stress has, and a spring from the point to where it should be,
    sigma cof(F) N + STIFFNESS rho0 c^2 / dx (x(X, t) - x_s),   c the wave speed, x_s moved with the grid.
The spring alone leaves a gap of traction over stiffness, of first order in dx; beside the own traction it has to bear
only what that misses at half a domain from the edge, and the gap is of second order.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import sqrt
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from mpm_verify.solver.context import Context
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.sides import SIDES
from mpm_verify.solver.state import Floats, Ints, Particles
from mpm_verify.solver.surface_kernels import hats, weigh
from mpm_verify.solver.weights import Basis

Kind = Literal["pulled", "prescribed"]
STIFFNESS = 2.0  # with 1 a long run ends inverted, with more its step has to be shorter
DRIVEN_STEP = 0.6  # of dx / (c + |v|): a longer step is not stable with driven edges
GAUSS = np.array([0.5 - 0.5 / sqrt(3), 0.5 + 0.5 / sqrt(3)])  # fractions of a face
FORCE = (2, 3)  # columns of a grid's momentum_force
ON = 1e-9  # fraction of a face: a corner that is so near to an edge is on it


@dataclass(frozen=True)
class Given:
    """Data of the edge, functions of reference positions X (n,2) and the time: the two that a kind asks for.

    Parameters
    ----------
    stress
        First Piola stress P (n,2,2); the traction is P N per reference area.
    position
        Position x (n,2).
    """

    stress: Callable[[Floats, float], Floats]
    position: Callable[[Floats, float], Floats]


@dataclass(frozen=True)
class Faces:
    """Faces of domains on the edge of a body, S of them.

    Parameters
    ----------
    particle
        Row in the initial layout, (S,).
    corners
        Reference positions of both ends, counter-clockwise, (S,2,2).
    driven
        Whether the displacement is prescribed there, (S,); otherwise the traction is.
    """

    particle: Ints
    corners: Floats
    driven: NDArray[np.bool_]


def faces(layout: Layout, lower: Floats, upper: Floats, kinds: Mapping[str, Kind]) -> Faces:
    """Find the faces of domains on sides of a rectangle.

    Parameters
    ----------
    layout
        Layout of P particles.
    lower, upper
        Corners (2,) of the rectangle at reference.
    kinds
        Kind of each side that is pulled or driven, by its name.

    Returns
    -------
    Faces
        Side by side.
    """
    corners, after = layout.corners, np.array([1, 2, 3, 0])
    found: list[tuple[Ints, Ints, NDArray[np.bool_]]] = []
    for side, kind in kinds.items():
        axis, end = SIDES.index(side) // 2, (lower, upper)[SIDES.index(side) % 2]
        size = float(np.abs(layout.r0).max())
        there = np.abs(corners[:, :, axis] - end[axis]) < ON * size
        particle, first = np.nonzero(there & there[:, after])
        found.append((particle, first, np.full(len(particle), kind == "prescribed")))
    particle, first, driven = (np.concatenate(parts) for parts in zip(*found, strict=True))
    ends = np.stack([corners[particle, first], corners[particle, after[first]]], axis=1)
    return Faces(particle, ends, driven)


@dataclass
class Surface:
    """Points of the edge, two on each face, and what acts there.

    Parameters
    ----------
    faces
        Faces of the edge.
    given
        Data of the edge.

    Attributes
    ----------
    X, N, area
        Reference positions (2S,2) of the points, unit normals outwards (2S,2), and the part of the edge that each
        stands for (2S,), a length.
    x
        Positions, moved with the grid, (2S,2).
    ends
        Numbers of the corners of domains that the ends of each face are, (S,2); empty before they are asked for.

    References
    ----------
    Sadeghirad, Brannon & Burghardt 2011, doi:10.1002/nme.3110, for the field on the faces of domains.
    Nitsche 1971, doi:10.1007/BF02995904. Chandra, Singer, Teschemacher, Wuechner & Larese 2021,
    doi:10.1007/s11440-020-01123-3, for boundary particles with penalties in the material point method.
    """

    faces: Faces
    given: Given
    X: Floats = field(init=False)
    N: Floats = field(init=False)
    area: Floats = field(init=False)
    x: Floats = field(init=False)
    ends: Ints = field(init=False)

    def __post_init__(self) -> None:
        start, end = self.faces.corners[:, 0], self.faces.corners[:, 1]
        along = end - start
        length = np.hypot(*along.T)
        self.X = (start[:, None] + GAUSS[None, :, None] * along[:, None]).reshape(-1, 2)
        self.N = np.repeat(np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None], 2, axis=0)
        self.area = np.repeat(length / 2, 2)
        self.x = self.given.position(self.X, 0.0)
        self.ends = np.zeros((0, 2), np.int64)

    @property
    def step_fraction(self) -> float:
        """Fraction of the usual limit that the step has here."""
        return DRIVEN_STEP if self.faces.driven.any() else 1.0

    def act(self, model: Context) -> None:
        """Add the forces of the edge to those of the nodes. Raises RunFailed where it reaches out of the grid."""
        grid, basis, force = model.grid, model.basis, self.area[:, None] * self.traction(model)
        x = self.where(model)
        if basis.faces_carry:
            x, force = self.at_corners(model, force)
        weights, nodes = around(model, x)
        for a, column in enumerate(FORCE):  # one after another: the same bits for any number of threads
            np.add.at(grid.momentum_force[:, column], nodes.ravel(), (weights * force[:, a : a + 1]).ravel())

    def traction(self, model: Context) -> Floats:
        """Force per reference area (2S,2) at the time of x."""
        driven, found = np.repeat(self.faces.driven, 2), np.empty_like(self.X)
        pulled = ~driven
        if pulled.any():
            P = self.given.stress(self.X[pulled], model.time)
            found[pulled] = np.einsum("sab,sb->sa", P, self.N[pulled])
        if driven.any():
            rho0, c = float(model.particles.m[0] / model.particles.V0[0]), model.material.wave_speed()
            gap = self.given.position(self.X[driven], model.time) - self.x[driven]
            own = own_traction(model.particles, np.repeat(self.rows(model.particles), 2)[driven], self.N[driven])
            found[driven] = own + STIFFNESS * rho0 * c**2 / model.grid.dx * gap
        return found

    def at_corners(self, model: Context, force: Floats) -> tuple[Floats, Floats]:
        """Positions of both corners of each face, and the forces (2S,2) that its two points give them."""
        p, rows = model.particles, self.rows(model.particles)
        corners = model.basis.corners(p.x[rows], p.F[rows], p.domain[rows], model.grid.dx)
        assert corners is not None
        if not len(self.ends):
            start = self.given.position(self.faces.corners.reshape(-1, 2), 0.0).reshape(-1, 2, 2)
            self.ends = np.linalg.norm(corners[:, None] - start[:, :, None], axis=-1).argmin(axis=-1)
        x: Floats = corners[np.arange(len(rows))[:, None], self.ends].reshape(-1, 2)
        weight = np.stack([1.0 - GAUSS, GAUSS])  # of a corner at a point
        return x, np.einsum("cg,sga->sca", weight, force.reshape(-1, 2, 2)).reshape(-1, 2)

    def rows(self, particles: Particles) -> Ints:
        """Rows (S,) of the boundary particles in their present order."""
        row = np.empty_like(particles.id)
        row[particles.id] = np.arange(len(row))
        found: Ints = row[self.faces.particle]
        return found

    def move(self, model: Context) -> None:
        """Move the points with the new velocity of the grid, by a step."""
        weights, nodes = around(model, self.where(model))
        v = np.zeros_like(self.x)
        for N, node in zip(weights.T, nodes.T, strict=True):
            v += N[:, None] * model.grid.velocity_acceleration[node, :2]
        self.x += model.dt * v

    def where(self, model: Context) -> Floats:
        """Positions (2S,2) of the points on the grid: x, or X beside weights of the reference positions."""
        return self.X if model.basis.reference else self.x


def around(model: Context, x: Floats) -> tuple[Floats, Ints]:
    """Weights (n,K) of the nodes around points x (n,2), and their numbers. Raises RunFailed for a point outside."""
    g, (fill, K) = model.grid, field_of(model.basis)
    weights, nodes = np.empty((len(x), K)), np.empty(len(x) * K, np.int64)
    if weigh(fill, K, np.ascontiguousarray(x), g.origin, 1.0 / g.dx, g.nx, g.ny, weights, nodes) >= 0:
        raise RunFailed(FailureKind.OUTSIDE_GRID, model.steps)
    return weights, nodes.reshape(-1, K)


def own_traction(particles: Particles, rows: Ints, N: Floats) -> Floats:
    """Traction per reference area (n,2) of the stress of particles, sigma cof(F) N, that the forces are made from."""
    sigma = (particles.sigma_smoothed if particles.sigma_smoothed.size else particles.sigma)[rows]
    F, (Nx, Ny) = particles.F[rows], N.T
    nx = F[:, 1, 1] * Nx - F[:, 1, 0] * Ny
    ny = F[:, 0, 0] * Ny - F[:, 0, 1] * Nx
    return np.stack([sigma[:, 0] * nx + sigma[:, 3] * ny, sigma[:, 3] * nx + sigma[:, 1] * ny], axis=1)


def field_of(basis: Basis) -> tuple[Callable[..., bool], int]:
    """Kernel and count of the nodes that the grid's field at a point has: of the basis if it knows points, or hats."""
    return (basis.fill, basis.support) if basis.domain_size == 0 else (hats, 4)


def open_sides(kinds: Sequence[str]) -> dict[str, Kind]:
    """Sides that are pulled or driven, of the kinds of left, right, bottom, top."""
    return {side: kind for side, kind in zip(SIDES, kinds, strict=True) if kind in ("pulled", "prescribed")}  # type: ignore[misc]
