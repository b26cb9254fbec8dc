"""One step written out with full matrices of weights, in NumPy: what the kernels of a step have to give.

Weights come from the basis, one row a particle and one column a node; nothing else is the solver's. Formulas: the
step of the docstrings of solver/transfer.py, solver/stress_update.py and solver/transfers.
"""

from dataclasses import dataclass, replace

import numpy as np

from mpm_verify.solver._jit import BLOCK
from mpm_verify.solver.state import Floats
from mpm_verify.solver.step import Model


@dataclass(frozen=True)
class Weights:
    """Weights of P particles at n nodes: N (P,n), dN (P,n,2)."""

    N: Floats
    dN: Floats


@dataclass(frozen=True)
class State:
    """State that a step changes: x, v (P,2), F (P,2,2), sigma (P,4), and B (P,2,2), the affine velocity of APIC."""

    x: Floats
    v: Floats
    F: Floats
    sigma: Floats
    B: Floats


def weights(model: Model, x: Floats, F: Floats) -> Weights:
    """Weights at positions x and F, as the basis fills them."""
    g, p, basis = model.grid, model.particles, model.basis
    P, K, n = len(x), basis.support, g.nx * g.ny
    table, node = np.empty(3 * K * BLOCK), np.empty(K * BLOCK, np.int64)
    sums = np.zeros((3, P * n))
    for lo in range(0, P, BLOCK):
        hi = min(lo + BLOCK, P)
        basis.fill(
            x[lo:hi].ravel(), F[lo:hi].ravel(), p.domain[lo:hi].ravel(), *g.origin, 1 / g.dx, g.nx, g.ny,
            0.0, g.nx - 1.0, 0.0, g.ny - 1.0, table, node,
        )  # fmt: skip
        at = (n * np.arange(lo, hi) + node.reshape(K, BLOCK)[:, : hi - lo]).ravel()
        for total, part in zip(sums, table.reshape(3, K, BLOCK), strict=True):
            total += np.bincount(at, part[:, : hi - lo].ravel(), P * n)
    N, gx, gy = sums.reshape(3, P, n)
    return Weights(N, np.stack([gx, gy], axis=-1))


