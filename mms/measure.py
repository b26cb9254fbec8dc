"""Numbers of a manufactured solution, sampled over its body, its boundary and its duration.

Nothing is read from names. The symbols that the fields are written in are evaluated first and P, sigma and b from
their values, so no expression is put into another and all of it takes a tenth of a second.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations, permutations, product
from typing import Any, Protocol

import numpy as np
import sympy as sp

from mpm_verify.mms.blind_spots import OPEN
from mpm_verify.mms.components import square
from mpm_verify.mms.discretisation import axisymmetric, boundary_kinds, dimension, width
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.layout import Layout, shared_corners
from mpm_verify.solver.sides import SOLID_SIDES
from mpm_verify.solver.state import Floats

TIMES = 33  # even steps hit the extremes of a wave whose period divides the duration
CELLS = 16  # on the width of the body, four positions in each
SOLID_CELLS = 8  # of a body in three dimensions, eight positions in each; in one dimension two in each
BESIDE = 1e-12  # fraction of the width: what vanishes on an axis is round-off of a double there
SHARP = 0.8  # cosine of half the angle between two faces: at the corners of a rectangle there is no one normal


class WaveMaterial(Protocol):
    """Constitutive model with what measures a stress: a density and a wave speed."""

    rho0: float

    def wave_speed(self) -> float:
        """Speed of the compression wave in the undeformed state."""


@dataclass(frozen=True)
class Sample:
    """Fields at T times and P reference positions: u, v, acceleration, b (T,P,d); F, P (T,P,d,d); sigma (T,P,4 or 6).

    `slope` (T,P,d^3) are the derivatives of F by the coordinates. In axisymmetry F and P are (T,P,3,3), the radius, the
    axis and around it.
    """

    u: Floats
    v: Floats
    F: Floats
    slope: Floats
    acceleration: Floats
    P: Floats
    sigma: Floats
    b: Floats

    @property
    def J(self) -> Floats:
        """Determinant of F, (T,P)."""
        if self.F.shape[-1] != 2:
            return np.linalg.det(self.F)
        J: Floats = self.F[..., 0, 0] * self.F[..., 1, 1] - self.F[..., 0, 1] * self.F[..., 1, 0]
        return J

    @property
    def turned(self) -> Floats:
        """Angle of the rotation R of F = R U, radians, (T,P)."""
        F = self.F
        if self.u.shape[-1] == 1:
            return np.zeros(F.shape[:2])
        if self.u.shape[-1] == 2:
            return np.arctan2(F[..., 1, 0] - F[..., 0, 1], F[..., 0, 0] + F[..., 1, 1])
        left, _, right = np.linalg.svd(F)
        R = left @ right
        axial = np.stack([R[..., (k + 2) % 3, (k + 1) % 3] - R[..., (k + 1) % 3, (k + 2) % 3] for k in range(3)])
        return np.arctan2(np.linalg.norm(axial, axis=0), np.trace(R, axis1=-2, axis2=-1) - 1)


class Sampler:
    """Sampler of the fields of one manufactured solution; compiled once.

    On an axis it looks beside it, at the radius `least`: terms over the radius have a limit there, and no value.
    """

    def __init__(self, exact: Manufactured) -> None:
        f, solution = exact.fields, exact.solution
        X_t, inner, self.count = (*f.X, f.t), list(f.inner), len(f.F)
        self.least = BESIDE * width(solution) if axisymmetric(solution) else -np.inf
        self.F: Any = sp.lambdify(X_t, f.F, "numpy", cse=True)
        self.first: Any = sp.lambdify(X_t, [*f.u, *f.v, *f.inner.values()], "numpy", cse=True)
        self.last: Any = sp.lambdify(inner, [*f.P, *f.sigma, *f.b], "numpy", cse=True)

    def __call__(self, X: Floats, times: Floats) -> Sample:
        """Fields at all reference positions (P,d) at all times (T,); what has no value there is NaN or infinite."""
        shape, d = (len(times), len(X)), X.shape[1]
        X = np.column_stack([np.maximum(X[:, 0], self.least), X[:, 1:]])
        with np.errstate(all="ignore"):
            first = filled(self.first(*X.T, times[:, None]), shape)
            last = filled(self.last(*np.moveaxis(first[..., 2 * d :], -1, 0)), shape)
        parts = np.cumsum([d, d, self.count, self.count * d, d])
        u, v, F, slope, acceleration, _ = np.split(first, parts, axis=-1)
        P, sigma, b = np.split(last, (self.count, last.shape[-1] - d), axis=-1)
        return Sample(u, v, square(F), slope, acceleration, square(P), sigma, b)

    def rate(self, X: Floats, times: Floats) -> Floats:
        """Rate dF/dt by a central difference, to 1e-6: expressions would double what there is to compile."""
        h, shape = 1e-4 * float(np.ptp(times)), (len(times), len(X))
        ahead, behind = (filled(self.F(*X.T, times[:, None] + s), shape) for s in (h, -h))
        return square(ahead - behind) / (2 * h)


def filled(values: Any, shape: tuple[int, ...]) -> Floats:
    """Stack numbers and arrays as one array (*shape, n)."""
    return np.stack([np.broadcast_to(np.asarray(value, dtype=float), shape) for value in values], axis=-1)


def boundary(layout: Layout) -> tuple[Floats, Floats]:
    """Corners of domains on the edge of the body, with unit normals outwards, both (B,2); sharp corners are left out.

    A face of one domain alone is on the edge. The normal at a corner is the mean of those of its two faces. Of a block
    the middles of the domains' faces, and its normals, (B,3); of a line its ends, (B,1).
    """
    if layout.X.shape[1] != 2:
        return faces_of_a_block(layout)
    X, start = shared_corners(layout)
    faces = np.stack([start, np.roll(start, -1, axis=1)], axis=-1).reshape(-1, 2)
    _, which, times = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    faces = faces[which[times == 1]]
    tangent = X[faces[:, 1]] - X[faces[:, 0]]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=-1) / np.hypot(*tangent.T)[:, None]
    total = np.zeros(X.shape)
    np.add.at(total, faces.ravel(), np.repeat(normal, 2, axis=0))
    length = np.hypot(*total.T)
    smooth = length > 2 * SHARP
    return X[smooth], total[smooth] / length[smooth, None]


def faces_of_a_block(layout: Layout) -> tuple[Floats, Floats]:
    """Middles of the faces of domains on the six faces of a block, or ends, with unit normals outwards, (B,d) each."""
    found, d = [], layout.X.shape[1]
    for axis, way in product(range(d), (-1, 1)):
        X = layout.X + way * layout.r0[:, axis]
        outermost = X[:, axis] == way * (way * X[:, axis]).max()
        found.append((X[outermost], np.tile(way * np.eye(d)[axis], (int(outermost.sum()), 1))))
    X, normal = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return X, normal


def measure(exact: Manufactured, solution: Any, material: WaveMaterial) -> dict[str, float]:
    """Measure a solution: numbers without units, lengths relative to the body's extent in x, as cells are."""
    length, times = width(solution), np.linspace(0.0, solution.duration, TIMES)
    d, sampler, around = dimension(solution), Sampler(exact), axisymmetric(solution)
    layout = inside(solution)
    s = sampler(layout.X, times)
    shift, L = s.F - np.eye(s.F.shape[-1]), sampler.rate(layout.X, times) @ np.linalg.inv(s.F)
    inertia, load = largest(s.acceleration), largest(s.b)
    numbers = {
        "strain": largest(shift),  # largest component of F - I
        "shear": max((largest(s.F[..., i, j]) for i, j in permutations(range(d), 2)), default=0.0),
        "rotation_deg": float(np.degrees(np.abs(s.turned).max())),  # angle of R in F = R U
        "spin": ratio(largest(L - L.swapaxes(-1, -2)), largest(L)),  # skew part of the velocity gradient
        "order": ratio(largest(s.F @ L - L @ s.F), largest(L)),  # whether F and L commute
        "J_min": float(s.J.min()),
        "J_max": float(s.J.max()),
        "gradient": length * largest(s.slope),
        "displacement": largest(s.u) / length,
        "start_acceleration": ratio(largest(s.acceleration[0]), inertia),
        "start_velocity": ratio(largest(s.v[0]), largest(s.v)),
        "load": ratio(load, inertia),
        "stress_force": ratio(largest(s.acceleration - s.b), max(inertia, load)),  # Div P / rho0
        "stress": largest(s.sigma) / (material.rho0 * material.wave_speed() ** 2),
        "weaker_component": ratio(min(largest(s.u[..., k]) for k in range(d)), largest(s.u)),
        "weaker_direction": ratio(min(largest(shift[..., :, k]) for k in range(d)), largest(shift)),
    }
    if d > 1 and not around:
        numbers["mirror"] = mirror(s.u, sampler, solution, layout, times)
    numbers |= hoop(s, layout.X[:, 0], material.rho0, max(inertia, load)) if around else {}
    moves = open_sides(solution)
    numbers |= at_the_edge(s, sampler, layout, times, least_stress(material), moves)
    numbers |= {"edge_free": float(solution.boundary == "free"), **moves}
    if getattr(material, "small_strain", False):
        numbers["small_strain"] = 1.0
    if around:
        numbers["axisymmetric"] = 1.0
    return numbers if d == 2 else {**numbers, "dimension": float(d)}


