"""What the tests of rates share: every law in rate form, a confined stress, paths, and points along them."""

from typing import Any

import numpy as np

from mpm_verify.cases.objectivity.exact import turn
from mpm_verify.cases.objectivity.kinematic import Path
from mpm_verify.solver.plugins import MATERIALS, NEGATIVE_CONTROLS, RATES, available, create, load
from mpm_verify.solver.rate_material import RateMaterial
from mpm_verify.solver.state import Floats, Particles

RIGHT, WRONG = available(RATES), available(NEGATIVE_CONTROLS)
LAWS = [name for name in available(MATERIALS) if issubclass(load(MATERIALS, name), RateMaterial)]
CONFINED = np.array([-100.0, -120.0, -110.0, 10.0])  # xx, yy, zz, xy
PLANE = np.array([1.0, 1.0, 0.0, 2.0])  # the norm of the tensor in the plane


def law_of(name: str, rate: str = "green_naghdi") -> Any:
    return create(MATERIALS, f"{name}:rate={rate}")


def prestress(law: Any) -> Floats:
    """A confined stress of a thousandth of the law's stiffness, so that some per cent of strain make a soil yield."""
    return CONFINED * 1e-5 * law.rho0 * law.wave_speed() ** 2


def strained(t: float) -> Floats:
    """Compression, extension and shear, 10, 6 and 20 % at t = 1; both stretch and rotation change all the time."""
    return np.array([[1 - 0.10 * t, 0.15 * t], [0.05 * t, 1 + 0.06 * t]])


def turned(sigma: Floats, angle: float) -> Floats:
    """R sigma R^T of (..., 4)."""
    c, s = np.cos(angle), np.sin(angle)
    xx, yy, zz, xy = np.moveaxis(np.asarray(sigma), -1, 0)
    return np.stack(
        [c * c * xx + s * s * yy - 2 * c * s * xy, s * s * xx + c * c * yy + 2 * c * s * xy, zz,
         c * s * (xx - yy) + (c * c - s * s) * xy], axis=-1,
    )  # fmt: skip


def size(sigma: Floats) -> float:
    """Norm of the tensor in the plane."""
    return float(np.sqrt((np.asarray(sigma) ** 2 * PLANE).sum(axis=-1).max()))


def started(law: Any, F: Floats, sigma: Floats) -> Particles:
    """Particles of F (P,2,2) and sigma (P,4) that the law has started."""
    count = len(F)
    p = Particles(np.zeros((count, 2)), np.ones(count), np.ones(count), np.zeros((count, 0)))
    p.F, p.sigma = F.copy(), np.tile(sigma, (count, 1)) if sigma.ndim == 1 else sigma.copy()
    law.start(p)
    return p


def step_to(law: Any, p: Particles, F: Floats) -> Particles:
    """One step, to F (P,2,2)."""
    p.F = np.ascontiguousarray(F)
    law.update(p, 1.0)
    return p


def walk(law: Any, path: Path, steps: int, sigma: Floats) -> Particles:
    """One point along F(t), t from 0 to 1 in equal steps."""
    p = started(law, path(0.0)[None], sigma)
    for t in np.linspace(0.0, 1.0, steps + 1)[1:]:
        step_to(law, p, path(float(t))[None])
    return p


def in_frame(angle: float, speed: float = 0.0) -> Path:
    """The path `strained`, seen by somebody turned by an angle, and turning on by `speed`."""
    return lambda t: turn(angle + speed * t) @ strained(t)
