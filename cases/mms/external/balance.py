"""Momentum balance of an answer, from its own positions: which force and which stress moved it, and when.

It is taken with smooth test functions w that vanish at the edges with their gradient, so walls take no part. With the
moments over the particles

    M = sum m u.w,   S = sum V0 P(F):grad w,   B = sum m b.w

it reads M'' = B - S. F is the gradient of the answer's own displacements, P the derivative of the material's energy
there, b the exact body force. Between three output times M'' is weighted with a hat: on the left that is a difference
of M, on the right a parabola is integrated. What these operators leave of the exact fields is taken off.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mpm_verify.cases.mms.external.evidence import Evidence
from mpm_verify.solver.state import Floats

Waves = tuple[dict[int, float], ...]
WAVES: Waves = ({0: 0.5, 2: -0.5}, {1: 0.25, 3: -0.25})  # sin^2 and sin^2 cos, as sums of cosines of pi k xi
SHORT = {0: -0.25, 2: 0.5, 4: -0.25}  # sin^2 cos 2


@dataclass(frozen=True)
class Tried:
    """Candidate that was fitted to what is left of the balance: its coefficient, and what it leaves of that, 0 to 1."""

    value: float
    left: float


class Balance:
    """Momentum balance of an answer in a rectangle; T test functions, K output times."""

    def __init__(self, evidence: Evidence, waves: Waves = WAVES) -> None:
        self.of = evidence
        low, high = np.array(evidence.case.record.lower), np.array(evidence.case.record.upper)
        self.w, self.gradient, self.laplacian = functions(evidence.X, low, high, waves)
        self.m, self.times, self.dt = evidence.case.particles["m"], evidence.times, evidence.dt

    def momentum(self, values: Floats) -> Floats:
        """Moments (...,T) of vectors (...,P,2) per mass."""
        found: Floats = np.einsum("p,...pa,jpa->...j", self.m, values, self.w)
        return found

    def stress(self, F: Floats) -> Floats:
        """Moments S (...,T) of the stress under F (...,P,2,2)."""
        found: Floats = np.einsum("p,...pab,jpab->...j", self.of.V0, self.of.piola(F), self.gradient)
        return found

    def force(self, lag: float = 0.0, at: Floats | None = None, swapped: bool = False) -> Floats:
        """Moments B (1+K,T) of the body force, `lag` steps before, at X or at positions (P,2) or (1+K,P,2).

        `swapped` exchanges its components.
        """
        where = np.broadcast_to(self.of.X if at is None else at, self.of.u.shape)
        fields = [self.of.exact.b(where[k], t - lag * self.dt) for k, t in enumerate(self.times)]
        return self.momentum(np.stack(fields)[..., ::-1] if swapped else np.stack(fields))

    @cached_property
    def rate(self) -> Floats:
        """Rate (T,) of M at the start, of the exact velocity."""
        return self.momentum(self.of.exact.v(self.of.X, 0.0))

    @cached_property
    def S(self) -> Floats:
        """Moments of the answer's own stress (1+K,T)."""
        return self.stress(self.of.F_own)

    @cached_property
    def left(self) -> Floats:
        """Remainder of the balance (K,T)."""
        exact = self.inertia(self.of.u_exact) - hats(self.force() - self.stress(self.of.F_exact), self.times)
        return self.inertia(self.of.u) - hats(self.force() - self.S, self.times) - exact

    def inertia(self, u: Floats) -> Floats:
        """Second differences (K,T) of M."""
        M = self.momentum(u)
        slopes = np.diff(M, axis=0) / np.diff(self.times)[:, None]
        return np.concatenate([slopes[:1] - self.rate, np.diff(slopes, axis=0)])

    def candidates(self) -> dict[str, Floats]:
        """Terms (K,T) that may be missing, one for each name; a factor's is the term itself."""
        t, of, dx = self.times, self.of, self.of.case.record.dx
        v = rates(of.u, t)
        damped = np.einsum("p,kpa,jpa->kj", self.m, v, self.laplacian)
        found = {
            "force_factor": hats(self.force(), t),
            "stress_factor": -hats(self.S, t),
            "force_lag": hats(self.force(1.0) - self.force(), t),
            "viscous": hats(damped, t) * dx**2 / self.dt,
            "damped": -hats(self.momentum(v), t) / self.dt,
            "stress_lag": hats(rates(self.S, t), t) * self.dt,
            "force_at_x": hats(self.force(at=of.X + of.u) - self.force(), t),
            "force_swapped": hats(self.force(swapped=True) - self.force(), t),
        }
        if of.has("F"):
            found["stress_of_F"] = -hats(self.stress(of.F_given) - self.S, t)
        return found

    def tried(self) -> dict[str, Tried]:
        """Each candidate fitted alone."""
        found = {name: fitted(self.left, term) for name, term in self.candidates().items()}
        return {**found, "force_at_YX": Balance(self.of, (*WAVES, SHORT)).exchanged()}

    def exchanged(self) -> Tried:
        """The body force at (Y, X). Where u is even about the middle of both sides, only short waves see it."""
        return fitted(self.left, hats(self.force(at=self.of.X[:, ::-1]) - self.force(), self.times))

    def start(self) -> tuple[Tried, Tried]:
        """Velocity that the first displacements begin with, in steps late: by acceleration, and by velocity alone."""
        first = self.left[0]
        a = self.momentum(self.of.exact.b(self.of.X, 0.0)) - self.stress(self.of.F_exact[0])
        return fitted(first, -a * self.dt), fitted(first, -self.rate * self.dt / self.times[1])


