"""Clamped square that is loaded slowly, in ten crossings of the fastest wave: all but static."""

import sympy as sp


def displacement(X, t, A=0.2, T=0.2):
    x, y = X
    bubble = x * (1 - x) * y * (1 - y)
    return A * (1 - sp.cos(2 * sp.pi * t / T)) / 2 * bubble * sp.Matrix([sp.cos(x), sp.cos(y)])


def domain():
    return {"lower": (0, 0), "upper": (1, 1), "duration": 0.1, "speed": 100, "order": 2}
