"""Strains out of the plane: the kernels of soils see plane strain, and these hand them what a strain of zz does.

Two ways are exact, and a material says which is its own (`out_of_plane`):
    trial  the stress after a step is a function of the elastic trial stress alone, all three principal stresses of it:
           what linear elasticity makes of the strain of zz is added to the stress before the kernel sees it
    plane  the model yields by the stress in the plane alone, with moduli of the mean stress s in the plane: there a
           strain of zz acts as one of lam / (K + G/3) of it that is the same in all directions of the plane; zz itself
           gets the rest, with the moduli of the middle of the step as everything else
"""

from typing import Any

import numpy as np

from mpm_verify.solver.state import Floats

PASSES = 3  # for the ratio of moduli in the middle of the step, which is a constant where both have one exponent


def respond(material: Any, constants: Floats, sigma: Floats, de: Floats, history: Floats) -> None:
    """Write stress (n,4) and history (n,H) after strain increments de (n,4): xx, yy, xy, zz."""
    if material.out_of_plane == "trial":
        sigma[:, :3] += material.lam * de[:, 3:]
        sigma[:, 2] += 2 * material.mu * de[:, 3]
        plane(material, constants, sigma, de, history)
        return
    start, memory, middle, ratio = sigma.copy(), history.copy(), mean(sigma), np.full(len(sigma), np.nan)
    for _ in range(PASSES):
        G, K = np.array([material.moduli(float(s)) for s in middle]).T
        before, ratio = ratio, (K - 2 / 3 * G) / (K + G / 3)
        if np.abs(before - ratio).max() <= 1e-15:
            break
        sigma[:], history[:] = start, memory
        even = ratio * de[:, 3]
        plane(material, constants, sigma, de[:, :3] + 0.5 * even[:, None] * [1, 1, 0], history)
        middle = (mean(start) + mean(sigma)) / 2
    G, K = np.array([material.moduli(float(s)) for s in middle]).T
    parted = ~sigma.any(axis=1)  # what has come apart has no stress
    sigma[:, 2] += np.where(parted, 0.0, (K - 2 / 3 * G) * (de[:, 3] - even) + 2 * G * de[:, 3])


def plane(material: Any, constants: Floats, sigma: Floats, de: Floats, history: Floats) -> None:
    """Write stress (n,4) and history (n,H) after the increments xx, yy, xy of de (n,3 or more), by the kernel."""
    flat, memory = sigma.ravel().copy(), history.ravel().copy()
    material.respond(constants, flat, np.ascontiguousarray(de[:, :3]).ravel(), memory)
    sigma[:], history[:] = flat.reshape(sigma.shape), memory.reshape(history.shape)


def mean(sigma: Floats) -> Floats:
    """Mean stress s (n,) in the plane, compression positive."""
    s: Floats = -(sigma[:, 0] + sigma[:, 1]) / 2
    return s


def takes(material: Any) -> bool:
    """Whether the material can be strained out of the plane: it says how, and keeps no void strain."""
    return bool(material.respond is not None and material.out_of_plane and not getattr(material, "void", 0))
