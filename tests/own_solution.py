"""A solution of one's own: a block held below and above, that slides along walls to its left and right."""

import sympy as sp


def displacement(X, t, A=0.05):
    """u of the reference position X and the time t, two expressions."""
    x, y = X
    wave = sp.sin(sp.pi * y) * (1 - sp.cos(100 * sp.pi * t))
    return sp.Matrix([A * sp.sin(sp.pi * x) ** 2 * wave, A * wave])


def domain():
    """Corners of a rectangle, the time that a study covers, and the speed C in dt = courant dx / C."""
    return {"lower": (0, 0), "upper": (1, 1), "duration": 0.02, "speed": 100}
