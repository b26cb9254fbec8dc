"""Measurements of a collapsing column: front, toe and height of the heap, energies, momenta, and what is scaled.

Front: the distance from the wall within which 99 or 99.9 % of the mass lies; single particles fly further. Toe: the
far end of the heap that is connected to the wall, in squares of a seventh of the width, by sides or corners. In a
triangle the two fronts are at 0.9 and 0.968 of the toe.
Height: below it lie 99 % of the mass of the heap next to the wall, in a strip of a seventh of the width; the profile is
the same for each strip. A seventh on any grid, so that grids can be compared, unless cells are wider. The height by fit
is that at the wall of a line through the first width of the levelled surface (heap.py), which a sliver that hangs at
the wall does not lift. Crowding: the
volume V = J V0 that particles keep, over the space in which they are, within the heap. It should be 1; where particles
drift closer than their det F knows, or apart, it is not, and the heap is smaller, or larger, than its material.
On the grid: half the sum of m v^2 over the nodes, without the velocities of particles that no node sees.
"""

from math import cos, inf, radians, sin, sqrt
from typing import Any

import numpy as np

from mpm_verify.cases.column.heap import at_wall, by_volume, connected, crowding, levelled, quantile, surface
from mpm_verify.cases.column.run import AT_REST, ColumnRun
from mpm_verify.solver.energy_budget import Budget, given, kinetic, residual
from mpm_verify.solver.friction import FrictionalWalls
from mpm_verify.solver.model import Model, Observer
from mpm_verify.solver.state import Floats

LOOKS = 200  # rows of a run
SLACK = 1e-6  # of the largest stress: what round-off may pass the strength by


class Measure(Observer):
    """Observer that takes a row of numbers and profiles at each look, with an energy budget of the steps between.

    `run` says which way the heap runs.
    """

    def __init__(self, run: ColumnRun, model: Model) -> None:
        self.run, self.end = run, float(model.grid.upper[0])
        self.strips, self.near = round(self.end / run.strip), round(run.width / run.strip)
        self.first: dict[str, float] = {}
        self.rows: list[dict[str, Any]] = []
        self.momentum = momentum(model)
        self.plastic, self.worked = 0.0, worked(model)
        self.steps = round(run.duration / model.dt)
        self.budget = Budget(np.array([0.0, -run.g]), kinetic(model.particles))
        model.watch(self.budget)

    def after_step(self, model: Model) -> None:
        """Look where it is due."""
        if due(model.steps, self.steps, LOOKS):
            self.look(model)

    def positions(self, model: Model) -> Floats:
        """Positions (P,2) of the particles, x as the distance from the wall; clipped to the grid."""
        x = np.clip(np.nan_to_num(model.particles.x), 0, model.grid.upper)
        return np.stack([self.end - x[:, 0], x[:, 1]], axis=1) if self.run.mirror else x

    def look(self, model: Model) -> None:
        """Measure now: one row."""
        p, x = model.particles, self.positions(model)
        V, heap = p.V0 * p.J, connected(x, self.run.strip)
        profiles = self.surfaces(x[heap], p.m[heap], V[heap])
        terms = self.budget.terms(model)
        self.first = self.first or terms
        moved = momentum(model) - self.momentum
        given = self.budget.impulse + self.budget.gravity * float(p.m.sum()) * model.time
        row: dict[str, Any] = {
            "t": model.time,
            "front_99": quantile(x[:, 0], p.m, 0.99),
            "front_999": quantile(x[:, 0], p.m, 0.999),
            "toe": float(x[heap, 0].max()),
            "height": float(profiles["profile"][0]),
            "height_fit": at_wall(profiles["profile_levelled"][: self.near], self.run.strip),
            **terms,
            "friction": model.walls.taken if isinstance(model.walls, FrictionalWalls) else 0.0,
            **self.split(model, terms["work"]),
            "residual": residual(terms, self.first),
            "momentum_lost": float(np.abs(moved - given).max()),
            "mass": float(p.m.sum()),
            "mass_lost": abs(float(model.grid.mass.sum()) / float(p.m.sum()) - 1) if model.steps else 0.0,
            "fastest": float(np.hypot(*p.v.T).max()),
            **strength(model),
            **scaled(model),
            "crowding": crowding(x, V, self.run.strip),
            **books(model),
        }
        row["courant"] = model.dt / model.grid.dx * (model.material.wave_speed(row["largest_s"]) + row["fastest"])
        self.rows.append(row | profiles)

    def surfaces(self, x: Floats, m: Floats, V: Floats) -> dict[str, Floats]:
        """Surfaces (strips,) of the heap by name: the recorded one, the levelled one, and that by volume."""
        of = self.run.strip, self.strips
        return {
            "profile": surface(x, m, *of),
            "profile_levelled": levelled(x, m, V, *of),
            "profile_volume": by_volume(x, V, *of),
        }

    def split(self, model: Model, work: float) -> dict[str, float]:
        """Elastic and plastic part of the work of stress, what pooling has taken of it, and what crowding was given.

        Linear elasticity stores an energy, and the rest is plastic. UBCSAND, whose moduli follow s, has none: there the
        material gives the plastic work, per volume as it is, and the rest is called elastic.
        """
        p, stored = model.particles, model.material.stored_energy
        pooled = model.pooling.taken if model.pooling else 0.0
        more = {"pooled": pooled, "given": given(model)}
        work += more["given"] - pooled
        if stored:
            elastic = float((p.V0 * p.J * stored(p.sigma)).sum())
            return {"elastic": elastic, "plastic": work - elastic, **more}
        now = worked(model)
        volume = p.in_initial_order("V0") * p.in_initial_order("J")
        self.plastic += float((volume * (now - self.worked)).sum())
        self.worked = now
        return {"elastic": work - self.plastic, "plastic": self.plastic, **more}

    def curves(self) -> dict[str, Floats]:
        """Columns of the rows, and profiles (T,strips)."""
        return {name: np.array([row[name] for row in self.rows]) for name in (self.rows[0] if self.rows else ())}


