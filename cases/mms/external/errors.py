"""Error norms of frames that somebody else's solver has written: rms, max and printed over frames and particles, final.

With e the error of a particle in a frame, and weights V0 / mean V0, as cases/mms/norms.py has them over all steps.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from mpm_verify.cases.solvers.answer import Frame
from mpm_verify.cases.solvers.components import WEIGHTS
from mpm_verify.cases.solvers.levels import Levels
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.state import Floats


@dataclass(frozen=True)
class Found:
    """Errors by quantity and norm, with the size of the exact quantity and the floor of the digits in the files."""

    errors: dict[str, dict[str, float]]
    scale: dict[str, float]
    floor: dict[str, float]


def compare(exact: Manufactured, X: Floats, V0: Floats, dt: float, frames: dict[int, Frame], levels: Levels) -> Found:
    """Compare frames with the exact solution.

    Parameters
    ----------
    exact
        Exact fields.
    X, V0
        Reference positions (P,d) and volumes (P,) of the particles.
    dt
        Length of a time step.
    frames
        Frames by the number of their step, the last step among them.
    levels
        Time levels of v, F and sigma.

    Returns
    -------
    Found
        For u, and each of v, F and sigma that every frame has. The floor is that of the frame with most digits: numbers
        that happen to be round have few.
    """
    weight = V0 / V0.mean()
    lags = {"u": 0.0, "v": levels.v_lag, "F": levels.F_lag, "sigma": levels.F_lag}
    errors, scale, floor = {}, {}, {}
    last = max(frames)
    for quantity, lag in lags.items():
        key = "x" if quantity == "u" else quantity
        if not all(key in frame.fields for frame in frames.values()):
            continue
        squares, largest, sizes, rounding, final = [], [], [], [], 0.0
        for step, frame in frames.items():
            truth = getattr(exact, quantity)(X, (step - lag) * dt).reshape(len(X), -1)
            given = frame.fields[key] - X if quantity == "u" else frame.fields[key]
            counted = WEIGHTS[truth.shape[1]] if quantity == "sigma" else 1.0  # a shear counts twice
            square = (counted * (given - truth) ** 2).sum(axis=1)
            squares.append(float((weight * square).mean()))
            largest.append(float(square.max()))
            sizes.append(float((weight * (counted * truth**2).sum(axis=1)).mean()))
            rounding.append(frame.resolution.get(key, 0.0))
            final = sqrt(squares[-1]) if step == last else final
        rms = sqrt(np.mean(squares))
        printed = rms / sqrt(len(frames) * len(X))
        errors[quantity] = {"rms": rms, "max": sqrt(max(largest)), "final": final, "printed": printed}
        scale[quantity], floor[quantity] = sqrt(np.mean(sizes)), min(rounding)
    return Found(errors, scale, floor)
