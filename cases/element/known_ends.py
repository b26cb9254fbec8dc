"""Known ends of triaxial and oedometric tests: strength, dilation at failure, and K0, told as numbers of their own."""

from typing import Any

import numpy as np

from mpm_verify.cases.element.exact import ELASTIC
from mpm_verify.cases.element.study import ElementStudy
from mpm_verify.cases.element.triaxial_exact import MERIDIANS
from mpm_verify.cases.harness.checks import Check
from mpm_verify.solver.state import Floats

FAILED = 0.8  # of the path, where a test is at failure if it ever is
FORM = "closed form"
DRAINED = {"triaxial_compression": 1, "triaxial_extension": -1}


def ends(material: Any, studied: ElementStudy) -> list[Check]:
    """Checks of the end of a test; none where it has no known one, or ends before it."""
    if studied.failed or not studied.curve:
        return []
    if studied.test.name == "oedometric":
        return at_rest(material, studied)
    side = DRAINED.get(studied.test.name)
    if side is None or not steady(studied.curve["q"]):
        return []
    found = at_failure(material, studied, side)
    return found if studied.source else found[: side > 0]  # where a cut-off is met, its flow is another


def steady(q: Floats) -> bool:
    """Whether the deviator stress stays over the last part of the path."""
    last = q[int(FAILED * len(q)) :]
    return bool(np.ptp(last) <= 1e-9 * np.abs(last).max())


def at_failure(material: Any, studied: ElementStudy, side: int) -> list[Check]:
    """Checks of the deviator stress and of the volume per axial strain at failure, compression positive."""
    curve, group = studied.curve, studied.test.title
    cell, q = float(curve["sx"][0]), float(curve["q"][-1])
    first = int(FAILED * len(curve["q"]))
    flow = float((curve["ev"][-1] - curve["ev"][first]) / (curve["ey"][-1] - curve["ey"][first]))
    if material.name in MERIDIANS:
        line = MERIDIANS[material.name](material, side)
        strength = side * (line.M * cell + line.Q) / (1 - side * line.M / 3)
        ratio = line.volume / line.axial
    elif hasattr(material, "eta_f"):
        strength = side * 2 * cell * material.eta_f / (1 - side * material.eta_f)
        D = material.eta_cv - material.eta_f
        ratio = 2 * D / (D + side)
    else:
        return []
    return [
        Check(group, "axial less lateral stress at failure", q, strength, "relative", FORM, 1e-9),
        Check(group, "volume over axial strain at failure", flow, ratio, "absolute", FORM, 1e-8),
    ]


def at_rest(material: Any, studied: ElementStudy) -> list[Check]:
    """Check of lateral over vertical stress, K0 = nu/(1 - nu), where the soil stays elastic."""
    if studied.source != ELASTIC:
        return []
    sx, sy = studied.curve["sx"], studied.curve["sy"]
    found = float((sx[-1] - sx[0]) / (sy[-1] - sy[0]))
    return [Check(studied.test.title, "K0, of what is added", found, material.nu / (1 - material.nu), "absolute",
                  "nu/(1 - nu)", 1e-12)]  # fmt: skip