def inside(solution: Any) -> Layout:
    """Layout whose positions a body is sampled at."""
    d = dimension(solution)
    layout: Layout = solution.layout(width(solution) / (SOLID_CELLS if d == 3 else CELLS), 2**d)
    return layout


def hoop(s: Sample, radius: Floats, rho0: float, force: float) -> dict[str, float]:
    """Terms of the momentum balance over the radius, as fractions of the force, and the hoop part of the strain."""
    around = s.P[..., 2, 2]
    return {
        "hoop_stress": ratio(largest(around / radius) / rho0, force),
        "hoop_terms": ratio(
            max(largest((s.P[..., 0, 0] - around) / radius), largest(s.P[..., 1, 0] / radius)) / rho0, force
        ),
        "hoop_strain": ratio(largest(s.F[..., 2, 2] - 1), largest(s.F - np.eye(3))),
    }


def open_sides(solution: Any) -> dict[str, float]:
    """Sides that are pulled or prescribed, as codes of OPEN; of one that nobody named so, the code of `found`."""
    named = getattr(solution, "named", tuple)() is not None
    kinds = zip(SOLID_SIDES, boundary_kinds(solution), strict=False)
    return {side: OPEN[kind if named else "found"] for side, kind in kinds if kind in OPEN}


def mirror(u: Floats, sampler: Sampler, solution: Any, layout: Layout, times: Floats) -> float:
    """Distance of u (T,P,d) from its mirror image in a diagonal, where two axes are exchanged: that of the nearest.

    As a fraction of the largest; 1 where no two sides are of the same length.
    """
    extent, found = solution.upper - solution.lower, []
    for i, j in combinations(range(len(extent)), 2):
        if np.isclose(extent[i], extent[j]):
            axes = list(range(len(extent)))
            axes[i], axes[j] = j, i
            image = sampler(solution.lower + (layout.X - solution.lower)[:, axes], times).u[..., axes]
            found.append(ratio(largest(image - u), largest(u)))
    return min(found, default=1.0)


