"""Readings of the positions of an answer against the exact ones: of another particle, another time, held at a wall."""

from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mpm_verify.cases.mms.external.balance import Balance, Tried
from mpm_verify.cases.mms.external.evidence import Evidence
from mpm_verify.cases.solvers.matching import NEAR
from mpm_verify.solver.sides import SOLID_SIDES
from mpm_verify.solver.state import Floats

Bools = NDArray[np.bool_]
Indices = NDArray[np.intp]
BETTER = 0.5  # factor on an error that is no accident
CLEAR = 0.1  # factor on the error of particles in another order
SCALED, ROUNDED = 0.35, 0.05  # factor on the error, and change, of another length of a step
WAVE = 0.25  # of (pi dx / width)^2: a grid slows a standing wave by about a ninth of that, which no rounding is
STILL = 1e-3  # of the exact displacement: nothing has moved
HALF, SHOWN = 0.51, 1.5  # last digits: the most that rounding moves a number, and a motion that changes it
HELD = 0.2  # of the exact displacement: a layer of particles that a wall holds
SHIFTS = (-3, -2, -1, 1, 2, 3)  # steps
FACTOR, LEFT = 0.1, 0.12  # from 1, and of the balance, of a factor on force or stress that is told
LATE = 0.4  # steps: of a lag that is told
LOST = 0.03  # of dx^2 / dt, a viscosity that is told
DAMPED = 0.2  # of the momentum, over the run
NEARLY = 0.25  # from 1, of a term that is there or not; from a half, of half a step
TIE = 1.05  # factor within which two candidates leave the same of the balance
SINGLE = 0.01  # of the error of u: rounding of single precision that is told
ROUND = 1e-14  # of the body's width: an error that is none
MANY = 20  # numbers with more digits than a lattice has


def rms(values: Floats) -> float:
    """Root mean square."""
    return sqrt(float(np.mean(values**2)))


def single(e: Evidence) -> dict[str, float]:
    """Rounding of single precision over the error of u, where every number of x and v is one of it."""
    values = np.concatenate([e.given(key).ravel() for key in ("x", "v") if e.has(key)])
    with np.errstate(over="ignore"):  # beyond the range of single precision it is infinite, and not near
        near = values.astype(np.float32).astype(np.float64)
    if not np.isfinite(near).all() or np.any(np.abs(values - near) > 1e-9 * np.abs(values)):
        return {}
    if np.sum(np.abs(values - values.astype(np.float16).astype(np.float64)) > 0) < MANY:
        return {}
    x, error = e.given("x"), rms(e.u[1:] - e.u_exact[1:])
    part = float(np.finfo(np.float32).eps) * rms(x) / sqrt(12.0) / error if error else 1.0
    return {"single": part} if part > SINGLE else {}


def order(e: Evidence) -> dict[str, float]:
    """Particles that fit when they are matched otherwise: by the X that is written, or by where they are."""
    step, frame = next(iter(e.frames.items()))
    x, exact = frame.fields["x"], e.exact.x(e.X, step * e.dt)
    error, spacing = rms(x - exact), float(np.mean(e.V0)) ** (1 / e.d)
    if "X" in frame.fields:
        apart = np.abs(frame.fields["X"] - e.X).max(axis=1) > NEAR * spacing
        other = cKDTree(e.X).query(frame.fields["X"])[1]
        if apart.any() and rms(x - exact[other]) < BETTER * error:
            return {"id_and_X": float(apart.mean())}
    other = cKDTree(exact).query(x)[1]
    if len(np.unique(other)) == len(x) and rms(x - exact[other]) < CLEAR * error:
        return {"permuted": float((other != np.arange(len(x))).mean())}
    return {}


def still(e: Evidence) -> dict[str, float]:
    """Displacement from the start over the exact one, where nothing moves.

    Where no number changes, and the exact ones do not in as many digits either, nobody can tell: that is `unmoved`,
    the last digits over the exact displacement.
    """
    start = e.start
    moved, exact = e.given("x") - start, e.X + e.u_exact[1:] - start
    if not exact.any():
        return {}
    last, part = e.last_digits, rms(moved) / rms(exact)
    if part > STILL and np.any(np.abs(moved) > HALF * last):
        return {}
    if np.sum(np.abs(exact) > SHOWN * last) >= MANY:
        return {"still": part}
    return {"unmoved": rms(last) / rms(exact)}


def displacements(e: Evidence) -> dict[str, float]:
    """Positions that are displacements."""
    exact = e.u_exact[1:] + e.X
    return {"x_is_u": 1.0} if rms(e.given("x") + e.X - exact) < BETTER * rms(e.given("x") - exact) else {}


