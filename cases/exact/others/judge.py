"""Answer of somebody else's solver against what is exact: residuals, bounds, and the parts that they point to."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from mpm_verify.cases.exact.others.names import Cause, Left
from mpm_verify.cases.exact.others.state import Asked
from mpm_verify.cases.solvers.answer import Frame
from mpm_verify.cases.solvers.asking import positions
from mpm_verify.cases.solvers.levels import Levels
from mpm_verify.mms.constitutive.driver import columns
from mpm_verify.mms.constitutive.stress import cauchy
from mpm_verify.mms.constitutive.tested import EPS, FAILED, Tested, bound, off
from mpm_verify.solver.state import Floats

SINGLE = 2.0**-23
SUPPORT = 16  # support nodes of a particle, of the widest basis
FILE = 10.0  # largest rounding of the numbers in a file over their standard deviation, and more
STAGGERED = 0.5
CAUSES = {
    "X": Cause.OWN_NUMBERS, "x": Cause.OWN_TIME, "v": Cause.OWN_FORCE, "F": Cause.OWN_GRADIENT,
    "sigma": Cause.OWN_STRESS, "V": Cause.OWN_VOLUME,
}  # fmt: skip
OTHER_CAUSES = {
    ("kept", "v"): Cause.OWN_FLIP, ("shaken", "x"): Cause.OWN_SUMS, ("shaken", "v"): Cause.OWN_SUMS,
    ("graded_x", "x"): Cause.OWN_INNER, ("graded_x", "v"): Cause.OWN_INNER,
    ("graded_y", "x"): Cause.OWN_INNER, ("graded_y", "v"): Cause.OWN_INNER,
}  # fmt: skip
DERIVED = ("sigma", "V")  # from F
Expected = Floats | Left


@dataclass(frozen=True)
class Answered:
    """Answer to a case: its frames by step, and the time levels that it states."""

    case: Asked
    frames: Mapping[int, Frame]
    levels: Levels
    flip: bool = True

    @cached_property
    def X(self) -> Floats:
        """Reference positions (P,2)."""
        return positions(self.case.exported)

    @cached_property
    def scales(self) -> dict[str, float]:
        """Scale of each quantity: the grid, the speed C, 1, rho0 C^2, and the largest volume."""
        record, material, C = self.case.exported.record, self.case.material, self.case.motion.C
        wide = float(np.max(np.array(record.grid_upper) - np.array(record.grid_lower)))
        return {"X": wide, "x": wide, "v": C, "F": 1.0, "sigma": float(material.rho0) * C**2,
                "V": float(self.case.exported.particles["V0"].max())}  # fmt: skip

    @cached_property
    def rounding(self) -> float:
        """Rounding of the numbers in the files, standard deviation over the scale, of the quantity with most."""
        sizes = [
            [size / self.scales[name] for name, size in frame.resolution.items()] for frame in self.frames.values()
        ]
        return max((max(one, default=0.0) for one in sizes), default=0.0)

    @cached_property
    def bound(self) -> float:
        """Bound of a residual: roundings of all steps and of positions in a grid, and the digits of the files."""
        record = self.case.exported.record
        wide = (record.grid_upper[0] - record.grid_lower[0]) / record.dx
        unit = SINGLE / EPS if record.precision == "single" else 1.0
        return unit * bound(SUPPORT * record.steps + wide) + FILE * self.rounding


def judged(test: str, answer: Answered) -> list[Tested]:
    """Outcomes of a test, one for each quantity."""
    case, found = answer.case, []
    for quantity in CAUSES:
        cause = OTHER_CAUSES.get((case.state, quantity), CAUSES[quantity])
        name = f"{test} {quantity}"
        if not all(quantity in frame.fields for frame in answer.frames.values()):
            if quantity not in ("X", "V"):  # which nobody has to write
                found.append(Tested(name, 0.0, 0.0, cause, Left.NO_COLUMN))
            continue
        every = [residual(answer, quantity, step, frame) for step, frame in answer.frames.items()]
        worst = max((one for one in every if not isinstance(one, Left)), default=None)
        if worst is None:
            reason = next(one for one in every if isinstance(one, Left))
            found.append(Tested(name, 0.0, 0.0, cause, reason))
            continue
        found.append(Tested(name, worst, answer.bound, cause))
    return found


def residual(answer: Answered, quantity: str, step: int, frame: Frame) -> float | Left:
    """Largest distance of a quantity in a frame from what is exact, over its scale; or why it is not asked.

    A stress, or a volume, is held against that of the F which is written beside it, if it is there.
    """
    case, t = answer.case, step * answer.case.motion.dt
    given, scale = frame.fields[quantity], answer.scales[quantity]
    if quantity == "X":
        return off(given, answer.X, scale)
    chosen = judged_particles(answer)
    if quantity in DERIVED and "F" in frame.fields:
        F = frame.fields["F"][chosen].reshape(-1, 2, 2)
        return off(given[chosen], derived(answer, quantity, F, chosen), scale) if positive(F) else FAILED
    if case.state == "shaken":
        return summed(answer, quantity, t, given)
    expected = {"x": position, "v": velocity}.get(quantity, strained)(answer, quantity, t)
    return expected if isinstance(expected, Left) else off(given[chosen], expected[chosen], scale)


def judged_particles(answer: Answered) -> Any:
    """Which particles are held: all, or those deep inside."""
    case = answer.case
    if case.state.startswith("graded"):
        return case.motion.deep(positions_at_start(case))
    return np.ones(len(answer.X), dtype=bool) if case.state else case.motion.compared(answer.X)


def positive(F: Floats) -> bool:
    """Whether there is a stress of all F (P,2,2)."""
    return bool((np.linalg.det(F) > 0).all())


def derived(answer: Answered, quantity: str, F: Floats, chosen: Any) -> Floats:
    """Stresses (n,4), or volumes (n,1), of F (n,2,2) of some particles."""
    if quantity == "V":
        found: Floats = (answer.case.exported.particles["V0"][chosen] * np.linalg.det(F))[:, None]
        return found
    return columns(*cauchy(answer.case.material, F))


def positions_at_start(case: Asked) -> Floats:
    """Positions (P,2) at t = 0."""
    return np.stack([case.exported.particles[axis] for axis in "xy"], axis=-1)


def position(answer: Answered, quantity: str, t: float) -> Expected:
    """Positions (P,2) that are exact; those of leapfrog where the force grows."""
    case = answer.case
    if case.state == "kept":
        return Left.LEVEL
    if case.motion.grows and answer.levels.v_lag != STAGGERED:
        return Left.LEVEL
    if case.state:
        return Left.NOT_AFFINE if case.pull is None else positions_at_start(case) + 0.5 * t**2 * case.pull
    return np.asarray(case.motion.x(answer.X, t, short=case.motion.grows))


def velocity(answer: Answered, quantity: str, t: float) -> Expected:
    """Velocities (P,2) that are exact."""
    case, lag = answer.case, answer.levels.v_lag
    if case.state == "kept":
        if not answer.flip:
            return Left.NO_FLIP
        given = case.exported.particles
        return np.stack([given["vx"], given["vy"]], -1) if answer.levels.F_lag == 0 else Left.STRESS_FIRST
    if lag != STAGGERED and (case.motion.bends or case.state):
        return Left.LEVEL
    then = t - lag * case.motion.dt
    if case.state:
        return Left.NOT_AFFINE if case.pull is None else np.broadcast_to(then * case.pull, answer.X.shape)
    return np.asarray(case.motion.v(answer.X, then))


def strained(answer: Answered, quantity: str, t: float) -> Expected:
    """Deformation gradients (P,4) that are exact, their stresses (P,4), or volumes (P,1)."""
    case, given = answer.case, answer.case.exported.particles
    if case.state == "kept":
        return Left.LEVEL
    if case.state:
        F = np.stack([given[f"F{end}"] for end in ("xx", "xy", "yx", "yy")], -1).reshape(-1, 2, 2)
    else:
        one = case.motion.F_written(t, answer.levels.F_lag)
        if one is None:
            return Left.LEVEL
        F = np.broadcast_to(one, (len(answer.X), 2, 2))
    if quantity == "F":
        return np.asarray(F.reshape(-1, 4))
    return derived(answer, quantity, F, slice(None))


def summed(answer: Answered, quantity: str, t: float, given: Floats) -> float | Left:
    """Distance of the centre of mass, or of the momentum, from free fall: forces inside a body do not move it."""
    if quantity not in ("x", "v"):
        return Left.LEVEL
    case, columns_, m = answer.case, answer.case.exported.particles, answer.case.exported.particles["m"]
    _, G, _ = case.motion.drifts
    x, v = (np.stack([columns_[f"{first}{axis}"] for axis in "xy"], -1) for first in ("", "v"))
    then = t - answer.levels.v_lag * case.motion.dt
    start = m @ v / m.sum()
    expected = m @ x / m.sum() + t * start + 0.5 * t**2 * G if quantity == "x" else start + then * G
    return off(m @ given / m.sum(), expected, answer.scales[quantity])
