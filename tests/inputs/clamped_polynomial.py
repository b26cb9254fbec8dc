"""Clamped square that moves along y as a polynomial of the fourth degree."""

import sympy as sp


def displacement(X, t, A=0.2):
    x, y = X
    return sp.Matrix([0, -A * (1 - sp.cos(100 * sp.pi * t)) * x * (1 - x) * y * (1 - y)])


def domain():
    return {"lower": (0, 0), "upper": (1, 1), "duration": 0.02, "speed": 100, "order": 2}