def other_times(e: Evidence) -> tuple[dict[str, float], float]:
    """Positions of another step, or of another length of a step, and the fraction of their error that it leaves."""

    def error(lag: float = 0.0, scale: float = 1.0) -> float:
        at = [e.exact.x(e.X, t * scale - lag * e.dt) for t in e.times[1:]]
        return rms(e.given("x") - np.stack(at))

    whole = error()
    if whole <= ROUND * np.ptp(e.X):
        return {}, 1.0
    slope = e.truth("v") * e.times[1:, None, None]
    scale = 1 + float(np.sum((e.u[1:] - e.u_exact[1:]) * slope) / np.sum(slope**2))
    best = min(SHIFTS, key=error)
    shifted, scaled = error(best) / whole, error(scale=scale) / whole
    grid = WAVE * (pi * e.case.record.dx / float(np.ptp(e.X[:, 0]))) ** 2
    if scaled < min(shifted, SCALED) and grid < abs(scale - 1) < ROUNDED:
        return {"time_scale": scale}, scaled
    return ({"shift": float(best)}, shifted) if shifted < BETTER else ({}, 1.0)


def walls(e: Evidence) -> dict[str, float]:
    """Displacement normal to a wall over the exact one, in the cells next to it, where the body moves further in."""
    layer, axis = next_to_walls(e)
    if not layer.any():
        return {}

    def moved(which: Bools) -> float:
        u, exact = (np.take_along_axis(field[1:], axis[None, :, None], axis=2)[:, which] for field in (e.u, e.u_exact))
        size = float(np.sum(exact**2))
        return float(np.sum(u * exact)) / size if size else 1.0

    part = moved(layer)
    return {"wall_in": part} if abs(part) < HELD and moved(~layer) > part + HELD else {}


def next_to_walls(e: Evidence) -> tuple[Bools, Indices]:
    """Whether a particle is in a cell next to a wall (P,), and the axis of the nearest wall's normal (P,)."""
    record = e.case.record
    depth = np.full((len(e.X), e.d), np.inf)
    for axis, sides in enumerate([SOLID_SIDES[: 2 * e.d][at : at + 2] for at in range(0, 2 * e.d, 2)]):
        for side, end in zip(sides, (record.lower[axis], record.upper[axis]), strict=True):
            if record.edges.get(side) in ("fixed", "roller"):
                depth[:, axis] = np.minimum(depth[:, axis], np.abs(e.X[:, axis] - end))
    return depth.min(axis=1) < record.dx, depth.argmin(axis=1)


def at_walls(e: Evidence) -> dict[str, float]:
    """Error of v in the interior over that everywhere, where it is at most half."""
    layer, _ = next_to_walls(e)
    if not e.has("v") or not layer.any() or layer.all():
        return {}
    gap = e.given("v") - e.truth("v", e.levels.v_lag)
    part = rms(gap[:, ~layer]) / rms(gap) if rms(gap) else 1.0
    return {"v_at_walls": part} if part < BETTER else {}


def forces(tried: dict[str, Tried], steps: int) -> tuple[dict[str, float], float]:
    """Cause that explains most of what is left of the momentum balance, if more than half, and what it leaves of it."""
    factors = {name: tried[name] for name in ("force_factor", "stress_factor")}
    factor = min(factors, key=lambda name: factors[name].left)
    of_F = tried.get("stress_of_F")
    if factors[factor].left < LEFT and abs(factors[factor].value) > FACTOR:
        explained = factor == "stress_factor" and of_F is not None and of_F.left < LEFT and abs(of_F.value - 1) < NEARLY
        return {"stress_of_F" if explained else factor: 1 + factors[factor].value}, factors[factor].left
    for name in ("force_swapped", "force_at_YX", "force_at_x"):
        if tried[name].left < BETTER and abs(tried[name].value - 1) < NEARLY:
            return {name: tried[name].value}, tried[name].left
    least = {"viscous": LOST, "force_lag": LATE, "stress_lag": LATE, "damped": DAMPED / steps}
    fits = {key: tried[key] for key in least if tried[key].left < BETTER and abs(tried[key].value) > least[key]}
    fits = {key: fit for key, fit in fits.items() if fit.value > 0 or key.endswith("_lag")}
    best = min((fit.left for fit in fits.values()), default=1.0)
    if factors[factor].left < best:  # a factor so near 1 that a coarse grid makes it explains more
        return {}, 1.0
    return next((({key: fit.value}, fit.left) for key, fit in fits.items() if fit.left <= TIE * best), ({}, 1.0))


def start(balance: Balance, tried: dict[str, Tried]) -> dict[str, float]:
    """Steps by which the velocity of the start is late, about a half, where nothing else explains the first motion."""
    by_force, by_speed = balance.start()
    others = (tried["force_factor"], tried["stress_factor"])
    if any(fit.left < BETTER and abs(fit.value) > FACTOR for fit in others) or by_speed.left < by_force.left + 0.2:
        return {}
    sure = by_force.left < BETTER and abs(abs(by_force.value) - 0.5) < NEARLY
    return {"start": by_force.value} if sure else {}
