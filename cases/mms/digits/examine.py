"""Comparison of one run of somebody else's solver: its answer, the references, the nearest, and a picture of where."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mpm_verify.cases.mms.digits.compare import Errors, against, digits, errors, partings, rms
from mpm_verify.cases.mms.digits.records import Against, Compared
from mpm_verify.cases.mms.digits.reference import Scheme, reference, run_frames
from mpm_verify.cases.mms.digits.table import alike, by_rms, stored
from mpm_verify.cases.mms.exact import manufactured
from mpm_verify.cases.mms.external.evidence import Evidence
from mpm_verify.cases.mms.external.execute import answered, exported
from mpm_verify.cases.mms.external.motion import still
from mpm_verify.cases.mms.run import Run
from mpm_verify.cases.solvers.asking import Answer, positions
from mpm_verify.mms.export.case import Exported
from mpm_verify.solver.failure import Failure
from mpm_verify.solver.layout import parallelograms
from mpm_verify.solver.state import Floats

NEAREST = 9  # references of a stored case that are run: those nearest by rms values
Tick = Callable[[int, int], None]


@dataclass(frozen=True)
class Moment:
    """Moment of the picture: domains (P,4,2) of the particles, and by quantity how far each is off, (P,)."""

    frame: int
    step: int
    time: float
    corners: Floats
    off: dict[str, Floats]


@dataclass(frozen=True)
class Examined:
    """Comparison with what its picture needs: the frame where the two part first, and the last one."""

    run: Run
    compared: Compared
    moments: tuple[Moment, ...] = ()


def examine(
    run: Run, chosen: Sequence[Scheme], stored_only: bool = False, tick: Tick = lambda done, of: None
) -> Examined:
    """Run a solver of somebody else, and hold its answer against references.

    Parameters
    ----------
    run
        Run with a solver.
    chosen
        References. Of a stored case those are run that are nearest by rms values, of any other case all.
    stored_only
        Whether the stored rms values are all that is looked at.
    tick
        Hears how many runs are done, and of how many.

    Returns
    -------
    Examined
        The comparison; with the moments of its picture where a reference was run.

    Raises
    ------
    ValueError
        Where nothing is stored of the case and no reference is to be run.
    """
    kept = stored(run)
    known = {scheme: found for scheme, found in kept.items() if scheme in chosen}
    if stored_only and kept and not known:
        raise ValueError("--stored: no digits are stored of these references; leave --stored out, and they are run")
    if stored_only and not known:
        raise ValueError("--stored: no digits are stored of this case; leave --stored out, and the reference is run")
    case = exported(run)
    answer = answered(run, case)
    if answer.failure:
        return Examined(run, Compared({}, {}, (), failure=answer.failure, log=answer.log))
    exact, X = manufactured(run.solution, run.material), positions(case)
    theirs = errors(exact, X, case.record.dt, answer.frames, answer.told)
    own = {q: rms(error, case.particles["V0"]) for q, error in theirs.items()}
    near, rests = by_rms(own, known), bool(still(Evidence(exact, case, answer.frames, answer.told)))
    if stored_only:
        limit, twins = (limits(answer, near[0].rms), alike(near[0], near)) if near else ({}, ())
        return Examined(run, Compared(own, limit, near, alike=twins, still=rests))
    names = [one.scheme for one in near[:NEAREST]] if near else list(chosen)
    found = against_frames(run, case, answer, theirs, names, tick)
    farther = [one for one in near if one.scheme not in names]
    twins = alike(found.compared.nearest, [*found.compared.against, *farther]) if found.compared.against else ()
    return replace(found, compared=replace(found.compared, rms=own, farther=len(farther), alike=twins, still=rests))


def against_frames(
    run: Run, case: Exported, answer: Answer, theirs: Errors, names: Sequence[Scheme], tick: Tick
) -> Examined:
    """Answer held against runs of the reference; the frames of the nearest alone are kept."""
    exact, X, V0, dt = manufactured(run.solution, run.material), positions(case), case.particles["V0"], case.record.dt
    found: list[Against] = []
    failed: dict[Scheme, Failure] = {}
    best: tuple[Against, Answer, Errors] | None = None
    for number, scheme in enumerate(names):
        tick(number, len(names))
        one = run_frames(reference(run, scheme))
        if one.failure:
            failed[scheme] = one.failure
            continue
        mine = errors(exact, X, dt, one.frames, one.told)
        found.append(against(scheme, theirs, mine, V0))
        if best is None or found[-1].score > best[0].score:
            best = found[-1], one, mine
    tick(len(names), len(names))
    if best is None:
        return Examined(run, Compared({}, {}, (), framed=True, failed=failed))
    nearest, frames, mine = best
    ranked = tuple(sorted(found, key=lambda one: -one.score))
    compared = Compared({}, limits(answer, nearest.rms), ranked, framed=True, failed=failed)
    parted = partings(theirs, mine, compared.parts, X, V0, tuple(sorted(answer.frames)))
    compared = replace(compared, partings=parted)
    return Examined(run, compared, moments(case, compared, frames, theirs, mine))


def limits(answer: Answer, sizes: dict[str, float]) -> dict[str, float]:
    """Digits that the numbers in the files allow, by quantity: those of the frame with most."""
    found = {}
    for quantity, size in sizes.items():
        key = "x" if quantity == "u" else quantity
        found[quantity] = digits(min(frame.resolution.get(key, 0.0) for frame in answer.frames.values()), size)
    return found


def moments(case: Exported, compared: Compared, nearest: Answer, theirs: Errors, mine: Errors) -> tuple[Moment, ...]:
    """Moments of the picture: the first frame where a quantity parts, and the last; of u, and of what parts first."""
    steps = sorted(nearest.frames)
    first = compared.partings[0].frame if compared.partings else len(steps)
    names = dict.fromkeys([*(one.quantity for one in compared.partings[:1]), "u"])
    p = case.particles
    r0 = np.stack([np.stack([p[f"r{k}x"], p[f"r{k}y"]], axis=-1) for k in (1, 2)], axis=1)
    found = []
    for number in dict.fromkeys([first, len(steps)]):
        step = steps[number - 1]
        x, F = nearest.frames[step].fields["x"], nearest.frames[step].fields["F"].reshape(-1, 2, 2)
        corners = parallelograms(x, np.einsum("pab,psb->psa", F, r0))
        off = {q: np.sqrt(((theirs[q][number - 1] - mine[q][number - 1]) ** 2).sum(axis=-1)) for q in names}
        found.append(Moment(number, step, step * case.record.dt, corners, off))
    return tuple(found)