def fitted(left: Floats, term: Floats) -> Tried:
    """Least-squares fit of a term to what is left."""
    size, whole = float(np.sum(term * term)), float(np.linalg.norm(left))
    if not (np.isfinite(size) and size > 0 and whole > 0):
        return Tried(0.0, 1.0)
    value = float(np.sum(term * left)) / size
    return Tried(value, float(np.linalg.norm(left - value * term)) / whole)


def functions(X: Floats, lower: Floats, upper: Floats, waves: Waves = WAVES) -> tuple[Floats, Floats, Floats]:
    """Test functions of a rectangle at X (P,2): values (T,P,2), gradients (T,P,2,2), Laplacians (T,P,2)."""
    xi, per = (X - lower) / (upper - lower), np.pi / (upper - lower)
    w, gradient, laplacian = [], [], []
    for first in waves:
        for second in waves:
            f, g = cosines(first, xi[:, 0]), cosines(second, xi[:, 1])
            bent = per[0] ** 2 * f[2] * g[0] + per[1] ** 2 * f[0] * g[2]
            slope = np.stack([per[0] * f[1] * g[0], per[1] * f[0] * g[1]], axis=-1)
            for axis in np.eye(2):
                w.append((f[0] * g[0])[:, None] * axis)
                gradient.append(axis[None, :, None] * slope[:, None, :])
                laplacian.append(bent[:, None] * axis)
    return np.stack(w), np.stack(gradient), np.stack(laplacian)


def cosines(parts: dict[int, float], xi: Floats) -> Floats:
    """Sum of cosines of pi k xi, with its first and second derivative by pi xi, (3,P)."""
    rows = [(a * np.cos(np.pi * k * xi), -a * k * np.sin(np.pi * k * xi), -a * k * k * np.cos(np.pi * k * xi))
            for k, a in parts.items()]  # fmt: skip
    found: Floats = np.sum(rows, axis=0)
    return found


def hats(values: Floats, times: Floats) -> Floats:
    """Integrals (K,T) of values (1+K,T) with half a hat at the first time and a hat at each later one but the last."""
    found = []
    for k in range(len(times) - 1):
        near = slice(max(k - 1, 0), max(k - 1, 0) + 3)
        s = times[near] - times[k]
        before, after = (times[k] - times[k - 1] if k else 0.0), times[k + 1] - times[k]
        moments = [(before + after) / 2, (after**2 - before**2) / 6, (after**3 + before**3) / 12]
        weights = np.linalg.solve(np.vander(s / after, increasing=True).T, np.array(moments) / after ** np.arange(3))
        found.append(np.tensordot(weights, values[near], 1))
    return np.stack(found)


def rates(values: Floats, times: Floats) -> Floats:
    """First derivatives by time of values (1+K,...), by parabolas."""
    found: Floats = np.gradient(values, times, axis=0, edge_order=2)
    return found
