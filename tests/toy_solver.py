"""A material point program that knows nothing of this package: hats, FLIP, a case folder in, positions out.

It is what a stranger would write: the folder is read with NumPy alone, its force imported from its source.
"""

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np


def flat(folder: Path) -> dict[str, Any]:
    """case.txt."""
    words = dict(line.split() for line in (folder / "case.txt").read_text().splitlines())
    return {name: number(word) for name, word in words.items()}


def number(word: str) -> Any:
    """Number, or the word where it is none."""
    try:
        return float(word)
    except ValueError:
        return word


def force(folder: Path) -> Any:
    """body_force.py."""
    spec = importlib.util.spec_from_file_location("body_force", folder / "body_force.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Toy:
    """Particles and grid; `levels` says how it starts and steps, as the table of the folder's README has it."""

    def __init__(self, folder: Path, levels: str = "last", at_nodes: bool = False) -> None:
        self.case, self.given, self.levels, self.at_nodes = flat(folder), force(folder), levels, at_nodes
        table = np.genfromtxt(folder / "particles.csv", delimiter=",", names=True)
        pick = lambda *names: np.column_stack([table[name] for name in names])  # noqa: E731
        v, F = ("", "") if levels == "end" else ("_half", "_before" if levels == "first" else "")
        self.X, self.x, self.v = pick("X", "Y"), pick("x", "y"), pick(f"vx{v}", f"vy{v}")
        self.F = pick(*(f"F{c}{F}" for c in ("xx", "xy", "yx", "yy"))).reshape(-1, 2, 2)
        self.V0, self.m, self.t = table["V0"], table["m"], 0.0
        self.dt, self.dx = self.case["dt"], self.case["dx"]
        self.low = np.array([self.case["grid_lower_x"], self.case["grid_lower_y"]])
        high = np.array([self.case["grid_upper_x"], self.case["grid_upper_y"]])
        self.shape = np.rint((high - self.low) / self.dx).astype(int) + 2
        index = np.indices(self.shape).reshape(2, -1).T
        self.nodes = self.low + index * self.dx
        edges = np.array([["left", "right"], ["bottom", "top"]])
        self.held = np.zeros_like(self.nodes, dtype=bool)
        for axis in (0, 1):
            for end, at in zip(edges[axis], (0, self.shape[axis] - 2), strict=True):
                kind, here = self.case[f"edges_{end}"], index[:, axis] == at
                self.held[here, axis] |= kind in ("fixed", "roller")
                self.held[here, 1 - axis] |= kind == "fixed"

    def weights(self) -> None:
        """Nodes, weights and gradients of the four nodes of each particle's cell."""
        at = (self.x - self.low) / self.dx
        cell = np.floor(at).astype(int)
        r = at - cell
        corners = np.array([[0, 0], [0, 1], [1, 0], [1, 1]])
        self.node = (cell[:, None] + corners) @ (self.shape[1], 1)
        side = np.where(corners == 1, r[:, None], 1 - r[:, None])
        self.N, sign = side.prod(axis=2), np.where(corners == 1, 1, -1) / self.dx
        self.dN = np.stack([sign[:, 0] * side[..., 1], sign[:, 1] * side[..., 0]], axis=-1)

    def to_grid(self, values: np.ndarray) -> np.ndarray:
        """Sum of values (P,4,...) at the nodes."""
        found = np.zeros((len(self.nodes), *values.shape[2:]))
        np.add.at(found, self.node, values)
        return found

    def internal(self) -> np.ndarray:
        """Force of the stress at the nodes."""
        lam, mu = self.case["material_lam"], self.case["material_mu"]
        J, b = np.linalg.det(self.F), self.F @ self.F.transpose(0, 2, 1)
        sigma = (mu * (b - np.eye(2)) + (lam * np.log(J))[:, None, None] * np.eye(2)) / J[:, None, None]
        return -self.to_grid((self.V0 * J)[:, None, None] * np.einsum("pab,pkb->pka", sigma, self.dN))

    def body(self, t: float) -> np.ndarray:
        """Body force at the nodes: of the particles, or at the nodes themselves."""
        if self.at_nodes:
            return self.mass[:, None] * self.given.body_force_at(self.nodes, t)
        return self.to_grid(self.N[..., None] * (self.m[:, None] * self.given.body_force(self.X, t))[:, None])

    def stretch(self, v: np.ndarray) -> None:
        """F of the grid's velocity."""
        L = np.einsum("pka,pkb->pab", v[self.node], self.dN)
        self.F = self.F + self.dt * L @ self.F

    def to_particles(self, values: np.ndarray) -> np.ndarray:
        """Values of the nodes at the particles."""
        return np.einsum("pk,pka->pa", self.N, values[self.node])

    def grid(self) -> np.ndarray:
        """Velocity of the nodes, from that of the particles."""
        self.weights()
        self.mass = self.to_grid(self.N * self.m[:, None])
        full = self.mass > 1e-14 * self.m.max()
        self.per = np.where(full, 1 / np.where(full, self.mass, 1), 0)[:, None]
        v = self.to_grid(self.N[..., None] * (self.m[:, None] * self.v)[:, None]) * self.per
        v[self.held] = 0
        return v

    def acceleration(self, t: float) -> np.ndarray:
        """Acceleration of the nodes."""
        a = (self.internal() + self.body(t)) * self.per
        a[self.held] = 0
        return a

    def verlet(self) -> None:
        """One step with v at the level of x: half of the acceleration before it, half after it."""
        if self.t == 0:
            self.grid()
            self.a = self.to_particles(self.acceleration(0.0))
        self.v = self.v + self.dt / 2 * self.a
        v = self.grid()
        self.x = self.x + self.dt * self.to_particles(v)
        self.stretch(v)
        self.t += self.dt
        self.grid()
        self.a = self.to_particles(self.acceleration(self.t))
        self.v = self.v + self.dt / 2 * self.a

    def step(self) -> None:
        """One step, update-stress-last or update-stress-first."""
        v = self.grid()
        if self.levels == "first":
            self.stretch(v)
        a = self.acceleration(self.t)
        after = v + self.dt * a
        self.v = self.v + self.dt * self.to_particles(a)
        self.x = self.x + self.dt * self.to_particles(after)
        if self.levels == "last":
            self.stretch(after)
        self.t += self.dt

    def error(self) -> float:
        """Root mean square error of u over the particles and the output steps."""
        frames = {int(self.case[f"frames_{k + 1}"]) for k in range(int(self.case["frames"]))}
        squares = []
        for step in range(1, int(self.case["steps"]) + 1):
            self.verlet() if self.levels == "end" else self.step()
            if step in frames:
                exact = self.X + self.given.displacement(self.X, self.t)
                squares.append(((self.x - exact) ** 2).sum(axis=1).mean())
        return float(np.sqrt(np.mean(squares)))
