"""Residual of the momentum balance, computed from a displacement alone: without the derivation of this package."""

from collections.abc import Callable
from typing import Any

import numpy as np
import sympy as sp

from mpm_verify.mms.discretisation import axisymmetric, dimension
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.plugins import MATERIALS, create
from mpm_verify.solver.state import Floats

LAW = create(MATERIALS, "neo_hookean")
COMPLEX_STEP = 1e-30
STENCIL = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))  # sixth order


def residual(solution: Any, exact: Manufactured, P_of: Callable[[Floats], Floats]) -> float:
    """Largest remainder of rho0 (u'' - b) = Div P over the size of its terms: complex steps, differences, R P."""
    d, around, width = dimension(solution), axisymmetric(solution), solution.upper - solution.lower
    L = float(width[0])
    symbols, time = sp.symbols("X Y Z")[:d], sp.Symbol("t")
    u: Any = sp.lambdify((*symbols, time), list(solution.displacement(symbols, time)), "numpy")

    def step(X: Floats, t: float, direction: int) -> Floats:
        at = [*X.T.astype(complex), np.full(len(X), t, complex)]
        at[direction] = at[direction] + 1j * COMPLEX_STEP
        return np.stack([np.broadcast_to(c, len(X)) for c in u(*at)], axis=-1).imag / COMPLEX_STEP

    def stress(X: Floats, t: float) -> Floats:
        F = np.tile(np.eye(3), (len(X), 1, 1))
        F[:, :d, :d] += np.stack([step(X, t, k) for k in range(d)], axis=-1)
        if around:
            F[:, 2, 2] += np.stack([np.broadcast_to(c, len(X)) for c in u(*X.T, t)], axis=-1)[:, 0] / X[:, 0]
        return P_of(F)

    X = solution.lower + np.random.default_rng(5).uniform(0.05, 0.95, (30, d)) * width
    h, tau, worst = 1e-3 * L, 2e-3 * L / solution.C, 0.0
    weight = (lambda X: X[:, :1, None]) if around else (lambda X: 1.0)
    for t in solution.duration * np.array([0.13, 0.4, 0.77]):
        acceleration = sum(c * (step(X, t + k * tau, d) - step(X, t - k * tau, d)) for k, c in STENCIL) / tau
        divergence = np.zeros_like(X)
        for axis in range(d):
            e = h * np.eye(d)[axis]
            parts = [c * (weight(X + k * e) * stress(X + k * e, t) - weight(X - k * e) * stress(X - k * e, t))
                     for k, c in STENCIL]  # fmt: skip
            divergence += sum(parts)[:, :d, axis] / h
        if around:
            divergence[:, 0] -= stress(X, t)[:, 2, 2]
            divergence /= X[:, :1]
        rest = np.abs(acceleration - divergence / LAW.rho0 - exact.b(X, t)).max()
        worst = max(worst, float(rest / (np.abs(acceleration).max() + np.abs(divergence).max() / LAW.rho0)))
    return worst


def piola(F: Floats) -> Floats:
    """First Piola stress (P,3,3) of the neo-Hookean solid, from the textbook."""
    inverse = np.linalg.inv(F).transpose(0, 2, 1)
    return LAW.mu * (F - inverse) + LAW.lam * np.log(np.linalg.det(F))[:, None, None] * inverse


def without_hoop(F: Floats) -> Floats:
    """Such a stress without the one around the axis."""
    P = piola(F)
    P[:, 2, 2] = 0
    return P
