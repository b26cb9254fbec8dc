"""Rates and negative controls along prescribed motions: a quarter turn with and without strain, and simple shear."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.objectivity.axes import Block
from mpm_verify.cases.objectivity.exact import compressed, rotated
from mpm_verify.cases.objectivity.kinematic import follow, sheared, squeezed_then_turned, stretched_turn
from mpm_verify.mms.constitutive.simple_shear import SIMPLE_SHEAR
from mpm_verify.solver.material.hypoelastic import Hypoelastic
from mpm_verify.solver.plugins import RATES, available
from mpm_verify.solver.rate_material import objective
from mpm_verify.solver.state import Floats

STEPS = (25, 50, 100, 200, 400)
FIGURE2, ORDERS, SHEAR = "Figure 2, kinematic", "Orders in time", "Rates in simple shear"
CONTROLS = "Negative controls"
GAMMAS = (1.0, 4.0, 8.0)
CLOSED = "closed form"
PLANE = np.array([1.0, 1.0, 0.0, 2.0])  # the norm of the tensor in the plane


def figure2(block: Block, rate: str, steps: int = 200) -> dict[str, Floats]:
    """Stress over |sigma_v| along the motion of Figure 2: t in [0, 2], xx, yy, xy, own_xy in the turned frame."""
    M = block.E * (1 - block.nu) / ((1 + block.nu) * (1 - 2 * block.nu))
    material = replace(block.material, rate=rate)
    found = follow(material, squeezed_then_turned(block.sigma_v / M), 2 * steps)
    sigma, t = found.sigma / abs(block.sigma_v), 2 * found.t
    angle = np.pi / 2 * np.maximum(0.0, t - 1)
    own = (sigma[:, 1] - sigma[:, 0]) / 2 * np.sin(2 * angle) + sigma[:, 3] * np.cos(2 * angle)
    return {"t": t, "angle": angle, "xx": sigma[:, 0], "yy": sigma[:, 1], "xy": sigma[:, 3], "own_xy": own}


def exact_figure2(block: Block, t: Floats) -> dict[str, Floats]:
    """Closed form of the same: stress grows in proportion to gravity and is then turned with the block."""
    K0, angle = block.nu / (1 - block.nu), np.pi / 2 * np.maximum(0.0, t - 1)
    load = np.minimum(t, 1.0)
    xx, yy, xy = rotated(-K0 * load, -load, angle).T
    return {"t": t, "xx": xx, "yy": yy, "xy": xy}


def distance(block: Block, found: Mapping[str, Floats]) -> float:
    """Largest distance of the stress from the closed form along the motion of Figure 2."""
    exact = exact_figure2(block, found["t"])
    return max(float(np.abs(found[name] - exact[name]).max()) for name in ("xx", "yy", "xy"))


def order_errors(rate: str, counts: tuple[int, ...] = STEPS) -> Floats:
    """Relative error at the end of the stretched quarter turn for each number of steps."""
    material = Hypoelastic(E=1.0, rate=rate)
    xx, yy, _ = compressed(0.8, material.lam, material.mu, rate)
    ends = np.array([follow(material, stretched_turn, steps).sigma[-1] for steps in counts])
    away = ends - np.array([yy, xx, 0.0, 0.0])  # turned by 90 degrees
    errors: Floats = np.sqrt((away**2 @ PLANE) / (xx**2 + yy**2))
    return errors


def slope(errors: Floats) -> float:
    """Order in the step by least squares."""
    return float(-np.polyfit(np.log(STEPS), np.log(errors), 1)[0])


def simple_shear(rate: str, gamma: float, steps: int) -> Floats:
    """Stresses s11, s12 over G (2,) at the shear gamma."""
    material = Hypoelastic(E=2.6, nu=0.3, rate=rate)  # G = 1
    end: Floats = follow(material, sheared(gamma), steps).sigma[-1, [0, 3]]
    return end


def figure2_checks(block: Block) -> list[Check]:
    """Checks of Green-Naghdi along the motion of Figure 2, against (8.1): the turn is exact, compression of order 2."""
    found = figure2(block, "green_naghdi")
    away = distance(block, found)
    turn_only = found["t"] >= 1
    own = float(np.abs(found["own_xy"]).max())
    drift = float(np.ptp((found["xx"] + found["yy"])[turn_only]))
    peak = (1 - block.nu / (1 - block.nu)) / 2
    return [
        Check(FIGURE2, "largest distance from the closed form", away, 1e-6, "at_most", CLOSED),
        Check(FIGURE2, "shear stress at 45 degrees", float(found["xy"].max()), peak, "absolute", CLOSED, 1e-6),
        Check(FIGURE2, "co-rotated shear stress", own, 1e-12, "at_most", "zero in the frame of the block"),
        Check(FIGURE2, "change of the trace in the turn", drift, 1e-12, "at_most", "invariant of a rotation"),
    ]


def order_checks(errors: dict[str, Floats]) -> list[Check]:
    """Checks of the orders that plug-ins state, to a tenth; what has order 0 misses for good."""
    checks = []
    for name, found in errors.items():
        order = objective(name).order
        checks.append(Check(ORDERS, f"{name}: order", slope(found), order, "absolute", "leading error term", 0.1))
    return checks


def shear_checks() -> list[Check]:
    """Checks of each rate at three shears, by 100 steps per unit of shear, and of its order at the largest."""
    checks = []
    for rate in available(RATES):
        for gamma in GAMMAS:
            exact = SIMPLE_SHEAR[rate](np.array([gamma]))[0]
            found = simple_shear(rate, gamma, int(100 * gamma))
            for name, value, number in (("s11", float(found[0]), 0), ("s12", float(found[1]), 2)):
                what = f"{rate}: {name}/G at shear {gamma:g}"
                checks.append(Check(SHEAR, what, value, float(exact[number]), "absolute", CLOSED, 1e-3))
        if rate != "truesdell":  # exact in any number of steps
            checks.append(Check(SHEAR, f"{rate}: order at shear 8", shear_order(rate), 2.0, "absolute", CLOSED, 0.1))
    return checks


def shear_order(rate: str) -> float:
    """Order of the stress at shear 8, from 200 to 800 steps."""
    exact = SIMPLE_SHEAR[rate](np.array([8.0]))[0, [0, 2]]
    few, many = (float(np.linalg.norm(simple_shear(rate, 8.0, steps) - exact)) for steps in (200, 800))
    return float(np.log(few / many) / np.log(4))
