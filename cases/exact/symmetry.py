"""Mirror and quarter turn: a body, its walls and its forces, mirrored or turned, give the mirrored or turned answer."""

from functools import partial

import numpy as np

from mpm_verify.cases.exact.body import (
    DX,
    FILLED,
    MIRROR,
    QUARTER,
    Subject,
    Variant,
    by_id,
    layout,
    modelled,
    shaken,
    variants,
)  # fmt: skip
from mpm_verify.mms.constitutive.driver import rotated
from mpm_verify.mms.constitutive.tested import Pairs, Part, Reason, Tested, attempt, bound, farthest, not_asked
from mpm_verify.solver.friction import Sides
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.state import Floats, Ints, Particles
from mpm_verify.solver.step import Model, advance

STEPS = 2
SIDES: Sides = ("roller", "free", "fixed", "free")  # left, right, bottom, top
MAPS = {"mirror": MIRROR, "quarter_turn": QUARTER}
MOVED: dict[str, Sides] = {
    "mirror": ("free", "roller", "fixed", "free"),
    "quarter_turn": ("free", "fixed", "roller", "free"),
}


def tests(subject: Subject) -> list[Tested]:
    """Mirror and quarter turn with every step."""
    found = []
    for variant in variants():
        found += attempt(f"mirror {variant}", Part.SYMMETRY, partial(moved, subject, variant, SIDES, MOVED))
    return found


def moved(subject: Subject, variant: Variant, sides: Sides, mapped: dict[str, Sides]) -> list[Tested]:
    """Body between walls as it is, mirrored and turned; `mapped` are the walls by the name of the map."""
    names = {name: f"{name} {variant}" for name in mapped}
    if getattr(subject.material, "reversal", 0.0):
        return [not_asked(name, Part.SYMMETRY, Reason.OWN_AXES) for name in names.values()]
    plain, most = run(subject, variant, np.eye(2), sides), bound(4 * STEPS * subject.support)
    answers = {name: run(subject, variant, MAPS[name], given) for name, given in mapped.items()}
    return [
        Tested(names[name], distance(subject, plain, answer, MAPS[name]), most, Part.SYMMETRY)
        for name, answer in answers.items()
    ]


def middle(Q: Floats) -> Floats:
    """Middle of the grid, whose sides are swapped by a quarter turn."""
    centre: Floats = 0.5 * DX * cells(Q).astype(np.float64)
    return centre


def cells(Q: Floats) -> Ints:
    """Cells of the grid mapped by Q."""
    return FILLED[::-1] if Q[0, 0] == 0 else FILLED


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
    model: Model = modelled(subject, p, variant, sides, cells(Q))
    for _ in range(STEPS):
        advance(model, lambda particles, t: np.copyto(particles.b, b[particles.id]))
    return p


def distance(subject: Subject, plain: Particles, other: Particles, Q: Floats) -> float:
    """Distance of the moved answer from the plain one, moved."""
    pairs: Pairs = [
        (by_id(other, "x") - middle(Q), (by_id(plain, "x") - middle(np.eye(2))) @ Q.T, DX),
        (by_id(other, "v"), by_id(plain, "v") @ Q.T, subject.speed),
        (by_id(other, "F"), Q @ by_id(plain, "F") @ Q.T, 1.0),
        (by_id(other, "sigma"), rotated(by_id(plain, "sigma"), Q), subject.stress),
    ]
    return farthest(pairs)
