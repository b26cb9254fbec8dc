"""Comparison of an answer with runs of the reference: digits that agree, the nearest one, where the two part.

Errors of both are compared, each field at its own time level, so that fields of different levels can be. Digits of
rms values are -log10 of their relative difference; those of particles -log10 of rms(error - error of the reference) /
rms(error of the reference), over frames and particles weighted by volume.
"""

from collections.abc import Mapping
from math import log10, sqrt

import numpy as np

from mpm_verify.cases.mms.digits.records import AGREES, Against, Parting
from mpm_verify.cases.mms.digits.reference import Scheme
from mpm_verify.cases.solvers.answer import Frame
from mpm_verify.cases.solvers.components import WEIGHTS
from mpm_verify.cases.solvers.levels import Levels
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.state import Floats

MOST = 12.0  # digits: beyond, rounding is compared
QUANTITIES = ("u", "v", "F", "sigma")
Errors = dict[str, Floats]  # by quantity (S,P,C): of each frame, particle and component


def errors(exact: Manufactured, X: Floats, dt: float, frames: Mapping[int, Frame], levels: Levels) -> Errors:
    """Errors of each quantity that all frames have, at its own time level.

    Parameters
    ----------
    exact
        Exact fields.
    X
        Reference positions (P,2).
    dt
        Length of a time step.
    frames
        Frames by the number of their step.
    levels
        Time levels of v, F and sigma.

    Returns
    -------
    dict of str to array (S,P,C)
        Components of sigma weighted, so that the sum of squares is that of the tensor.
    """
    lags = {"u": 0.0, "v": levels.v_lag, "F": levels.F_lag, "sigma": levels.F_lag}
    found = {}
    for quantity, lag in lags.items():
        key = "x" if quantity == "u" else quantity
        if all(key in frame.fields for frame in frames.values()):
            truth = exact.x if quantity == "u" else getattr(exact, quantity)
            weight = np.sqrt(WEIGHTS[4]) if quantity == "sigma" else 1.0
            found[quantity] = np.stack([
                weight * (frame.fields[key] - truth(X, (step - lag) * dt).reshape(len(X), -1))
                for step, frame in sorted(frames.items())
            ])  # fmt: skip
    return found


def rms(error: Floats, V0: Floats) -> float:
    """Root mean square of errors (S,P,C) over frames and particles, weighted by volumes (P,)."""
    return sqrt(float((V0 / V0.mean() * (error**2).sum(axis=-1)).mean()))


def digits(difference: float, size: float) -> float:
    """Digits that agree: -log10 of a difference over the size of what it is a difference of, from 0 to MOST."""
    if difference == 0:
        return MOST
    return float(np.clip(-log10(difference / size), 0.0, MOST)) if size > 0 else 0.0


def against(scheme: Scheme, theirs: Errors, reference: Errors, V0: Floats) -> Against:
    """Answer held against the frames of one reference."""
    sizes = {q: rms(error, V0) for q, error in reference.items() if q in theirs}
    particles = {q: digits(rms(theirs[q] - reference[q], V0), size) for q, size in sizes.items()}
    return Against(scheme, sizes, by_value({q: rms(theirs[q], V0) for q in sizes}, sizes), particles)


def by_value(rms: Mapping[str, float], sizes: Mapping[str, float], most: float = MOST) -> dict[str, float]:
    """Digits in which rms values agree, `most` at most, by quantity."""
    return {q: min(most, digits(abs(rms[q] - size), size)) for q, size in sizes.items()}


def partings(
    theirs: Errors, reference: Errors, quantities: tuple[str, ...], X: Floats, V0: Floats, steps: tuple[int, ...]
) -> tuple[Parting, ...]:
    """First frame and particle where each of the quantities parts from the reference, the first to do so first.

    A particle parts where its difference is above 10^-AGREES of the rms error of the reference in its frame. In a
    frame it is the particle whose difference is largest; of quantities that part in one frame, that whose difference
    is largest for its size is first.
    """
    found = []
    for quantity in quantities:
        size = np.array([rms(frame[None], V0) for frame in reference[quantity]])
        off = np.sqrt(((theirs[quantity] - reference[quantity]) ** 2).sum(axis=-1))
        beyond = np.flatnonzero(off.max(axis=1) > 10.0**-AGREES * size)
        if len(beyond):
            s = int(beyond[0])
            p = int(off[s].argmax())
            at = (float(X[p, 0]), float(X[p, 1]))
            found.append(Parting(quantity, s + 1, steps[s], p, at, float(off[s, p]), float(size[s])))
    return tuple(sorted(found, key=lambda one: (one.frame, -one.difference / max(one.size, 1e-300))))
