"""Smoothing within a run: nodal forces are those of the smoothed stress, and what it does not take is refused."""

from functools import partial

import numpy as np

from mpm_verify.cases.exact.body import DX, STRAINED, Subject, Variant, layout, modelled, populated, shaken
from mpm_verify.cases.exact.dense import Dense, weights
from mpm_verify.mms.constitutive.tested import FAILED, Part, Reason, Tested, attempt, bound, not_asked, off
from mpm_verify.solver.plugins import SMOOTHINGS, create
from mpm_verify.solver.smoothing._base import RATES
from mpm_verify.solver.step import particles_to_grid

OF_STRESS = ("volumetric", "deviatoric", "full")
ASKED = ("", ":of=stress", ":into=history")  # ways to smooth with each of them


def tests(subject: Subject) -> list[Tested]:
    """Forces of each smoothing of stress that the material takes, and refusals."""
    found: list[Tested] = []
    if subject.material.rate not in (None, *RATES):
        found.append(not_asked("smoothing_force", Part.SMOOTHING, Reason.OTHER_RATE))
    for name in OF_STRESS if not found else ():
        found += attempt(f"smoothing_force {name}", Part.SMOOTHING, partial(force, subject, name))
    return found + attempt("smoothing_refused", Part.SMOOTHING, partial(refused, subject))


def force(subject: Subject, name: str) -> Tested:
    """Forces at the nodes against full matrices of weights and the smoothed stress, which is another one."""
    p = shaken(subject, populated(subject, layout(), STRAINED))
    model = modelled(subject, p, Variant(), smoothing=create(SMOOTHINGS, f"{name}:of=stress"))
    particles_to_grid(model)
    p = model.particles
    unit = 1e-3 * subject.stress
    w = weights(model, subject.basis.on_grid(p), p.F)
    expected = Dense(model, 1.0).force(w, p.F, p.sigma_smoothed, p.b)
    other = off(p.sigma_smoothed, p.sigma, unit) > 1e-3
    residual = off(model.grid.force, expected, subject.stress * DX)
    return Tested(f"smoothing_force {name}", residual if other else FAILED, bound(4 * subject.support), Part.SMOOTHING)


def refused(subject: Subject) -> Tested:
    """Number of smoothings that a run takes and must not, or the other way.

    A rate that stretches takes none. A function of F has no strain rate and no history: of it the force's stress can
    be smoothed, and the volume ratio.
    """
    rate, wrong = subject.material.rate, 0
    for name in OF_STRESS:
        for asked in ASKED:
            of_F = asked == ":of=stress" or (name == "volumetric" and not asked)
            takes = rate in RATES if rate is not None else of_F
            p = shaken(subject, populated(subject, layout(), np.eye(2)))
            try:
                modelled(subject, p, Variant(), smoothing=create(SMOOTHINGS, name + asked))
                wrong += not takes
            except ValueError:
                wrong += takes
    return Tested("smoothing_refused", float(wrong), 0.0, Part.SMOOTHING)
