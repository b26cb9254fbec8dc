"""Bar that starts at full stretch (Steffen, Kirby & Berzins 2008, doi:10.1002/nme.2360), without Poisson's effect."""

import sympy as sp


def displacement(X, t, A=0.05):
    x, _ = X
    return sp.Matrix([A * sp.sin(2 * sp.pi * x) * sp.cos(100 * sp.pi * t), 0])


def domain():
    return {
        "lower": (0, 0),
        "upper": (1, 1),
        "duration": 0.02,
        "speed": 100,
        "material": "neo_hookean:nu=0,E=1e4,rho0=1",
    }
