"""Defects that are planted one at a time around the kernels of the solver, for the exactness battery to see.

A defect is a function that patches; kernels stay as they are, and are called with what is wrong, or their answer is
made wrong. Weights are made wrong by kernels of the same signature around a fill.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from fixtures_edges import EDGES
from fixtures_friction import FRICTION
from fixtures_material import MATERIAL

from mpm_verify.solver import boundary, context, damping, energy_budget, model, step
from mpm_verify.solver._jit import BLOCK, kernel
from mpm_verify.solver.basis.cpdi import Cpdi
from mpm_verify.solver.basis.cpdi import fill as fill_cpdi
from mpm_verify.solver.basis.cpdi2 import Cpdi2
from mpm_verify.solver.basis.mpm import Mpm
from mpm_verify.solver.basis.mpm import fill as fill_mpm
from mpm_verify.solver.elastic import Elastic
from mpm_verify.solver.material import neo_hookean
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb
from mpm_verify.solver.model import Scheme
from mpm_verify.solver.rate_material import RateMaterial
from mpm_verify.solver.slabs import Slabs
from mpm_verify.solver.smoothing import _base as smoothing
from mpm_verify.solver.smoothing.deviatoric import Deviatoric
from mpm_verify.solver.smoothing.fbar import Fbar
from mpm_verify.solver.smoothing.volumetric import Volumetric
from mpm_verify.solver.state import Particles
from mpm_verify.solver.weights import FILL

Patch = pytest.MonkeyPatch
Plant = Callable[[Patch], None]
K = 16  # support nodes of CPDI
NAMES = (
    "fill", "K", "W", "start", "slab_columns", "first", "last", "x", "v", "F", "sigma", "m", "V0", "b", "domain",
    "origin", "inv_dx", "nx", "ny", "mass", "momentum_force", "strayed",
)  # fmt: skip
BACK = (
    "fill", "K", "W", "x", "v", "F", "domain", "origin", "inv_dx", "nx", "ny", "velocity_acceleration", "dt", "half",
    "flip", "inverted", "cell_crossings",
)  # fmt: skip


@kernel(FILL)
def swapped(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    ok = fill_cpdi(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node)
    for i in range(K * BLOCK):
        table[K * BLOCK + i], table[2 * K * BLOCK + i] = table[2 * K * BLOCK + i], table[K * BLOCK + i]
    return ok


@kernel(FILL)
def short(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    ok = fill_cpdi(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node)
    for i in range(2 * K * BLOCK, 3 * K * BLOCK):
        table[i] *= 0.998
    return ok


@kernel(FILL)
def uneven(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    ok = fill_cpdi(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node)
    for i in range(4 * BLOCK):
        table[i] *= 1.04
        table[12 * BLOCK + i] *= 0.96
    return ok


@kernel(FILL)
def by_first_area(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    ok = fill_cpdi(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node)
    for b in range(x.shape[0] // 2):
        J = F[4 * b] * F[4 * b + 3] - F[4 * b + 1] * F[4 * b + 2]
        for k in range(K):
            table[(K + k) * BLOCK + b] *= J
            table[(2 * K + k) * BLOCK + b] *= J
    return ok


@kernel(FILL)
def frozen(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    unit = np.zeros(F.shape[0])
    for b in range(x.shape[0] // 2):
        unit[4 * b] = unit[4 * b + 3] = 1.0
    return fill_cpdi(x, unit, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node)


@kernel(FILL)
def transposed(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    other = F.copy()
    for b in range(x.shape[0] // 2):
        other[4 * b + 1], other[4 * b + 2] = F[4 * b + 2], F[4 * b + 1]
    return fill_cpdi(x, other, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node)


@kernel(FILL)
def corner_twice(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    ok = fill_cpdi(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node)
    for i in range(4 * BLOCK):
        node[12 * BLOCK + i] = node[8 * BLOCK + i]
        table[12 * BLOCK + i] = table[8 * BLOCK + i]
    return ok


@kernel(FILL)
def rounded(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """The cell by round() in place of floor(): of half of the particles the next one."""
    ok = fill_mpm(x, F, domain, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node)
    for b in range(x.shape[0] // 2):
        px, py = (x[2 * b] - ox) * inv_dx, (x[2 * b + 1] - oy) * inv_dx
        i, j = np.round(px), np.round(py)
        right, above = px - i, py - j
        first = np.int64(i) * ny + np.int64(j)
        for k in range(4):
            node[k * BLOCK + b] = first + (k // 2) * ny + k % 2
            X = right if k // 2 else 1.0 - right
            Y = above if k % 2 else 1.0 - above
            table[k * BLOCK + b] = X * Y
            table[(4 + k) * BLOCK + b] = (1.0 if k // 2 else -1.0) * Y * inv_dx
            table[(8 + k) * BLOCK + b] = (1.0 if k % 2 else -1.0) * X * inv_dx
    return ok


def weights(fill: Any, kind: Any = Cpdi) -> Plant:
    """Another fill of a basis."""
    return lambda patch: patch.setattr(kind, "fill", staticmethod(fill))


def to_grid(change: Callable[[dict[str, Any]], None]) -> Plant:
    """Particles to grid with changed arguments."""

    def plant(patch: Patch) -> None:
        original = step.p2g

        def p2g(*given: Any) -> None:
            named = dict(zip(NAMES, given, strict=True))
            change(named)
            original(*named.values())

        patch.setattr(step, "p2g", p2g)

    return plant


def det(F: Any) -> Any:
    return F[:, 0, 0] * F[:, 1, 1] - F[:, 0, 1] * F[:, 1, 0]


def first_volume(a: dict[str, Any]) -> None:
    a["V0"] = a["V0"] / det(a["F"])


def body_force(factor: float) -> Callable[[dict[str, Any]], None]:
    return lambda a: a.update(b=factor * a["b"])


def without_last(a: dict[str, Any]) -> None:
    a["m"], a["V0"] = a["m"].copy(), a["V0"].copy()
    a["m"][-1] = a["V0"][-1] = 0.0


def volume_as_mass(a: dict[str, Any]) -> None:
    a["m"] = a["m"] * det(a["F"])


def shear_in_one_row(patch: Patch) -> None:
    original = step.p2g

    def p2g(*given: Any) -> None:
        named = dict(zip(NAMES, given, strict=True))
        named["sigma"] = named["sigma"].copy()
        named["sigma"][:, 3] = 0.0
        original(*named.values())
        fx = named["momentum_force"][:, 2].copy()
        original(*given)
        named["momentum_force"][:, 2] = fx

    patch.setattr(step, "p2g", p2g)


def to_particles(change: Callable[[dict[str, Any], Any], None]) -> Plant:
    """Grid to particles, and then a change; it gets the arguments and the arrays x, v, F before."""

    def plant(patch: Patch) -> None:
        original = step.g2p

        def g2p(*given: Any) -> None:
            named = dict(zip(BACK, given, strict=True))
            before = {name: named[name].copy() for name in ("x", "v", "F")}
            original(*given)
            change(named, before)

        patch.setattr(step, "g2p", g2p)

    return plant


def gradient(a: dict[str, Any], before: Any) -> Any:
    """dt L of the step."""
    return a["F"] @ np.linalg.inv(before["F"]) - np.eye(2)


def new_f(rule: Callable[[Any, Any], Any]) -> Plant:
    def change(a: dict[str, Any], before: Any) -> None:
        a["F"][:] = rule(gradient(a, before), before["F"])

    return to_particles(change)


def flip(fraction: float) -> Plant:
    """Velocities of a blend of FLIP and PIC."""

    def plant(patch: Patch) -> None:
        original = step.g2p
        at = BACK.index("flip")
        patch.setattr(step, "g2p", lambda *a: original(*a[:at], fraction * a[at], *a[at + 1 :]))

    return plant


def own_velocity(a: dict[str, Any], before: Any) -> None:
    a["x"][:] = before["x"] + a["dt"] * a["v"]


def longer_move(a: dict[str, Any], before: Any) -> None:
    a["x"][:] = before["x"] + 1.0005 * (a["x"] - before["x"])


def old_gradient(patch: Patch) -> None:
    """L from the velocities before the step."""

    def grid_to_particles(m: Any) -> None:
        g, p = m.grid, m.particles
        new, F = g.velocity_acceleration.copy(), p.F.copy()
        x, v = p.x.copy(), p.v.copy()
        mass = g.mass[:, None]
        g.velocity_acceleration[:, :2] = np.divide(
            g.momentum, mass, out=np.zeros_like(g.momentum), where=mass > m.cutoff
        )
        kept(m)
        strained = p.F.copy()
        g.velocity_acceleration[:], p.F[:], p.x[:], p.v[:] = new, F, x, v
        kept(m)
        p.F[:] = strained

    kept = step.grid_to_particles
    patch.setattr(step, "grid_to_particles", grid_to_particles)


def late_load(patch: Patch) -> None:
    """Body force at the end of the step."""
    original = step.advance

    def advance(m: Any, load: Any) -> None:
        original(m, lambda p, t: load(p, t + m.dt))

    from mpm_verify.cases.exact import motion

    patch.setattr(motion, "advance", advance)


def reaction_handed_on(patch: Patch) -> None:
    original = step.solve

    def solve(*a: Any) -> None:
        original(*a[:6], True, *a[7:])

    patch.setattr(step, "solve", solve)


def wall_missing(patch: Patch) -> None:
    original = step.solve

    def solve(mass: Any, mf: Any, va: Any, held: Any, *a: Any) -> None:
        ny = a[-1]
        other = held.copy()
        other[: 3 * ny, 0] = False  # the left one
        original(mass, mf, va, other, *a)

    patch.setattr(step, "solve", solve)


def wall_further_in(patch: Patch) -> None:
    original = step.solve

    def solve(mass: Any, mf: Any, va: Any, held: Any, *a: Any) -> None:
        other = held.reshape(-1, a[-1], 2).copy()
        other[1:, :, 0] |= other[:-1, :, 0]
        original(mass, mf, va, other.reshape(-1, 2), *a)

    patch.setattr(step, "solve", solve)


def large_cutoff(patch: Patch) -> None:
    patch.setattr(context.Context, "cutoff", property(lambda self: 0.3 * float(self.particles.m.max())))


def damping_left_on(patch: Patch) -> None:
    original = step.stress_last

    def stress_last(m: Any) -> None:
        original(m)
        m.particles.v *= 0.9995

    patch.setitem(step.STRESS_UPDATES, "usl", stress_last)


def damping_of_the_total(patch: Patch) -> None:
    """Damping by the sign of the force in place of that of the velocity."""
    original = damping.damp

    def damp(mass: Any, mf: Any, held: Any, alpha: float, *a: Any) -> float:
        mf[:, 2:] *= 1 - alpha
        return float(original(mass, mf, held, 0.0, *a))

    patch.setattr(damping, "damp", damp)


def neo(change: Callable[[Any, Any, float, float], None]) -> Plant:
    """Neo-Hookean stress, and then a change of sigma; it gets F, sigma, lam, mu."""

    def plant(patch: Patch) -> None:
        original = neo_hookean.stress

        def stress(F: Any, sigma: Any, lam: float, mu: float) -> None:
            original(F, sigma, lam, mu)
            change(F, sigma, lam, mu)

        patch.setattr(neo_hookean, "stress", stress)

    return plant


def other_neo(arguments: Callable[[Any, float, float], tuple[Any, float, float]]) -> Plant:
    """Neo-Hookean stress of other arguments F, lam, mu."""

    def plant(patch: Patch) -> None:
        original = neo_hookean.stress

        def stress(F: Any, sigma: Any, lam: float, mu: float) -> None:
            F, lam, mu = arguments(F, lam, mu)
            original(np.ascontiguousarray(F), sigma, lam, mu)

        patch.setattr(neo_hookean, "stress", stress)

    return plant


def logarithm(other: Callable[[Any], Any]) -> Plant:
    """Another function in place of ln J."""

    def change(F: Any, sigma: Any, lam: float, mu: float) -> None:
        J = det(F)
        sigma[:, :3] += (lam / J * (other(J) - np.log(J)))[:, None]

    return neo(change)


def times_j(F: Any, sigma: Any, lam: float, mu: float) -> None:
    sigma *= det(F)[:, None]


def no_zz(F: Any, sigma: Any, lam: float, mu: float) -> None:
    sigma[:, 2] = 0.0


def shear_sign(F: Any, sigma: Any, lam: float, mu: float) -> None:
    sigma[:, 3] *= -1.0


def late_stress(patch: Patch) -> None:
    """Stress of the F at the start of the step."""
    original = step.update_stress

    def update_stress(m: Any, x: Any) -> None:
        sigma = m.particles.sigma.copy()
        original(m, x)
        m.particles.sigma[:] = sigma

    patch.setattr(step, "update_stress", update_stress)


def memory(column: int, keep: float = 0.0) -> Plant:
    """A column of the memory overwritten by its increment in place of summed."""

    def plant(patch: Patch) -> None:
        original = RateMaterial.update

        def update(self: Any, particles: Any, dt: float, F_smoothed: Any = None) -> None:
            old = particles.history.copy()
            original(self, particles, dt, F_smoothed)
            grown = particles.history[:, column] - old[:, column]
            particles.history[:, column] = np.where(grown != 0, grown + keep * old[:, column], old[:, column])

        patch.setattr(RateMaterial, "update", update)

    return plant


def old_rotation(patch: Patch) -> None:
    """Polar rotation of the old F at both ends of the step."""
    from mpm_verify.solver import rate_material

    original = rate_material.integrate

    def integrate(unrotate: Any, rotate: Any, respond: Any, constants: Any, F_old: Any, smoothed: Any, F: Any,
                  sigma: Any, *rest: Any) -> None:  # fmt: skip
        before = F_old.reshape(-1, 2, 2).copy()
        original(unrotate, rotate, respond, constants, F_old, smoothed, F, sigma, *rest)
        U, _, V = np.linalg.svd(before)
        U1, _, V1 = np.linalg.svd(F)
        Q = (U @ V) @ (U1 @ V1).transpose(0, 2, 1)
        plane = sigma[:, [0, 3, 3, 1]].reshape(-1, 2, 2)
        turned = Q @ plane @ Q.transpose(0, 2, 1)
        sigma[:, 0], sigma[:, 1], sigma[:, 3] = turned[:, 0, 0], turned[:, 1, 1], turned[:, 0, 1]

    patch.setattr(rate_material, "integrate", integrate)


def no_cut_off(patch: Patch) -> None:
    """Tension of a soil left as its elastic trial."""
    original = RateMaterial.update

    def update(self: Any, particles: Any, dt: float, F_smoothed: Any = None) -> None:
        original(self, particles, dt, F_smoothed)
        apart = (particles.sigma[:, :3] > -1e-9).all(axis=1)
        particles.sigma[apart, :3] += 1e-6 * self.rho0 * self.wave_speed() ** 2

    patch.setattr(RateMaterial, "update", update)


def after_update(change: Callable[[Any, Any, Any], None]) -> Plant:
    """Rate form: a change after each update; it gets the model, the particles, and history and sigma before."""

    def plant(patch: Patch) -> None:
        original = RateMaterial.update

        def update(self: Any, particles: Any, dt: float, F_smoothed: Any = None) -> None:
            old = (particles.history.copy(), particles.sigma.copy())
            original(self, particles, dt, F_smoothed)
            change(self, particles, old)

        patch.setattr(RateMaterial, "update", update)

    return plant


def old_zz(material: Any, particles: Any, old: Any) -> None:
    particles.sigma[:, 2] = old[1][:, 2]


def half_gamma(material: Any, particles: Any, old: Any) -> None:
    particles.history[:, 0] -= 0.5 * (particles.history[:, 0] - old[0][:, 0])


def drifting_zz(material: Any, particles: Any, old: Any) -> None:
    """Stress that grows along the axis x, whatever turns."""
    particles.sigma[:, 0] += 1e-6 * material.rho0 * material.wave_speed() ** 2


def smaller_domains(patch: Patch) -> None:
    original = Cpdi.domain
    patch.setattr(Cpdi, "domain", lambda self, layout, position: 0.99 * original(self, layout, position))


def corners_too_far(patch: Patch) -> None:
    original = Cpdi2.convect
    patch.setattr(Cpdi2, "convect", staticmethod(lambda particles, grid, dt: original(particles, grid, 1.01 * dt)))


def weak_damping(patch: Patch) -> None:
    original = damping.damp
    patch.setattr(damping, "damp", lambda mass, mf, held, alpha, *a: original(mass, mf, held, 0.99 * alpha, *a))


def plane_stress(patch: Patch) -> None:
    usual = Elastic.lam.fget
    patch.setattr(Elastic, "lam", property(lambda m: 2 * usual(m) * m.mu / (usual(m) + 2 * m.mu)))


def bar_wave(patch: Patch) -> None:
    patch.setattr(Elastic, "wave_speed", lambda self, s=None: float(np.sqrt(self.E / self.rho0)))


def more_friction(patch: Patch) -> None:
    original = MohrCoulomb.constants
    patch.setattr(MohrCoulomb, "constants", lambda self: original(replace(self, phi=1.001 * self.phi)))


def projected(change: Callable[[tuple[Any, ...]], None]) -> Plant:
    """Projection of a smoothing, and then a change of its arguments: x, V, values, ..., out."""

    def plant(patch: Patch) -> None:
        original = smoothing.project

        def project(*a: Any) -> None:
            original(*a)
            change(a)

        patch.setattr(smoothing, "project", project)

    return plant


def unweighted(patch: Patch) -> None:
    original = smoothing.project
    patch.setattr(smoothing, "project", lambda x, V, *a: original(x, np.ones_like(V), *a))


def half_way(a: tuple[Any, ...]) -> None:
    a[-1][:] = 0.5 * (a[-1] + a[2])


def low(a: tuple[Any, ...]) -> None:
    a[-1][:] *= 0.999


def all_parts(patch: Patch) -> None:
    for kind in (Deviatoric, Volumetric):
        patch.setattr(kind, "deviatoric", True)
        patch.setattr(kind, "volumetric", True)


def exponent(patch: Patch) -> None:
    def strain(self: Any, m: Any, x: Any) -> Any:
        p = m.particles
        ratio = np.linalg.det(p.F) / np.linalg.det(p.F_old.reshape(-1, 2, 2))
        mean = self.project(m, x, ratio[:, None])[:, 0]
        return ((1 + self.beta * (mean / ratio - 1)) ** (1 / 3))[:, None, None] * p.F

    patch.setattr(Fbar, "strain", strain)


def fourfold_stress(a: dict[str, Any]) -> None:
    a["sigma"] = 4.0 * a["sigma"]


def other_limit(patch: Patch) -> None:
    """Step limit without the speed of the body."""

    def check(m: Any) -> None:
        if m.dt > m.grid.dx / m.material.wave_speed():
            raise model.RunFailed(model.FailureKind.UNSTABLE_STEP)

    from mpm_verify.cases.exact import state

    patch.setattr(state, "check_time_step", check)


def hidden_state(patch: Patch) -> None:
    """Something of the last step, which no array of the particles holds, goes into the next."""
    original = step.stress_last

    def stress_last(m: Any) -> None:
        m.particles.v *= 1.0 + 1e-15 * getattr(m, "told", 0.0)
        original(m)
        m.told = 1.0

    patch.setitem(step.STRESS_UPDATES, "usl", stress_last)


def patched(module: Any, name: str, made: Callable[[Any], Any]) -> Plant:
    """Defect that replaces a function by one made of it."""
    return lambda patch: patch.setattr(module, name, made(getattr(module, name)))


def unnamed(original: Any) -> Any:
    """A failed particle is told by its row."""

    def fail(context: Any, row: int, *given: Any) -> None:
        context.particles.id[row] = row
        original(context, row, *given)

    return fail


def forgets(name: str) -> Callable[[Any], Any]:
    """An array keeps its rows when the others are put in another order."""

    def made(original: Any) -> Any:
        def reorder(self: Any, order: Any) -> None:
            kept = getattr(self, name)
            original(self, order)
            setattr(self, name, kept)

        return reorder

    return made


def one_late(original: Any) -> Any:
    """A slab starts one particle late."""

    def sort(self: Any, *given: Any) -> None:
        original(self, *given)
        self.start[1] += 1

    return sort


def breathes(original: Any) -> Any:
    """Damping of nothing takes a last digit."""

    def equation_of_motion(m: Any) -> None:
        original(m)
        if m.damping:
            m.grid.velocity_acceleration *= 1 + 1e-13

    return equation_of_motion


@dataclass(frozen=True)
class Defect:
    """A defect: how it is planted, the tests that have to see it, and the method and material that have it."""

    plant: Plant
    seen_by: tuple[str, ...]
    method: str = "cpdi"
    material: str = "neo_hookean"


DEFECTS = {
    "gradients swapped": Defect(weights(swapped), ("moments", "affine", "virtual_work")),
    "corner weights": Defect(weights(uneven), ("moments", "wall_moments", "sum_mass", "mirror")),
    "dN/dy 0.2 % low": Defect(weights(short), ("moments", "affine", "virtual_work", "quarter_turn")),
    "gradient by the first area": Defect(weights(by_first_area), ("moments", "affine", "virtual_work")),
    "domains never updated": Defect(weights(frozen), ("domain_moment", "wide_moments", "domain_reach")),
    "domains by F^T": Defect(weights(transposed), ("domain_moment",)),
    "a corner twice": Defect(weights(corner_twice), ("moments", "affine", "sum_mass")),
    "round for floor": Defect(weights(rounded, Mpm), ("positive",), "mpm"),
    "force with V0": Defect(to_grid(first_volume), ("virtual_work", "far_work", "step")),
    "sigma_xy in one row": Defect(shear_in_one_row, ("virtual_work", "step", "quarter_turn")),
    "no body force": Defect(to_grid(body_force(0.0)), ("fall", "sum_force", "step")),
    "body force 1 % high": Defect(to_grid(body_force(1.01)), ("fall", "sum_force", "step")),
    "body force at t + dt": Defect(late_load, ("fall",)),
    "last particle skipped": Defect(
        to_grid(without_last), ("sum_mass", "sum_momentum", "step", "budget"), material="hypoelastic"
    ),
    "current volume as mass": Defect(to_grid(volume_as_mass), ("sum_mass", "step")),
    "reaction handed on": Defect(reaction_handed_on, ("no_force_roller", "no_force_fixed", "step")),
    "a wall missing": Defect(wall_missing, ("step",)),
    "wall a node further in": Defect(wall_further_in, ("step",)),
    "cut-off far too large": Defect(large_cutoff, ("fall",)),
    "damping left on": Defect(damping_left_on, ("fall", "no_force_free", "slide", "step")),
    "damping by the force": Defect(damping_of_the_total, ("throw_damped_local", "oscillator_objective")),
    "PIC": Defect(flip(0.0), ("no_force_free", "affine", "step")),
    "FLIP 0.99": Defect(flip(0.99), ("no_force_free", "affine", "step")),
    "moved with their own velocity": Defect(to_particles(own_velocity), ("affine", "step")),
    "dt off in the move": Defect(to_particles(longer_move), ("fall", "affine", "step")),
    "L from the old velocity": Defect(old_gradient, ("affine", "step")),
    "F += dt L": Defect(new_f(lambda A, F: F + A), ("affine", "step")),
    "L transposed": Defect(new_f(lambda A, F: F + A.transpose(0, 2, 1) @ F), ("affine", "step")),
    "F (I + dt L)": Defect(new_f(lambda A, F: F + F @ A), ("affine", "step")),
    "F never updated": Defect(new_f(lambda A, F: F), ("affine", "step")),
    "stress lags F": Defect(late_stress, ("step",)),
    "missing 1/J": Defect(neo(times_j), ("stress", "stress_turned")),
    "sigma_zz = 0": Defect(neo(no_zz), ("stress",)),
    "F^T F for F F^T": Defect(other_neo(lambda F, lam, mu: (F.transpose(0, 2, 1), lam, mu)), ("stress",)),
    "plane-stress lambda": Defect(
        other_neo(lambda F, lam, mu: (F, 2 * lam * mu / (lam + 2 * mu), mu)), ("stress", "stress_turned")
    ),
    "log10 for ln": Defect(logarithm(np.log10), ("stress",)),
    "ln J = J - 1": Defect(logarithm(lambda J: J - 1), ("stress",)),
    "shear sign": Defect(neo(shear_sign), ("stress",)),
    "old rotation at both ends": Defect(old_rotation, ("rigid_turn",), material="hypoelastic"),
    "gamma_p overwritten": Defect(memory(0), ("history_sums",), material="mohr_coulomb"),
    "gamma_p of UBCSAND overwritten": Defect(memory(1), ("history_sums",), material="ubcsand"),
    "eps_v_p overwritten": Defect(memory(1), ("history_sums", "plastic_volume"), material="drucker_prager"),
    "no tension cut-off": Defect(no_cut_off, ("cut_off",), material="mohr_coulomb"),
    "step limit of another speed": Defect(other_limit, ("step_limit",)),
    "half sides 1 % short": Defect(smaller_domains, ("domain_area", "shared_corners", "domain_moment")),
    "corners move 1 % too far": Defect(corners_too_far, ("domain_motion",), "cpdi2"),
    "damping 1 % low": Defect(
        weak_damping,
        ("throw_damped_local", "throw_damped_objective", "oscillator_local", "oscillator_objective"),
    ),
    "zz never updated": Defect(after_update(old_zz), ("increment",), material="hypoelastic"),
    "stress along an axis": Defect(
        after_update(drifting_zz), ("turned_path", "rigid_turn", "increment", "rate_path"), material="hypoelastic"
    ),
    "half of gamma_p": Defect(after_update(half_gamma), ("plastic_shear",), material="mohr_coulomb"),
    "constants of plane stress": Defect(plane_stress, ("constants",)),
    "wave of a bar": Defect(bar_wave, ("wave_speed",)),
    "phi 0.1 % high": Defect(more_friction, ("strength",), material="mohr_coulomb"),
    "means without volumes": Defect(unweighted, ("smoothing_means", "smoothing_adjoint"), material="hypoelastic"),
    "half of the projection": Defect(projected(half_way), ("smoothing_twice",), material="hypoelastic"),
    "means 0.1 % low": Defect(projected(low), ("smoothing_constants", "smoothing_uniform"), material="hypoelastic"),
    "all parts smoothed": Defect(all_parts, ("smoothing_parts",), material="hypoelastic"),
    "exponent of three dimensions": Defect(exponent, ("smoothing_ratio",), material="hypoelastic"),
    "stress counted four times": Defect(to_grid(fourfold_stress), ("stable_step", "virtual_work", "smoothing_force")),
    "move not counted": Defect(to_particles(longer_move), ("budget",), material="hypoelastic"),
    "filter not counted": Defect(
        patched(energy_budget, "in_filter", lambda f: lambda *given: None), ("budget",), material="hypoelastic"
    ),
    "inverted goes on": Defect(patched(step, "fail_if_inverted", lambda f: lambda m: None), ("inverted_ends",)),
    "told by its row": Defect(patched(step, "fail", unnamed), ("inverted_ends",)),
    "outside goes on": Defect(patched(step, "fail_if_outside", lambda f: lambda *given: None), ("left_ends",)),
    "x keeps its rows": Defect(patched(Particles, "reorder", forgets("x")), ("any_order", "arrays_along")),
    "carried keeps its rows": Defect(patched(Particles, "reorder", forgets("carried")), ("arrays_along",)),
    "a slab starts late": Defect(patched(Slabs, "sort", one_late), ("slabs",)),
    "a third of dt": Defect(patched(Scheme, "half", lambda f: lambda self, dt: f(self, dt) / 1.5), ("deformation",)),
    "damping of nothing takes": Defect(patched(step, "equation_of_motion", breathes), ("undamped",)),
    "state that is not stored": Defect(hidden_state, ("restart",)),
    **{name: Defect(plant, seen_by) for name, (plant, seen_by) in EDGES.items()},
    **{name: Defect(plant, seen_by, material="hypoelastic") for name, (plant, seen_by) in FRICTION.items()},
    **{name: Defect(plant, seen_by, material=material) for name, (plant, seen_by, material) in MATERIAL.items()},
}


def by_numpy(patch: Patch) -> None:
    """Placebo: the equation of motion in NumPy."""

    def solve(mass: Any, mf: Any, va: Any, held: Any, value: Any, rate: Any, stops: bool, dt: float, cutoff: float,
              ny: int) -> None:  # fmt: skip
        some = np.divide(1.0, mass, out=np.zeros_like(mass), where=mass > cutoff)[:, None]
        before, a = some * mf[:, :2], some * mf[:, 2:]
        v = np.where(held, value, before + dt * a)
        va[:, :2] = v
        va[:, 2:] = np.where(held, (v - before) / dt if stops else rate, a)

    for module in (step, boundary):
        patch.setattr(module, "solve", solve)


def stress_in_numpy(patch: Patch) -> None:
    """Placebo: the neo-Hookean stress in another order of operations."""

    def stress(F: Any, sigma: Any, lam: float, mu: float) -> None:
        J = det(F)
        back = np.linalg.inv(F).transpose(0, 2, 1)
        P = mu * (F - back) + (lam * np.log(J))[:, None, None] * back
        plane = P @ F.transpose(0, 2, 1) / J[:, None, None]
        sigma[:, 0], sigma[:, 1], sigma[:, 3] = plane[:, 0, 0], plane[:, 1, 1], plane[:, 0, 1]
        sigma[:, 2] = lam * np.log(J) / J

    patch.setattr(neo_hookean, "stress", stress)


def other_side_vectors(patch: Patch) -> None:
    """Placebo: the same parallelogram, its corners counted from the next one."""
    original = Cpdi.domain

    def domain(self: Any, layout: Any, position: Any) -> Any:
        r0 = original(self, layout, position)
        return np.column_stack([r0[:, 2:], -r0[:, :2]])

    patch.setattr(Cpdi, "domain", domain)


def zero_damping(patch: Patch) -> None:
    """Placebo: damping of nothing in each step."""
    original = step.equation_of_motion

    def equation_of_motion(m: Any) -> None:
        m.damping = m.damping or damping.Damping(0.0)
        original(m)

    patch.setattr(step, "equation_of_motion", equation_of_motion)


def sums_in_halves(patch: Patch) -> None:
    """Placebo: forces and momentum added by halves."""
    original = step.p2g

    def p2g(*given: Any) -> None:
        named = dict(zip(NAMES, given, strict=True))
        original(*given)
        kept = named["momentum_force"].copy()
        original(*given)
        named["momentum_force"][:] = 0.5 * kept + 0.5 * named["momentum_force"]

    patch.setattr(step, "p2g", p2g)


PLACEBOS = {
    "equation of motion in NumPy": by_numpy,
    "stress in NumPy": stress_in_numpy,
    "other side vectors": other_side_vectors,
    "damping of nothing": zero_damping,
    "sums in halves": sums_in_halves,
}
