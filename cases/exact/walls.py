"""No force: velocities stay as they are, whatever walls hold; and sliding along rollers."""

from dataclasses import dataclass
from functools import partial
from typing import get_args

import numpy as np

from mpm_verify.cases.exact.body import (
    FILLED,
    Subject,
    Variant,
    by_id,
    layout,
    modelled,
    populated,
    rest,
    variants,
)
from mpm_verify.mms.constitutive.driver import random
from mpm_verify.mms.constitutive.tested import Part, Reason, Tested, attempt, bound, not_asked, off
from mpm_verify.solver.boundary import Kind
from mpm_verify.solver.material_model import Material
from mpm_verify.solver.state import Particles
from mpm_verify.solver.step import advance


def tests(subject: Subject) -> list[Tested]:
    """Random velocities with each kind of wall, and a uniform one along rollers, with every step."""
    found = []
    for variant in variants():
        found += attempt(f"slide {variant}", Part.WALLS, partial(sliding, subject, variant))
        found += attempt(f"no_force_free {variant}", Part.WALLS, partial(forceless, subject, variant))
    return found


def sliding(subject: Subject, variant: Variant) -> Tested:
    """Body between rollers that moves along them."""
    p = populated(subject, layout(filled=True), np.eye(2))
    p.v[:] = v = subject.speed * np.array([0.0, 0.1])
    advance(modelled(subject, p, variant, ("roller", "roller", "free", "free"), FILLED), rest)
    return Tested(f"slide {variant}", off(p.v, v, subject.speed), bound(subject.support), Part.WALLS)


def forceless(subject: Subject, variant: Variant) -> list[Tested]:
    """Body without stress, each particle with a velocity of its own, in a box of each kind."""
    found = []
    for kind in get_args(Kind):
        name = f"no_force_{kind} {variant}"
        if variant.flip < 1:
            found.append(not_asked(name, Part.WALLS, Reason.BLENDS))
            continue
        p = populated(subject, layout(filled=True), np.eye(2))
        p.v[:] = v = 0.05 * subject.speed * random(len(p), 2)
        model = modelled(subject, p, variant, kind, FILLED)
        model.material = Powerless(subject.speed)
        advance(model, rest)
        found.append(Tested(name, off(by_id(p, "v"), v, subject.speed), bound(1), Part.WALLS))
    return found


@dataclass(frozen=True)
class Powerless(Material):
    """Material that has no stress, whatever its strain; waves have the speed `c`."""

    c: float

    def update(self, particles: Particles, dt: float) -> None:
        """Write no stress."""
        particles.sigma[:] = 0.0

    def wave_speed(self, s: float | None = None) -> float:
        """Speed of the fastest wave, as given."""
        return self.c
