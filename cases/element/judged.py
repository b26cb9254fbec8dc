"""Checks of one element test: that it ends, how close it comes to the exact curve, its known ends, and its order."""

from functools import partial
from typing import Any

import numpy as np

from mpm_verify.cases.element.axes import CONFINED
from mpm_verify.cases.element.known_ends import ends
from mpm_verify.cases.element.motion import matrices
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.cases.element.resolved import ORDERLY, WHOLE, at_start, made
from mpm_verify.cases.element.study import ROUND_OFF, ElementStudy
from mpm_verify.cases.harness.checks import Check

RESOLVED = 64  # parts of a leg in the length of a motion
SETTLED = 50  # steps of the coarsest run from which on sound models have their order: 1.89 with 40, 1.91 with 50


def checks(material: Any, studied: ElementStudy) -> list[Check]:
    """Checks of a test: it ends, is as close to the exact curve as its order says, and has the material's order.

    A run of fewer than SETTLED steps may end early, as no strain of such a size leads to what is asked, and orders have
    not settled there: neither is judged. Nor is either where one step makes more than the stress at the start.
    """
    group, found, settled = studied.test.title, [], studied.test.steps(SETTLED)
    part = partial(made, material, studied.test, at_start(studied))
    if studied.failed and (studied.failed.steps < settled or part(studied.failed.steps) > WHOLE):
        return []
    if studied.failed:
        at = f"step {studied.failed.step} of {studied.failed.steps}"
        return [Check(group, f"early end, at {at}", float("nan"), 0.0, "absolute", "all steps solved")]
    finest = studied.errors[-1]
    if studied.source:
        usual = made(material, studied.test, CONFINED * studied.test.loose, studied.steps[-1])
        fewer = max(1.0, part(studied.steps[-1]) / usual) if usual else 1.0  # steps to the strength, as at CONFINED
        second = 1e-6 * (1600 / studied.steps[-1] * fewer) ** 2  # what order 2 makes of 1e-6 in 1600 steps
        allowed = max(second, ROUND_OFF) if material.order == 2 else ROUND_OFF
        if studied.test.motion and rated(material):
            allowed = max(ROUND_OFF, (turned(studied.test) / studied.steps[-1]) ** 2)
        found.append(Check(group, "error at the end, finest", finest, allowed, "at_most", studied.source))
    found += ends(material, studied)
    smooth = (
        studied.test.motion and material.name == "hypoelastic" and studied.source and max(studied.errors) > ROUND_OFF
    )
    if smooth and studied.steps[0] >= settled:
        found.append(Check(group, "order in the step", studied.order, 1.9, "at_least", "midpoint rule of the rate"))
    straight = not (studied.test.cyclic or len(studied.test.points) or fails_on_the_way(material, studied))
    if material.order == 2 and studied.steps[0] >= settled and straight and part(studied.steps[0]) <= ORDERLY:
        found.append(Check(group, "order in the strain step", studied.order, 1.9, "at_least", "midpoint scheme"))
    return found


def fails_on_the_way(material: Any, studied: ElementStudy) -> bool:
    """Whether drained compression or extension goes beyond the end of hardening: a step around that has no order."""
    eta_f = getattr(material, "eta_f", None)
    if not (studied.test.axial or studied.test.name == "biaxial") or eta_f is None or not studied.curve:
        return False
    s, t = (float(studied.curve[name][-1]) for name in ("s", "t"))
    return bool(t >= eta_f * (s + material.shift) * (1 - 1e-9))


def rated(material: Any) -> bool:
    """Whether an objective rate integrates the material, which makes motions of order 2."""
    return material.respond is not None


def turned(test: ElementTest) -> float:
    """Length of a motion, the integral of the norm of its velocity gradient: what it turns and stretches in sum."""
    line = np.linspace(0, test.legs, RESOLVED * test.legs + 1)
    corners = np.arange(test.legs + 1)
    F = matrices(np.column_stack([np.interp(line, corners, column) for column in test.points.T]))
    steps = np.diff(F, axis=0) @ np.linalg.inv((F[1:] + F[:-1]) / 2)
    return float(np.linalg.norm(steps, axis=(1, 2)).sum())
