"""Mirror and quarter turn: a body, its walls and its forces, mirrored or turned, give the mirrored or turned answer."""

from typing import Any

import numpy as np

from mpm_verify.cases.exact.body import (
    CELLS, DX, MIRROR, QUARTER, Subject, Variant, by_id, layout, modelled, rotated, shaken, variants,
)  # fmt: skip
from mpm_verify.cases.exact.tested import Part, Reason, Tested, bound, not_asked, off
from mpm_verify.solver.boundary import Kind
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.state import Floats, Particles
from mpm_verify.solver.step import Model, advance

STEPS = 2
Sides = tuple[Kind, Kind, Kind, Kind]
SIDES: Sides = ("roller", "free", "fixed", "free")  # left, right, bottom, top
MOVED: dict[str, tuple[Floats, Sides]] = {
    "mirror": (MIRROR, ("free", "roller", "fixed", "free")),
    "quarter_turn": (QUARTER, ("free", "fixed", "roller", "free")),
}


def tests(subject: Subject) -> list[Tested]:
    """Mirror and quarter turn with every step."""
    own = getattr(subject.material, "reversal", 0.0)
    found = []
    for variant in variants():
        plain = None if own else run(subject, variant, np.eye(2), SIDES)
        for name, (Q, sides) in MOVED.items():
            told = f"{name} {variant}"
            if plain is None:
                found.append(not_asked(told, Part.SYMMETRY, Reason.OWN_AXES))
                continue
            moved = run(subject, variant, Q, sides)
            found.append(
                Tested(told, apart(subject, plain, moved, Q), bound(4 * STEPS * subject.support), Part.SYMMETRY)
            )
    return found


def middle(Q: Floats) -> Floats:
    """Middle of the grid, whose sides are swapped by a quarter turn."""
    centre: Floats = 0.5 * DX * (CELLS[::-1] if Q[0, 0] == 0 else CELLS)
    return centre


def run(subject: Subject, variant: Variant, Q: Floats, sides: Sides) -> Particles:
    """Particles after some steps of the body mapped by Q (2,2)."""
    pieces, centre, there = layout(filled=True), middle(np.eye(2)), middle(Q)
    r = pieces.r0 @ Q.T
    if np.linalg.det(Q) < 0:
        r[:, 0] *= -1.0  # counter-clockwise again
    mapped = Layout(there + (pieces.X - centre) @ Q.T, pieces.V0, r)
    p: Particles = subject.basis.populate(mapped, subject.material.rho0)
    shaken(subject, p)
    p.v[:], b, p.sigma[:] = p.v @ Q.T, p.b @ Q.T, rotated(p.sigma, Q)
    p.F[:] = Q @ p.F @ Q.T
    model: Model = modelled(subject, p, variant, sides, turned=Q[0, 0] == 0)
    for _ in range(STEPS):
        advance(model, lambda particles, t: np.copyto(particles.b, b[particles.id]))
    return p


def apart(subject: Subject, plain: Particles, moved: Particles, Q: Floats) -> float:
    """Distance of the moved answer from the plain one, moved."""
    pairs: list[tuple[Any, Any, float]] = [
        (by_id(moved, "x") - middle(Q), (by_id(plain, "x") - middle(np.eye(2))) @ Q.T, DX),
        (by_id(moved, "v"), by_id(plain, "v") @ Q.T, subject.speed),
        (by_id(moved, "F"), Q @ by_id(plain, "F") @ Q.T, 1.0),
        (by_id(moved, "sigma"), rotated(by_id(plain, "sigma"), Q), subject.stress),
    ]
    return max(off(*pair) for pair in pairs)