def due(step: int, steps: int, times: int) -> bool:
    """Whether this step is one of so many, evenly spread, the last one among them."""
    return step * times // steps != (step - 1) * times // steps


def momentum(model: Model) -> Floats:
    """Momentum of all particles (2,)."""
    total: Floats = (model.particles.m[:, None] * model.particles.v).sum(axis=0)
    return total


def worked(model: Model) -> Floats:
    """Plastic work per volume of each particle (P,), in the initial order, of a material that counts it; else zero."""
    memory = model.material.memory
    if "work_p" not in memory:
        return np.zeros(len(model.particles))
    found: Floats = model.particles.in_initial_order("history")[:, memory.index("work_p")]
    return found


def strength(model: Model) -> dict[str, float]:
    """Fraction of particles whose stress, as the forces have it, is outside the strength in the plane, and by how much.

    `beyond`: the largest t/(s sin phi + c cos phi) - 1 of particles with more than 1 % of the largest s. Of materials
    that yield by t and s alone; zero of others. `idle`: the fraction without stress. `largest_s`: the largest s.
    """
    p, material = model.particles, model.material
    sigma = p.sigma_smoothed if p.sigma_smoothed.size else p.sigma
    s, t = -(sigma[:, 0] + sigma[:, 1]) / 2, np.hypot((sigma[:, 0] - sigma[:, 1]) / 2, sigma[:, 3])
    found = {
        "largest_s": float(s.max()),
        "idle": float((p.sigma == 0).all(axis=1).mean()),
        "outside": 0.0,
        "beyond": 0.0,
    }
    if not material.yields_in_plane:
        return found
    phi = radians(material.friction_angle or 0.0)
    strong = sin(phi) * s + (material.cohesion or 0.0) * cos(phi)
    pressed = s > 0.01 * max(float(s.max()), 1e-300)
    ratio = t[pressed] / strong[pressed] - 1
    outside = float((t > strong + SLACK * float(np.abs(sigma).max())).mean())
    return found | {"outside": outside, "beyond": float(max(0.0, ratio.max(initial=0.0)))}


