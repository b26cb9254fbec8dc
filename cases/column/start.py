"""Stress of the column before its gate opens: none, at rest by Jaky's K0, or by oedometric loading."""

from math import radians, sin
from typing import Any

import numpy as np

from mpm_verify.solver.material_model import Material
from mpm_verify.solver.state import Floats, Particles

LOOSE = 50.0  # Pa, isotropic: where the oedometric path starts. At next to none any strain mobilises all friction.
STEP = 1e-6  # of strain


def stress(particles: Particles, material: Material, start: str, surface: float, g: float) -> None:
    """Write particles.sigma, and the history that an oedometric path leaves, by the depth below `surface`.

    Raises ValueError for a material without an angle of friction, where there must be one.
    """
    if start == "none":
        return
    load = material.rho0 * g * (surface - particles.x[:, 1])
    if start == "k0":
        if material.friction_angle is None:
            raise ValueError("start = k0 must have a material with an angle of friction")
        K0 = 1 - sin(radians(material.friction_angle))
        particles.sigma[:, :3] = -load[:, None] * [K0, 1.0, K0]
        return
    sigma, history = oedometric(material, float(load.max()))
    down = -sigma[:, 1]
    particles.sigma[:] = np.stack([np.interp(load, down, column) for column in sigma.T], axis=1)
    particles.F_old = particles.F.reshape(-1, 4).copy()
    kept = [np.interp(load, down, column) for column in history.T]
    particles.history = np.stack(kept, axis=1) if kept else np.zeros((len(load), 0))
    particles.work = np.zeros((len(particles), 2))


def oedometric(material: Any, load: float) -> tuple[Floats, Floats]:
    """Stresses (n,4) and histories (n,H) on the way from next to no stress to the vertical stress `load`."""
    sigma = np.array([-LOOSE, -LOOSE, -LOOSE, 0.0])
    history, constants = material.initial(sigma[None])[0], material.constants()
    path = [(0 * sigma, history.copy()), (sigma.copy(), history.copy())]
    while -sigma[1] < load:
        de = np.array([0.0, -max(STEP, 0.01 * path_strain(material, -sigma[1])), 0.0])
        material.respond(constants, sigma, de, history)
        path.append((sigma.copy(), history.copy()))
    return np.array([s for s, _ in path]), np.array([h for _, h in path])


def path_strain(material: Material, stress: float) -> float:
    """Strain that doubles the stress, roughly: the scale of steps."""
    return stress / (material.rho0 * material.wave_speed() ** 2)
