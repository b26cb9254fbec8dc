"""A solution of one's own around an axis: a cylinder of radius 1 and height 2 that slides along the walls of a can."""

import sympy as sp


def displacement(X, t, A=1e-6):
    """u in r and z of the radius and the height X, and the time t."""
    r, z = X
    angle = 100 * sp.pi * t
    radial = sp.sin(sp.pi * r) * sp.cos(sp.pi * z) * (1 - sp.cos(angle))
    return A * sp.Matrix([radial, sp.cos(sp.pi * r) * sp.sin(sp.pi * z) * sp.sin(angle)])


def domain():
    """Corners of the section, from the axis outwards."""
    return {"lower": (0, 0), "upper": (1, 2), "duration": 0.02, "speed": 100, "axisymmetric": True}