def least_stress(material: WaveMaterial) -> float:
    """Stress of a strain of 1e-5, with which others are compared where there is none, as in rigid motion."""
    return 1e-5 * material.rho0 * material.wave_speed() ** 2


def at_the_edge(
    s: Sample, sampler: Sampler, layout: Layout, times: Floats, least: float, moves: Mapping[str, float]
) -> dict[str, float]:
    """Displacement and traction on the boundary, as fractions of the largest displacement and stress in the body.

    Beside sides that are pulled or prescribed, `moves`, those of the others alone; where there is no other, of all.
    """
    X, normal = boundary(layout)
    if 0 < len(moves) < 2 * X.shape[1]:
        side = 2 * np.abs(normal).argmax(axis=1) + (normal.sum(axis=1) > 0)
        X, normal = (part[[SOLID_SIDES[k] not in moves for k in side]] for part in (X, normal))
    edge, u, P = sampler(X, times), largest(s.u), max(largest(s.P), least)
    traction = edge.P[..., : X.shape[1], : X.shape[1]] * normal[:, None, :]
    return {
        "edge_motion": ratio(largest(edge.u), u),
        "edge_normal_motion": ratio(largest((edge.u * normal).sum(axis=-1)), u),
        "edge_traction": ratio(largest(traction.sum(axis=-1)), P),
    }


def largest(values: Floats) -> float:
    """Largest absolute value of a component."""
    return float(np.abs(values).max())


def ratio(part: float, whole: float) -> float:
    """Part over whole; zero where the whole is."""
    return part / whole if whole > 0 else 0.0
