"""Case of a test: the exported motion, and states on its particles that no displacement has.

`graded_x`: V = V0 det F is the same everywhere, and sigma_xx and sigma_xy are affine in x, and do not depend on y. Any
shape functions that are those of the next node, shifted, and that reproduce what is linear, give

    f_i = -sum V sigma dN_i = V_cell (sigma_xx', sigma_xy')

at each node inside, whatever sigma_yy is: for points that are a cell apart, sum dN = 0 and sum x dN = -1 hold apart
from those between them. All move with the same acceleration (sigma_xx', sigma_xy') / rho. F stretches so far
that half sides at reference are below a quarter of a cell, and domains that keep them have the weights of points: with
domains of GIMP that differ from particle to particle the sums would not be these. With those of cpGIMP they are not.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mpm_verify.cases.exact.others.motion import COURANT
from mpm_verify.cases.exact.others.tests import CASES
from mpm_verify.mms.constitutive.driver import columns as listed
from mpm_verify.mms.constitutive.driver import random, turn
from mpm_verify.mms.constitutive.stress import cauchy
from mpm_verify.mms.constitutive.tested import bound
from mpm_verify.mms.export.case import Exported, Names, export, named
from mpm_verify.mms.export.record import Precision
from mpm_verify.solver.plugins import MATERIALS, create
from mpm_verify.solver.state import Floats

FRAMES, PPC = 4, 4
ENDS = ("", "_half")
SHAKE = 0.05  # velocities over C
J, TURNED = 1.6, 0.15  # det F of a graded body, and an angle that no component is zero at


@dataclass(frozen=True)
class Asked:
    """Case of a test: what is exported, its motion, and the acceleration (2,) that a graded stress makes."""

    exported: Exported
    motion: Any
    state: str
    material: Any
    pull: Floats | None = None


def asked(test: str, material: str, precision: Precision = "double") -> Asked:
    """Case of a test by its name."""
    made, case = create(MATERIALS, material), CASES[test]
    motion = replace(case.motion, C=float(made.wave_speed()))
    found = export(
        Names(f"exact_{test}", material), motion, made, motion.cells[0], PPC, COURANT, FRAMES, checked=False,
        precision=precision,
    )  # fmt: skip
    plain = Asked(found, motion, case.state, made)
    return STATES[case.state](plain) if case.state else plain


def with_columns(case: Asked, columns: dict[str, Floats]) -> Asked:
    """Case with other columns of its particles."""
    return replace(case, exported=replace(case.exported, particles=case.exported.particles | columns))


def shaken(case: Asked) -> Asked:
    """Case with a velocity of its own for each particle."""
    given = case.exported.particles
    more = named("v", SHAKE * case.motion.C * random(len(given["id"]), 2))
    return with_columns(case, {f"{name}{end}": given[f"{name}{end}"] + more[name] for name in more for end in ENDS})


def graded(axis: int) -> Callable[[Asked], Asked]:
    """State whose stress on planes normal to an axis is affine along it."""

    def of(case: Asked) -> Asked:
        given, material = case.exported.particles, case.material
        s = given["xy"[axis]]
        one, both = 1.5 + 0.3 * (s - 0.5), 0.05 + 0.2 * (s - 0.4)  # components of B = F F^T
        B = np.empty((len(s), 2, 2))
        B[:, axis, axis], B[:, 0, 1], B[:, 1, 0] = one, both, both
        B[:, 1 - axis, 1 - axis] = (J**2 + both**2) / one
        F = np.linalg.cholesky(B) @ turn(TURNED)
        sigma = listed(*cauchy(material, F))
        slopes = np.polynomial.polynomial.polyfit(s - 0.5, sigma[:, [(0, 3), (3, 1)][axis]], 1)
        left = sigma[:, [(0, 3), (3, 1)][axis]] - slopes[0] - np.outer(s - 0.5, slopes[1])
        rho0, inverse = float(material.rho0), np.linalg.inv(F)
        a = slopes[1] * J / rho0 if np.abs(left).max() < bound(1) * rho0 * case.motion.C**2 else None
        V0 = given["V0"] / J
        half = np.array([[given[f"r{k + 1}{letter}"] for letter in "xy"] for k in range(2)])  # of the lattice: (2,2,P)
        changed = {"V0": V0, "m": rho0 * V0}
        for k in range(2):
            changed |= named(f"r{k + 1}", np.einsum("pab,bp->pa", inverse, half[k]))
        for end in ("", "_before"):
            changed |= named("F", F, end) | named("s", sigma, end)
        if a is not None:
            changed |= named("v", np.broadcast_to(-0.5 * case.motion.dt * a, (len(s), 2)), "_half")
        return replace(with_columns(case, changed), pull=a)

    return of


STATES: dict[str, Callable[[Asked], Asked]] = {
    "shaken": shaken, "kept": shaken, "graded_x": graded(0), "graded_y": graded(1),
}  # fmt: skip
