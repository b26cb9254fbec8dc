"""One material point along a prescribed F(t), without a grid: what a rate makes of rotation and stretch."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mpm_verify.cases.objectivity.exact import turn
from mpm_verify.solver.material_model import Material
from mpm_verify.solver.state import Floats, Particles

Path = Callable[[float], Floats]


@dataclass(frozen=True)
class Followed:
    """Path of a material point: times (N+1,), F (N+1,2,2) and Cauchy stress (N+1,4) along a path."""

    t: Floats
    F: Floats
    sigma: Floats


def follow(material: Material, path: Path, steps: int, sigma0: Floats | None = None) -> Followed:
    """Follow a material along F(t), t from 0 to 1 in equal steps, from the stress sigma0 (4,), or zero."""
    t = np.linspace(0.0, 1.0, steps + 1)
    F = np.array([path(float(time)) for time in t])
    p = Particles(np.zeros((1, 2)), np.ones(1), np.ones(1), np.zeros((1, 0)))
    p.F[0], p.sigma[0] = F[0], np.zeros(4) if sigma0 is None else sigma0
    material.start(p)
    sigma = [p.sigma[0].copy()]
    for deformed in F[1:]:
        p.F[0] = deformed
        material.update(p, 1.0 / steps)
        sigma.append(p.sigma[0].copy())
    return Followed(t, F, np.array(sigma))


def stretched_turn(t: float) -> Floats:
    """A quarter turn while the body is compressed along its own first axis: R(pi t / 2) diag(1 - t/5, 1)."""
    return turn(np.pi * t / 2) @ np.diag([1 - 0.2 * t, 1.0])


def squeezed_then_turned(strain: float) -> Path:
    """Motion of the paper's Figure 2: F_yy = exp(strain t) in the first half of the time, then a quarter turn."""

    def path(t: float) -> Floats:
        return turn(np.pi / 2 * max(0.0, 2 * t - 1)) @ np.diag([1.0, np.exp(strain * min(1.0, 2 * t))])

    return path


def sheared(gamma: float) -> Path:
    """Simple shear to gamma."""

    def path(t: float) -> Floats:
        return np.array([[1.0, gamma * t], [0.0, 1.0]])

    return path
