"""Square on rollers all round, whose small motion keeps its volume and has no shear along the walls."""

import sympy as sp


def displacement(X, t, A=0.02):
    x, y = (2 * sp.pi * one for one in X)
    return A * (1 - sp.cos(100 * sp.pi * t)) / 2 * sp.Matrix([sp.sin(x) * sp.cos(y), -sp.cos(x) * sp.sin(y)])


def domain():
    return {"lower": (0, 0), "upper": (1, 1), "duration": 0.02, "speed": 100, "order": 2}