def scaled(model: Model) -> dict[str, float]:
    """Fractions of particles with a cut domain and with void strain, the volume of void per solid, extremes of J."""
    p, memory = model.particles, model.material.memory
    cut = float(model.basis.cut(p.F, p.domain, model.grid.dx).mean())
    void = p.history[:, memory.index("void")] if "void" in memory else np.zeros(1)
    J = p.J
    return {
        "cut": cut,
        "void": float((void > 0).mean()),
        "void_strain": float(void.mean()),
        "least_J": float(J.min()),
        "largest_J": float(J.max()),
    }


def books(model: Model) -> dict[str, float]:
    """Means over the body: volume ratio, plastic dilation, what crowding took, and `unbooked` of ln J.

    Unbooked is what no strain accounts for: ln J is elastic volume, plastic dilation and void strain; pooling moves it
    between particles and keeps the mean. Without pooling `unbooked` is 0.
    """
    p, memory = model.particles, model.material.memory
    whole, J = float(p.V0.sum()), p.J
    dilated, void = (p.history[:, memory.index(name)] if name in memory else 0 * J for name in ("eps_v_p", "void"))
    found = {"volume": float((p.V0 * J).sum()) / whole, "dilated": float((p.V0 * dilated).sum()) / whole}
    found["drifted"] = model.pooling.crowding.strain if model.pooling else 0.0
    if model.pooling is None or model.pooling.compression is None:
        return found | {"unbooked": 0.0}
    rest = np.log(J) - dilated - void + model.pooling.compression.held(p.sigma)
    return found | {"unbooked": float((p.V0 * rest).sum()) / whole}


def final(run: ColumnRun, curves: dict[str, Floats]) -> dict[str, float]:
    """Numbers of a run: those at its end, the largest of some, and when it came to rest.

    `rest`: since when the kinetic energy of the grid is below AT_REST of the potential energy; inf if it is not, and of
    a run too short for a column to have fallen, sqrt(h0 / g).
    `area`: under the final profile, over that of the column: 1 and what it has dilated, or less where it has shrunk;
    some hundredths too low, as that profile is. `area_levelled`: under the levelled one, which is not.
    Fractions of the initial potential energy, largest at any time: `unbalanced`, of the budget; `misworked`, between
    the work of the material and that of the forces; `lost` by the method; `plastic_falls`, that plastic work gave back.
    `booked`: area over the mean volume ratio divided by crowding, 1 where the measures of the heap agree.
    `creep`: how much the height still changed in the last fifth of the time, as a fraction of it; `creep_fit`: of that
    by fit.
    """
    values = {name: float(column[-1]) for name, column in curves.items() if column.ndim == 1}
    for name in (
        "outside",
        "beyond",
        "largest_s",
        "cut",
        "void",
        "fastest",
        "momentum_lost",
        "largest_J",
        "courant",
        "mass_lost",
    ):
        values[f"most_{name}"] = float(curves[name].max())
    first = float(curves["potential"][0])
    moving = np.flatnonzero(curves["on_grid"] > AT_REST * first)
    last = int(moving[-1]) if len(moving) else 0
    t = curves["t"]
    fallen = t[-1] >= sqrt(run.height / run.g)
    values["rest"] = float(t[last + 1]) if fallen and last + 1 < len(t) else inf
    for creep, height in {"creep": curves["height"], "creep_fit": curves["height_fit"]}.items():
        values[creep] = float(height[t >= 0.8 * t[-1]][0] - height[-1]) / max(float(height[-1]), 1e-300)
    plastic = curves["plastic"]
    values["unbalanced"] = float(np.abs(curves["residual"]).max()) / first
    values["misworked"] = float(np.abs(curves["convection"]).max()) / first
    values["lost"] = float(np.abs(curves["transfer"] + curves["convection"]).max()) / first
    values["plastic_falls"] = float((np.maximum.accumulate(plastic) - plastic).max()) / first
    values["run_out"] = values["front_99"] / run.width - 1
    for area, profile in {"area": "profile", "area_levelled": "profile_levelled"}.items():
        values[area] = float(curves[profile][-1].sum()) * run.strip / (run.width * run.height)
    values["booked"] = values["area"] * values["crowding"] / values["volume"]
    return values
