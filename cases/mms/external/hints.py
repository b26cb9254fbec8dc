"""Hints on why an answer is wrong: readings of it that fit the exact fields far better than what it says."""

from collections.abc import Callable
from math import inf, isqrt, sqrt

import numpy as np

from mpm_verify.cases.mms.external.answer import Frame, Levels
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.state import Floats

BETTER = 0.5  # factor on an error that is no accident
STILL = 1e-3  # of the exact displacement: nothing has moved
SHIFTS = (-3, -2, -1, 1, 2, 3)  # steps
LAGS = (-0.5, 0.0, 0.5, 1.0)  # steps that a field may be behind x

Reading = Callable[[Floats], Floats]
READINGS: dict[str, tuple[str, Reading]] = {  # name of a hint: the field, and what it may be instead
    "F_transposed": ("F", lambda F: square(F).swapaxes(1, 2).reshape(F.shape)),
    "F_twice": ("F", lambda F: (0.5 * (square(F) + np.eye(isqrt(F.shape[1])))).reshape(F.shape)),
    "sigma_sign": ("sigma", lambda sigma: -sigma),
}


def square(F: Floats) -> Floats:
    """Matrices (P,d,d) of their components (P,d*d)."""
    return F.reshape(len(F), isqrt(F.shape[1]), -1)


def hints(exact: Manufactured, X: Floats, dt: float, frames: dict[int, Frame], levels: Levels) -> dict[str, float]:
    """Find readings of an answer that would at least halve its error.

    Parameters
    ----------
    exact
        Exact fields.
    X
        Reference positions (P,d).
    dt
        Length of a time step.
    frames
        Frames by the number of their step.
    levels
        Time levels that the answer states.

    Returns
    -------
    dict
        `still`: displacement over the exact one; `shift`, `v_lag`, `F_lag`: steps of the level that fits best;
        others, of READINGS: the error so read over the error as it is. Only what at least halves the error.
    """

    def error(key: str, lag: float, reading: Reading = lambda values: values) -> float:
        if not all(key in frame.fields for frame in frames.values()):
            return inf
        truth = {"x": exact.x, "v": exact.v, "F": exact.F, "sigma": exact.sigma}[key]
        gaps = [reading(frame.fields[key]) - truth(X, (step - lag) * dt).reshape(len(X), -1)
                for step, frame in frames.items()]  # fmt: skip
        return sqrt(float(np.mean([np.mean(gap**2) for gap in gaps])))

    moved = sqrt(float(np.mean([np.mean((frame.fields["x"] - X) ** 2) for frame in frames.values()])))
    meant = sqrt(float(np.mean([np.mean(exact.u(X, step * dt) ** 2) for step in frames])))
    if moved <= STILL * meant:
        return {"still": moved / meant}
    found: dict[str, float] = {}
    as_it_is = error("x", 0.0)
    best = min(SHIFTS, key=lambda steps: error("x", steps))
    if error("x", best) < BETTER * as_it_is:
        return {"shift": float(best)}
    if error("x", 0.0, lambda x: x + X) < BETTER * as_it_is:
        return {"x_is_u": 1.0}
    told = {"v": levels.v_lag, "F": levels.F_lag, "sigma": levels.F_lag}
    for key, name in (("v", "v_lag"), ("F", "F_lag")):
        lag = min(LAGS, key=lambda steps, key=key: error(key, steps))  # type: ignore[misc]
        if error(key, lag) < BETTER * error(key, told[key]):
            found[name] = lag
    for name, (key, reading) in READINGS.items():
        if error(key, told[key], reading) < BETTER * error(key, told[key]):
            found[name] = error(key, told[key], reading) / error(key, told[key])
    return found