@dataclass(frozen=True)
class Dense:
    """Formulas of a step of one model, from the state that it is in, with a fraction `flip` of FLIP."""

    model: Model
    flip: float

    @property
    def state(self) -> State:
        """State of the particles, copied."""
        p = self.model.particles
        B = p.affine_velocity.reshape(-1, 2, 2) if p.affine_velocity.size else np.zeros_like(p.F)
        return State(p.x.copy(), p.v.copy(), p.F.copy(), p.sigma.copy(), B.copy())

    @property
    def affine(self) -> bool:
        """Whether particles keep an affine velocity."""
        return bool(self.model.particles.affine_velocity.size)

    def around(self, w: Weights) -> tuple[Floats, Floats]:
        """Distances (P,n,2) of the nodes from the mean position of each particle, and their second moment D (P,2,2)."""
        nodes = self.model.grid.nodes
        r = nodes[None] - (w.N @ nodes)[:, None]
        return r, (w.N[:, :, None] * r).transpose(0, 2, 1) @ r

    def mass(self, w: Weights) -> Floats:
        """Mass of the nodes (n,)."""
        mass: Floats = w.N.T @ self.model.particles.m
        return mass

    def momentum(self, w: Weights, v: Floats, B: Floats) -> Floats:
        """Momentum of the nodes (n,2)."""
        m = self.model.particles.m
        total: Floats = w.N.T @ (m[:, None] * v)
        if self.affine:
            r, D = self.around(w)
            around = r @ (B @ np.linalg.inv(D)).transpose(0, 2, 1)
            total += ((m[:, None] * w.N)[:, :, None] * around).sum(axis=0)
        return total

    def force(self, w: Weights, F: Floats, sigma: Floats, b: Floats) -> Floats:
        """Force at the nodes (n,2): sum m b N - sum V sigma dN."""
        p = self.model.particles
        V = p.V0 * np.linalg.det(F)
        plane = sigma[:, [0, 3, 3, 1]].reshape(-1, 2, 2)
        total: Floats = w.N.T @ (p.m[:, None] * b) - (w.dN @ (V[:, None, None] * plane)).sum(axis=0)
        return total

    def over_mass(self, w: Weights, values: Floats) -> Floats:
        """Values over mass (n,2), zero at nodes of no mass."""
        mass = self.mass(w)[:, None]
        found: Floats = np.divide(values, mass, out=np.zeros_like(values), where=mass > self.model.cutoff)
        return found

    def motion(self, w: Weights, momentum: Floats, force: Floats) -> tuple[Floats, Floats]:
        """Velocity and acceleration of the nodes (n,2) at the end of the step."""
        walls, dt = self.model.walls, self.model.dt
        before, a = self.over_mass(w, momentum), self.over_mass(w, force)
        v = np.where(walls.held, walls.value, before + dt * a)
        held = (walls.value - before) / dt if walls.stops else walls.rate
        return v, np.where(walls.held, held, a)

    def filtered(self, w: Weights, v: Floats) -> Floats:
        """Velocities that move and strain the particles: FMPM(k) sums k terms, all others leave them."""
        found = v
        for _ in range(int(getattr(self.model.scheme.transfer, "order", 1)) - 1):
            mapped = self.over_mass(w, w.N.T @ (self.model.particles.m[:, None] * (w.N @ found)))
            found = np.where(self.model.walls.held, v, v + found - mapped)
        return found

    def strained(self, w: Weights, F: Floats, v: Floats) -> Floats:
        """F (P,2,2) after the step by velocities v of the nodes: (I + dt L) F."""
        L = v.T @ w.dN
        return F + self.model.dt * L @ F

    def step(self, b: Floats, sigma_of: "Sigma") -> State:
        """State after one step with body forces b (P,2); `sigma_of` gives the stress of an F."""
        kinds = {"usl": self.last, "musl": self.modified, "usf": self.first}
        return kinds[self.model.scheme.stress](self.state, b, sigma_of)

    def forward(self, w: Weights, s: State, b: Floats) -> tuple[State, Floats]:
        """State with v, x and B of the end of the step, and the velocities of the nodes, filtered."""
        v, a = self.motion(w, self.momentum(w, s.v, s.B), self.force(w, s.F, s.sigma, b))
        v = self.filtered(w, v)
        flip, dt = self.flip, self.model.dt
        new = flip * (s.v + dt * (w.N @ a)) + (1 - flip) * (w.N @ v)
        B = s.B
        if self.affine:
            r, _ = self.around(w)
            B = (w.N[:, :, None] * v).transpose(0, 2, 1) @ r
        return replace(s, x=s.x + dt * (w.N @ v), v=new, B=B), v

    def last(self, s: State, b: Floats, sigma_of: "Sigma") -> State:
        """Update-stress-last."""
        w = weights(self.model, s.x, s.F)
        end, v = self.forward(w, s, b)
        F = self.strained(w, s.F, v)
        return replace(end, F=F, sigma=sigma_of(F))

    def modified(self, s: State, b: Floats, sigma_of: "Sigma") -> State:
        """Modified update-stress-last: F by the particles' new velocities, mapped back."""
        w = weights(self.model, s.x, s.F)
        end, _ = self.forward(w, s, b)
        held, value, _ = self.model.walls.in_strain()
        mapped = np.where(held, value, self.over_mass(w, self.momentum(w, end.v, end.B)))
        F = self.strained(w, s.F, self.filtered(w, mapped))
        return replace(end, F=F, sigma=sigma_of(F))

    def first(self, s: State, b: Floats, sigma_of: "Sigma") -> State:
        """Update-stress-first: F and sigma by the velocities before the step, then forces."""
        w, (held, value, rate) = weights(self.model, s.x, s.F), self.model.walls.in_strain()
        before = self.over_mass(w, self.momentum(w, s.v, s.B))
        before = np.where(held, value - self.model.dt * rate, before)
        F = self.strained(w, s.F, self.filtered(w, before))
        strained = replace(s, F=F, sigma=sigma_of(F))
        end, _ = self.forward(weights(self.model, s.x, F), strained, b)
        return end


class Sigma:
    """Stress (P,4) of the material for an F (P,2,2) at the end of a step, on a copy of the particles of a model."""

    def __init__(self, model: Model) -> None:
        from copy import deepcopy

        self.model, self.particles = model, deepcopy(model.particles)

    def __call__(self, F: Floats) -> Floats:
        """Stress of F."""
        self.particles.F[:] = F
        self.model.material.update(self.particles, self.model.dt)
        return self.particles.sigma.copy()
