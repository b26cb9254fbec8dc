"""Rules of the claims on the paper's Figure 2: objective update, rotated block, negative controls."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from mpm_verify.cases.objectivity.axes import BLOCK, KINEMATIC
from mpm_verify.reports.paper.evidence import Evidence
from mpm_verify.reports.paper.records import Answer, NotFinishedError
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, USUAL_RATE, available

At = Mapping[str, Any]
NEAR = 0.01  # of the mean vertical stress: what can be seen on the figure
SEEN = 0.02  # of it: a wrong update that is nearer than that passes the figure
SIDES = {"1 cm": 0.01, "1 m": 1.0}
SECOND, CONVERGES = 1.9, 0.9  # orders


def turning(seen: Evidence, side: str) -> Any:
    """Result of the turning block of a side, finished. Raises NotFinishedError."""
    found = [one for one in seen.results("figure2", part=BLOCK, rate=USUAL_RATE, frame=False)
             if abs(one.run.L - SIDES[side]) < 1e-9 and one.status == "finished"]  # fmt: skip
    if not found:
        raise NotFinishedError("figure2")
    return found[0]


def block(seen: Evidence, side: str) -> dict[str, float]:
    """Numbers of the turning block of a side."""
    return dict(turning(seen, side).values)


def bend(seen: Evidence, side: str) -> float:
    """Distance of the mean vertical stress from a line in the ramp, rms, over its end."""
    arrays = seen.record("figure2").arrays(turning(seen, side).run)
    t, yy = (np.asarray(arrays[f"mean/{name}"], float) for name in ("t", "yy"))
    ramp = t <= 1.0
    return float(np.sqrt(((yy + t)[ramp] ** 2).mean()))


def kinematic(seen: Evidence) -> dict[str, float]:
    """Numbers of rates along prescribed motions."""
    return seen.one("figure2", part=KINEMATIC).values


def f15(seen: Evidence, at: At) -> Answer:
    """Update by the polar decomposition is of second order in a turn with strain."""
    known = kinematic(seen)
    order = known[f"order {USUAL_RATE}"]
    return Answer({"second order": order > SECOND}, {"order in the step": order})


def f16(seen: Evidence, at: At) -> Answer:
    """Formulas as printed converge; the update that the paper warns of does not."""
    known = kinematic(seen)
    printed, same = known["order printed"], known["order same_rotation"]
    return Answer(
        {"as printed": printed > CONVERGES, "the warning": same < CONVERGES},
        {"order as printed": printed, "distance as printed": known["figure2 printed"],
         "distance with one rotation": known["figure2 same_rotation"]},
    )  # fmt: skip


def f18(seen: Evidence, at: At) -> Answer:
    """Stresses at the end of the ramp are those of rest, and were on a line until then."""
    own, away = block(seen, at["block"]), bend(seen, at["block"])
    K0 = seen.results("figure2", part=KINEMATIC)[0].run.nu
    K0 = K0 / (1 - K0)
    near = abs(own["yy_ramp"] + 1) < NEAR and abs(own["xx_ramp"] + K0) < NEAR
    numbers = {"vertical": own["yy_ramp"], "horizontal": own["xx_ramp"], "distance from a line": away}
    return Answer({"ends": near, "grow linearly": away < NEAR}, numbers)


def f19(seen: Evidence, at: At) -> Answer:
    """Stresses swap in the turn, near to the closed form."""
    own = block(seen, at["block"])
    swapped = own["xx_end"] < own["yy_end"] and own["xx_ramp"] > own["yy_ramp"]
    numbers = {"horizontal": own["xx_end"], "vertical": own["yy_end"], "largest distance": own["miss"]}
    return Answer({"direction": swapped, "nearness": own["miss"] < NEAR}, numbers)


def f20(seen: Evidence, at: At) -> Answer:
    """Shear stress arises, is small, and vanishes: in the axes of the laboratory, and in those of the block."""
    own = block(seen, "1 m")
    parts = {"laboratory": own["peak"] < 0.05, "block": own["early"] < 0.05 and own["late"] < 0.5 * own["early"]}
    axes = at["axes"]
    kept = parts if axes == "both" else {axes: parts[axes]}
    return Answer(dict(kept), {"laboratory, largest": own["peak"], "block, early": own["early"],
                               "block, late": own["late"]})  # fmt: skip


def f21(seen: Evidence, at: At) -> Answer:
    """The figure tells wrong updates from right ones: each of the negative controls is seen."""
    known, names = kinematic(seen), available(NEGATIVE_CONTROLS)
    passed = [name for name in names if known[f"figure2 {name}"] < SEEN]
    return Answer({"each is seen": not passed}, {"negative controls": len(names), "that pass": len(passed)})


RULES = {"F15": f15, "F16": f16, "F18": f18, "F19": f19, "F20": f20, "F21": f21}
