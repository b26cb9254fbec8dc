"""Hints on why an answer is wrong: causes and readings that are measured on its files, the best one first.

What moved the body is asked in turn, and one cause is named: particles in another order, nothing that moves, positions
of another time, the forces, walls, the start. F, volume and stress are held against the answer itself, so no cause of a
wrong motion makes a hint of them. Time levels of v and F are asked for only where the motion has no cause.
"""

from math import inf

import numpy as np

from mpm_verify.cases.mms.external import consistency, motion
from mpm_verify.cases.mms.external.balance import Balance
from mpm_verify.cases.mms.external.evidence import Evidence
from mpm_verify.cases.solvers.answer import Frame
from mpm_verify.cases.solvers.levels import Levels
from mpm_verify.mms.export.case import Exported
from mpm_verify.mms.manufacture import Manufactured

LAGS = (-0.5, 0.0, 0.5, 1.0)  # steps that a field may be behind x
FEW = 8  # frames that a balance in time takes
FAR = 10.0  # widths of the body: such displacements say nothing
MOTIONLESS = ("still", "unmoved")
ALONE = ("id_and_X", "permuted", *MOTIONLESS, "x_is_u")  # of a motion that says nothing more


def hints(exact: Manufactured, case: Exported, frames: dict[int, Frame], levels: Levels) -> dict[str, float]:
    """Find what explains an answer far better than what it says: at least half of an error or of a balance.

    Parameters
    ----------
    exact
        Exact fields.
    case
        Case that was given: particles, grid, edges, time step.
    frames
        Frames by the number of their step, at least two.
    levels
        Time levels that the answer states.

    Returns
    -------
    dict
        Numbers by the name of a hint; reports/sentences/own_solver.py says what each of them is. Empty where nothing
        explains half of anything, as of a sound answer.
    """
    e = Evidence(exact, case, frames, levels)
    if np.abs(e.u).max() > FAR * np.ptp(e.X):
        return {}
    with np.errstate(all="ignore"):
        return explained(e)


def explained(e: Evidence) -> dict[str, float]:
    """Causes and readings of an answer that is worth reading."""
    found = motion.single(e)
    moved = motion.order(e) or motion.still(e) or motion.displacements(e) or moved_by(e)
    if moved.keys() & set(ALONE):
        return moved | ({} if moved.keys() & set(MOTIONLESS) else found)
    of_F = consistency.of_F(e)
    of_sigma = consistency.of_stress(e, bool(of_F))
    if "F_twice" in of_F or of_sigma.keys() & {"sigma_mean", "plane_stress"}:
        moved = {name: value for name, value in moved.items() if name not in ("stress_factor", "stress_of_F")}
    rest = of_F | consistency.of_volume(e) | of_sigma
    if not moved:
        levels = motion.at_walls(e) or other_levels(e)
        if of_F:
            levels.pop("F_lag", None)
        if "F_lag" in levels:
            rest.pop("sigma_lag", None)
        rest |= levels
    return moved | rest | found


def moved_by(e: Evidence) -> dict[str, float]:
    """Another time of the positions, or a force or stress that the momentum balance names: the one that leaves less.

    Else walls, which take no part in that balance, or the start. The balance is taken of rectangles in plane strain.
    """
    found, left = motion.other_times(e)
    if e.case.record.body != "rectangle" or e.around or len(e.frames) < FEW or not e.stressed:
        return found or motion.walls(e)
    balance = Balance(e)
    tried = balance.tried()
    cause, rest = motion.forces(tried, e.case.record.steps)
    return (cause if rest < left else found) or motion.walls(e) or motion.start(balance, tried)


def other_levels(e: Evidence) -> dict[str, float]:
    """Steps that v and F are behind x, where another number than is stated at least halves their error."""
    found = {}
    for key, name, told in (("v", "v_lag", e.levels.v_lag), ("F", "F_lag", e.levels.F_lag)):
        if not e.has(key):
            continue
        errors = {lag: motion.rms(e.given(key) - e.truth(key, lag)) for lag in {*LAGS, told}}
        best = min(LAGS, key=errors.__getitem__)
        if errors[best] < motion.BETTER * errors.get(told, inf):
            found[name] = best
    return found
