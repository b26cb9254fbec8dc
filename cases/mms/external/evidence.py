"""Evidence that an answer gives of itself: displacements, their own gradients, and what is exact at the same times."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

from mpm_verify.cases.mms.external.answer import Frame
from mpm_verify.cases.mms.external.levels import Levels
from mpm_verify.mms.export.case import Exported
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.state import Floats

SUPPORT = 12  # particles that a gradient is fitted to, six coefficients each
STEP = 1e-30  # of a complex step


@dataclass(frozen=True)
class Evidence:
    """Answer beside its case. K output times, the start of the run before them, P particles.

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
        """Reference positions (P,2)."""
        return np.stack([self.case.particles["X"], self.case.particles["Y"]], axis=-1)

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

    @cached_property
    def u(self) -> Floats:
        """Displacements of the answer (1+K,P,2); that of the start is the exact one."""
        return np.concatenate([self.exact.u(self.X, 0.0)[None], self.given("x") - self.X])

    @cached_property
    def u_exact(self) -> Floats:
        """Exact displacements (1+K,P,2)."""
        return np.stack([self.exact.u(self.X, t) for t in self.times])

    @cached_property
    def F_exact(self) -> Floats:
        """Exact deformation gradients (1+K,P,2,2)."""
        return np.stack([self.exact.F(self.X, t) for t in self.times])

    @cached_property
    def F_own(self) -> Floats:
        """Deformation gradients (1+K,P,2,2) of the answer's own displacements.

        What the same operator misses of the exact displacements is taken off.
        """
        missed = np.eye(2) + self.gradient(self.u_exact) - self.F_exact
        return np.eye(2) + self.gradient(self.u) - missed

    @cached_property
    def F_given(self) -> Floats:
        """Deformation gradients (1+K,P,2,2) as they were written; that of the start is the exact one."""
        return np.concatenate([self.F_exact[:1], self.given("F").reshape(-1, len(self.X), 2, 2)])

    @cached_property
    def operators(self) -> tuple[Any, Any]:
        """Sparse matrices (P,P) of the derivatives by X and Y: a parabola is fitted to the particles around each."""
        X = self.X
        size = np.sqrt(np.ptp(X[:, 0]) * np.ptp(X[:, 1]) / len(X))
        _, near = cKDTree(X).query(X, SUPPORT)
        a, b = np.moveaxis((X[near] - X[:, None]) / size, -1, 0)
        A = np.stack([np.ones_like(a), a, b, a * a, a * b, b * b], axis=-1)
        fit = np.linalg.solve(A.swapaxes(1, 2) @ A, A.swapaxes(1, 2))
        rows = np.repeat(np.arange(len(X)), SUPPORT)
        found = [csr_matrix(((fit[:, k] / size).ravel(), (rows, near.ravel())), (len(X), len(X))) for k in (1, 2)]
        return found[0], found[1]

    def gradient(self, u: Floats) -> Floats:
        """Gradients (...,P,2,2) of vectors (...,P,2), rows the components of the vector."""
        flat = np.moveaxis(u, -2, 0).reshape(len(self.X), -1)
        shape = (len(self.X), *u.shape[:-2], 2)
        parts = [np.moveaxis((one @ flat).reshape(shape), 0, -2) for one in self.operators]
        return np.stack(parts, axis=-1)

    @cached_property
    def stressed(self) -> bool:
        """Whether the material's energy can be derived by complex numbers; one of a user's file may not take them."""
        try:
            return bool(np.isfinite(self.piola(np.eye(2)[None])).all())
        except Exception:  # of a user's code
            return False

    def piola(self, F: Floats) -> Floats:
        """First Piola stress (...,2,2) that the material has under F (...,2,2), in plane strain."""
        return derivative(self.exact.material, F)[0]

    def sigma(self, F: Floats) -> Floats:
        """Cauchy stress xx, yy, zz, xy (...,4) that the material has under F (...,2,2)."""
        P, Pzz = derivative(self.exact.material, F)
        J = np.linalg.det(F)[..., None]
        s = P @ F.swapaxes(-1, -2)
        found: Floats = np.stack([s[..., 0, 0], s[..., 1, 1], Pzz, s[..., 0, 1]], axis=-1) / J
        return found


def derivative(material: Any, F: Floats) -> tuple[Floats, Floats]:
    """First Piola stress (...,2,2) and its zz (...) in plane strain: derivative of the energy, by complex steps."""
    flat = F.reshape(-1, 2, 2)
    P, Pzz = np.empty(flat.shape), np.empty(len(flat))
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1), (2, 2)):
        full: list[list[Any]] = [[complex(a == b) for b in range(3)] for a in range(3)]
        for a in range(2):
            for b in range(2):
                full[a][b] = flat[:, a, b].astype(complex)
        full[i][j] = full[i][j] + 1j * STEP
        slope = np.imag(material.energy(full, np.log)) / STEP
        if i == 2:
            Pzz[:] = slope
        else:
            P[:, i, j] = slope
    return P.reshape(F.shape), Pzz.reshape(F.shape[:-2])
