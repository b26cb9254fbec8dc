"""Evidence that an answer gives of itself: displacements, their own gradients, and what is exact at the same times."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

from mpm_verify.cases.solvers.answer import Frame
from mpm_verify.cases.solvers.components import reference
from mpm_verify.cases.solvers.levels import Levels
from mpm_verify.mms.components import AXES, COMPONENTS, square
from mpm_verify.mms.export.case import Exported
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.state import Floats

SUPPORT = {1: 5, 2: 12, 3: 32}  # particles that a gradient is fitted to, with 3, 6 and 10 coefficients
STEP = 1e-30  # of a complex step


@dataclass(frozen=True)
class Evidence:
    """Answer beside its case. K output times, the start of the run before them, P particles.

    In axisymmetry tensors are of the radius, the axis and around it, (3,3).

    Parameters
    ----------
    exact
        Exact fields.
    case
        Case that was given.
    frames
        Frames by the number of their step.
    levels
        Time levels that the answer states.
    """

    exact: Manufactured
    case: Exported
    frames: dict[int, Frame]
    levels: Levels

    @cached_property
    def X(self) -> Floats:
        """Reference positions (P,d)."""
        return reference(self.case.particles, self.case.record.dimension)

    @property
    def d(self) -> int:
        """Number of dimensions."""
        return self.case.record.dimension

    @property
    def around(self) -> bool:
        """Whether it is axisymmetric."""
        return self.case.record.axisymmetric

    @property
    def V0(self) -> Floats:
        """Initial volumes (P,)."""
        return self.case.particles["V0"]

    @property
    def dt(self) -> float:
        """Length of a time step."""
        return self.case.record.dt

    @cached_property
    def times(self) -> Floats:
        """Times (1+K,) of the start and of the frames."""
        return self.dt * np.array([0, *self.frames])

    def has(self, key: str) -> bool:
        """Whether all frames have a field."""
        return all(key in frame.fields for frame in self.frames.values())

    def given(self, key: str) -> Floats:
        """Field of all frames as it was written, (K,P,n)."""
        return np.stack([frame.fields[key] for frame in self.frames.values()])

    def truth(self, name: str, lag: float = 0.0) -> Floats:
        """Exact field at the times of the frames, `lag` steps before them, (K,P,n)."""
        field = getattr(self.exact, name)
        return np.stack([field(self.X, t - lag * self.dt).reshape(len(self.X), -1) for t in self.times[1:]])

    @property
    def start(self) -> Floats:
        """Positions (P,d) that were given for the start."""
        return np.stack([self.case.particles[axis] for axis in AXES[: self.d]], axis=-1)

    @property
    def last_digits(self) -> Floats:
        """Values (K,P,d) of the last digits of the positions as they were written; rounding of double precision."""
        x = self.given("x")
        told = [frame.last.get("x", np.zeros(self.X.shape)) for frame in self.frames.values()]
        return np.maximum(np.stack(told), np.spacing(np.abs(x)))

    @cached_property
    def u(self) -> Floats:
        """Displacements of the answer (1+K,P,d); that of the start is the exact one."""
        return np.concatenate([self.exact.u(self.X, 0.0)[None], self.given("x") - self.X])

    @cached_property
    def u_exact(self) -> Floats:
        """Exact displacements (1+K,P,d)."""
        return np.stack([self.exact.u(self.X, t) for t in self.times])

    @cached_property
    def F_exact(self) -> Floats:
        """Exact deformation gradients (1+K,P,d,d)."""
        return square(np.stack([self.exact.F(self.X, t).reshape(len(self.X), -1) for t in self.times]))

    @cached_property
    def F_own(self) -> Floats:
        """Deformation gradients (1+K,P,d,d) of the answer's own displacements.

        What the same operator misses of the exact displacements is taken off.
        """
        unit = np.eye(self.F_exact.shape[-1])
        missed = unit + self.stretch(self.u_exact) - self.F_exact
        return unit + self.stretch(self.u) - missed

    def stretch(self, u: Floats) -> Floats:
        """F - I (...,P,d,d) of displacements (...,P,d); in axisymmetry with u over the radius around the axis."""
        plane = self.gradient(u)
        if not self.around:
            return plane
        found = np.zeros((*u.shape[:-1], 3, 3))
        found[..., :2, :2], found[..., 2, 2] = plane, u[..., 0] / self.X[:, 0]
        return found

    @cached_property
    def F_given(self) -> Floats:
        """Deformation gradients (1+K,P,d,d) as they were written; that of the start is the exact one."""
        return np.concatenate([self.F_exact[:1], square(self.given("F"))])

    @cached_property
    def operators(self) -> tuple[Any, ...]:
        """Sparse matrices (P,P) of the derivatives by X: a parabola is fitted to the particles around each.

        Where there are too few layers for one in some direction, as in a slice, it is flat there.
        """
        X, count = self.X, min(SUPPORT[self.d], len(self.X))
        size = float(np.prod(np.ptp(X, axis=0)) / len(X)) ** (1 / self.d)
        _, near = cKDTree(X).query(X, count)
        a = np.moveaxis((X[near] - X[:, None]) / size, -1, 0)
        second = [a[i] * a[j] for i in range(self.d) for j in range(i, self.d)]
        A = np.stack([np.ones_like(a[0]), *a, *second], axis=-1)
        fit = np.linalg.pinv(A)
        rows = np.repeat(np.arange(len(X)), count)
        return tuple(
            csr_matrix(((fit[:, k + 1] / size).ravel(), (rows, near.ravel())), (len(X), len(X))) for k in range(self.d)
        )

    def gradient(self, u: Floats) -> Floats:
        """Gradients (...,P,d,d) of vectors (...,P,d), rows the components of the vector."""
        flat = np.moveaxis(u, -2, 0).reshape(len(self.X), -1)
        shape = (len(self.X), *u.shape[:-2], self.d)
        parts = [np.moveaxis((one @ flat).reshape(shape), 0, -2) for one in self.operators]
        return np.stack(parts, axis=-1)

    @cached_property
    def stressed(self) -> bool:
        """Whether the material's energy can be derived by complex numbers; one of a user's file may not take them."""
        try:
            return bool(np.isfinite(self.piola(np.eye(self.F_exact.shape[-1])[None])).all())
        except Exception:  # of a user's code
            return False

    def piola(self, F: Floats) -> Floats:
        """First Piola stress (...,d,d) that the material has under F (...,d,d), where all else of F is that of I."""
        return derivative(self.exact.material, F)[0]

    def sigma(self, F: Floats) -> Floats:
        """Cauchy stress (...,1, 4 or 6) that the material has under F (...,d,d), in the order of mms/components.py."""
        P, Pzz = derivative(self.exact.material, F)
        J = np.linalg.det(F)[..., None]
        s = P @ F.swapaxes(-1, -2)
        parts = [Pzz if part == "zz" and F.shape[-1] == 2 else s[..., AXES.index(part[0]), AXES.index(part[1])]
                 for part in COMPONENTS[self.d]]  # fmt: skip
        found: Floats = np.stack(parts, axis=-1) / J
        return found


def derivative(material: Any, F: Floats) -> tuple[Floats, Floats]:
    """First Piola stress (...,d,d), and its zz (...) of plane strain: derivative of the energy, by complex steps."""
    d = F.shape[-1]
    flat = F.reshape(-1, d, d)
    P, Pzz = np.empty(flat.shape), np.zeros(len(flat))
    for i, j in [(i, j) for i in range(d) for j in range(d)] + [(2, 2)] * (d == 2):
        full: list[list[Any]] = [[complex(a == b) for b in range(3)] for a in range(3)]
        for a in range(d):
            for b in range(d):
                full[a][b] = flat[:, a, b].astype(complex)
        full[i][j] = full[i][j] + 1j * STEP
        slope = np.imag(material.energy(full, np.log)) / STEP
        if i == d:
            Pzz[:] = slope
        else:
            P[:, i, j] = slope
    return P.reshape(F.shape), Pzz.reshape(F.shape[:-2])
