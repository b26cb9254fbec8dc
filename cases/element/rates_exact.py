"""Exact stress of a hypoelastic solid along a motion: the closed form of its rate, or its differential equation.

Simple shear from an isotropic stress, F = [[1, gamma], [0, 1]], has a closed form for each rate. Any other motion has
    d sigma/dt = W sigma - sigma W + C : D,   W the spin of the rate,
by a Runge-Kutta method of order 8 with tolerances of 1e-12, leg by leg; of Truesdell's rate L sigma + sigma L^T - tr(L)
sigma is in place of the spin. Spins: skew L (Jaumann), R' R^T (Green-Naghdi), and that of the logarithmic rate by the
axes of B = F F^T (Xiao, Bruhns & Meyers 1997, doi:10.1007/BF01213020), another way than that of solver/rates.
"""

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from mpm_verify.cases.element.curves import columns
from mpm_verify.cases.element.element import State
from mpm_verify.cases.element.following import Followed
from mpm_verify.cases.element.motion import matrices
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.mms.constitutive.simple_shear import SIMPLE_SHEAR
from mpm_verify.solver.state import Floats

Columns = dict[str, Floats]
POINTS, TOLERANCE = 60, 1e-12
SMALL = 1e-2  # of a logarithm, below which a series takes over: what it leaves out is below 1e-14


def along(material: Any, test: ElementTest, begin: State) -> tuple[Columns, str] | None:
    """Exact columns of a motion, and what they are; None for a rate that has no known spin."""
    if test.mixed or material.rate not in SIMPLE_SHEAR:
        return None
    if simple(test) and np.ptp(begin.sigma[:3]) == begin.sigma[3] == 0.0:
        return sheared(material, test, begin), "closed form"
    strain, sigma = [test.points[0]], [begin.sigma]
    for first, last in zip(test.points, test.points[1:], strict=False):
        times = np.linspace(0, 1, POINTS)
        found = integrated(material, first, last, sigma[-1], times)
        strain += list(first + np.outer(times[1:], last - first))
        sigma += list(found[1:])
    followed = Followed(np.array(strain), np.array(sigma), np.zeros((len(sigma), 0)))
    return columns(test, followed), "differential equation to 1e-12"


def simple(test: ElementTest) -> bool:
    """Whether the motion is simple shear from the undeformed state, there and back as may be."""
    return bool((test.points[:, [0, 1, 3, 4]] == [1, 1, 1, 0]).all() and test.points[0, 2] == 0)


def sheared(material: Any, test: ElementTest, begin: State) -> Columns:
    """Columns of simple shear: closed forms times G, and what is made of an isotropic stress before."""
    line = np.linspace(0, test.legs, test.steps(POINTS) + 1)
    gamma = np.interp(line, np.arange(test.legs + 1), test.points[:, 2])
    xx, yy, xy = material.mu * SIMPLE_SHEAR[material.rate](gamma).T
    mean = begin.sigma[0]
    if material.rate == "truesdell":  # F sigma F^T / J of what was there
        xx, xy = xx + mean * gamma**2, xy + mean * gamma
    sigma = np.column_stack([xx + mean, yy + mean, np.full(len(gamma), mean), xy])
    one = np.ones(len(gamma))
    F = np.column_stack([one, one, gamma, one, 0 * one])
    return columns(test, Followed(F, sigma, np.zeros((len(gamma), 0))))


def integrated(material: Any, first: Floats, last: Floats, sigma: Floats, times: Floats) -> Floats:
    """Stress (n,4) at times from 0 to 1 of a leg from F (5,) to another, in a straight line."""
    slope = matrices((last - first)[None])[0]
    size = max(float(np.abs(sigma).max()), material.mu * float(np.abs(last - first).max()))

    def change(t: float, s: Floats) -> Floats:
        F = matrices((first + t * (last - first))[None])[0]
        L, stress = slope @ np.linalg.inv(F), np.array([[s[0], s[3], 0], [s[3], s[1], 0], [0, 0, s[2]]])
        D = (L + L.T) / 2
        elastic = material.lam * np.trace(D) * np.eye(3) + 2 * material.mu * D
        if material.rate == "truesdell":
            rate = L @ stress + stress @ L.T - np.trace(L) * stress + elastic
        else:
            W = spin(material.rate, F, slope, L)
            rate = W @ stress - stress @ W + elastic
        components: Floats = rate[[0, 1, 2, 0], [0, 1, 2, 1]]
        return components

    found = solve_ivp(change, (0, 1), sigma, "DOP853", times, rtol=TOLERANCE, atol=TOLERANCE * size)
    stresses: Floats = found.y.T
    return stresses


def spin(rate: str, F: Floats, slope: Floats, L: Floats) -> Floats:
    """Spin (3,3) of a rate at F, which changes by `slope`."""
    W: Floats = (L - L.T) / 2
    if rate == "jaumann":
        return W
    if rate == "green_naghdi":
        even, odd = F[0, 0] + F[1, 1], F[1, 0] - F[0, 1]
        turning = (even * (slope[1, 0] - slope[0, 1]) - odd * (slope[0, 0] + slope[1, 1])) / (even**2 + odd**2)
        W[:] = turning * np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 0]])
        return W
    D, (values, axes) = (L + L.T) / 2, np.linalg.eigh((F @ F.T)[:2, :2])
    factor = bend(float(np.log(values[1] / values[0])))
    large, small = np.outer(axes[:, 1], axes[:, 1]), np.outer(axes[:, 0], axes[:, 0])
    more = factor * (large @ D[:2, :2] @ small - small @ D[:2, :2] @ large)
    W[:2, :2] += more
    return W


def bend(x: float) -> float:
    """Factor (1 + e^x)/(1 - e^x) + 2/x of the logarithm x of a ratio of squared stretches."""
    return -x / 6 + x**3 / 360 - x**5 / 15120 if abs(x) < SMALL else float(2 / x - 1 / np.tanh(x / 2))
