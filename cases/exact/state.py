"""State of a run: stored, read and gone on with it is the same to the bit; and the longest step that a run may take."""

from dataclasses import fields
from functools import partial

import numpy as np

from mpm_verify.cases.exact.body import (
    DX,
    FILLED,
    STRESS_UPDATES,
    Subject,
    Variant,
    layout,
    modelled,
    populated,
    rest,
    shaken,
    variants,
)
from mpm_verify.cases.harness.state import Taken, written
from mpm_verify.mms.constitutive.driver import random
from mpm_verify.mms.constitutive.tested import Part, Tested, attempt
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.state import Particles
from mpm_verify.solver.step import Model, advance, check_time_step

BEFORE, AFTER = 1, 2  # steps before and after the state is stored
LONG, SHORT = 1.05, 0.95  # of the step limit
SLOW, FAST = 1e-5, 0.5  # speeds over c: of a run that stays linear, and one that the limit has to count
SHORTER = {"usl": 0.6}  # of it, for a stress update whose own stable step is shorter: see solver/transfers/fmpm.py
RUN = 40  # steps in which an unstable wave outgrows everything: it would grow by a tenth in each


def tests(subject: Subject) -> list[Tested]:
    """Restart with every step, the limit of the step, and runs below it."""
    found = []
    for variant in variants():
        found += attempt(f"restart {variant}", Part.STATE, partial(restart, subject, variant))
    for fraction in (LONG, SHORT):
        found += attempt(f"step_limit {fraction:g}", Part.TIME_STEP, partial(limit, subject, fraction))
    for stress in STRESS_UPDATES:
        found += attempt(f"stable_step {stress}", Part.TIME_STEP, partial(below, subject, Variant("flip", stress)))
    return found


def restart(subject: Subject, variant: Variant) -> Tested:
    """Number of arrays that differ after some steps straight through, and after a new model from what was stored."""

    def start(p: Particles) -> Model:
        model = modelled(subject, p, variant, ("roller", "free", "fixed", "free"), FILLED)
        model.dt *= 0.1  # nobody leaves a slab: rows would be summed in another order
        return model

    p = shaken(subject, populated(subject, layout(filled=True), np.eye(2)))
    straight = start(p)
    for _ in range(BEFORE):
        advance(straight, kept)
    stored, steps = Taken(p), straight.steps
    arrays = [array.copy() for array in stored.arrays]
    for _ in range(AFTER):
        advance(straight, kept)
    q = shaken(subject, populated(subject, layout(filled=True), np.eye(2)))
    again = start(q)
    written(stored.state, q, arrays)
    again.steps = steps
    for _ in range(AFTER):
        advance(again, kept)
    differ = [one.name for one in fields(p) if getattr(p, one.name).tobytes() != getattr(q, one.name).tobytes()]
    return Tested(f"restart {variant}", float(len(differ)), 0.0, Part.STATE)


def kept(particles: Particles, t: float) -> None:
    """Leave the body forces as they are."""


def struck(subject: Subject, variant: Variant, fraction: float, speed: float) -> Model:
    """Model of a body that is struck with a `speed` over c, with a step that is a fraction of the limit."""
    p = populated(subject, layout(filled=True), np.eye(2))
    p.v[:] = speed * subject.speed * random(len(p), 2)
    model = modelled(subject, p, variant, "roller", FILLED)
    model.dt = fraction * DX / (subject.material.wave_speed() + float(np.hypot(*p.v.T).max()))
    return model


def limit(subject: Subject, fraction: float) -> Tested:
    """Step above the limit, which has to be refused, or below, which must not: 0 where it is so, and 1 otherwise."""
    refused = False
    try:
        check_time_step(struck(subject, Variant(), fraction, FAST))
    except RunFailed as ended:
        refused = ended.failure.kind is FailureKind.UNSTABLE_STEP
    return Tested(f"step_limit {fraction:g}", float(refused != (fraction > 1)), 0.0, Part.TIME_STEP)


def below(subject: Subject, variant: Variant) -> Tested:
    """Run below the limit: its largest kinetic energy over that of the start, which nothing adds to."""
    fraction = SHORTER.get(variant.stress, SHORT)
    model = struck(subject, variant, fraction, SLOW)
    p = model.particles
    most = first = float((p.m[:, None] * p.v**2).sum())
    for _ in range(RUN):
        advance(model, rest)
        most = max(most, float((p.m[:, None] * p.v**2).sum()))
    return Tested(f"stable_step {variant.stress} {fraction:g}", most / first, 1.0, Part.TIME_STEP)
