"""Registry of what is expected of runs that differ from the usual ones in one axis: damping, smoothing, duration, dt.

All was measured with CPDI, 4 per cell, see docs/methods.md; of MPM what is said so. `recorded_axes.csv` has the errors.
Where two of these axes differ from what is usual nothing is registered.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from mpm_verify.cases.judging.records import Expectation, Recorded
from mpm_verify.cases.mms.expectations import same
from mpm_verify.cases.mms.recorded import Row, read, refinement
from mpm_verify.cases.mms.run import Run
from mpm_verify.solver.failure import FailureKind
from mpm_verify.solver.plugins import SOLUTIONS as SHIPPED
from mpm_verify.solver.plugins import create

TABLE = Path(__file__).with_name("recorded_axes.csv")
AXES = ("periods", "damping", "manufacture", "smoothing")  # what a row of the table is of, with its run
SOURCE = "measured, see docs/methods.md"
SOLUTIONS = ("axis_aligned", "clamped_shear", "swirl")  # those that were run
STALL, WITHIN = 1.8, 0.01
SEEN_ON = ((0.05, 32), (0.01, 64))  # least damping, and cells on which its floor shows at the latest
MOST_DAMPING = 0.2  # with more the error is that floor on all cells: no order falls
DIVERGES = 0.25  # periods after which the error of MPM grows on all cells; before, it falls at first
EARLY, EARLY_STALL, EARLY_CELLS = 0.125, 0.5, 64


def axes(run: Run) -> tuple[str, ...]:
    """Names of the axes in which a run is not as usual; damping and what is put into the problem are one."""
    found = tuple(name for name in AXES if getattr(run, name) != getattr(Run, name) and name != "manufacture")
    return found + ("printed",) * run.whole_steps


def variant(run: Run, quantity: str, norm: str, plain: Expectation | None) -> Expectation | None:
    """Expectation of a run that is not as usual in one axis, from `plain`, that of the usual run, or None."""
    beside = axes(run)
    if plain is None or norm != "rms" or len(beside) != 1:
        return None
    if beside[0] == "damping" and run.damping_inside:  # the orders of u, v, F and sigma are those without
        found = None if plain.order is None else plain
    else:
        found = KINDS[beside[0]](run, plain) if quantity == "u" else None
    if found is None:
        return None
    return replace(found, source=SOURCE, recorded=recorded(run, quantity), within=WITHIN, finest=False)


def damped(run: Run, plain: Expectation) -> Expectation | None:
    """Damping that is not in the problem: an order of 2 stalls on a floor in proportion to it."""
    cells = next((cells for least, cells in SEEN_ON if run.damping >= least), 0)
    known = run.damping <= MOST_DAMPING and run.solution in SOLUTIONS and own_material(run)
    if plain.order is None or not cells or not known:
        return None
    return Expectation(None, stall=STALL, stall_h=1 / cells)


def smoothed(run: Run, plain: Expectation) -> Expectation | None:
    """Smoothed stress of the force: u keeps its order; v, F and sigma fall towards order 1 and have not settled."""
    return plain if plain.order == 2 and run.method == "cpdi" and run.solution in SOLUTIONS else None


def lasting(run: Run, plain: Expectation) -> Expectation | None:
    """Another duration: an order is kept; over an eighth of a period MPM converges on coarse cells and then stalls."""
    if plain.order is not None:
        return plain
    if (run.method, run.solution) != ("mpm", "axis_aligned") or run.periods < EARLY:
        return None
    if run.periods >= DIVERGES:
        return plain
    return Expectation(None, stall=EARLY_STALL, stall_h=1 / EARLY_CELLS)


def unstable(run: Run, plain: Expectation) -> Expectation | None:
    """Printed time step, many times the stable one: particles are inverted at once."""
    known = run.solution in SOLUTIONS and run.courant == Run.courant and own_material(run)
    return Expectation(None, failed=FailureKind.INVERTED) if known else None


KINDS = {"damping": damped, "smoothing": smoothed, "periods": lasting, "printed": unstable}


def timed_as_usual(run: Run) -> bool:
    """Whether time step and start are those of the recorded errors."""
    return run.courant == Run.courant and run.time_step == Run.time_step and run.staggered


def own_material(run: Run) -> bool:
    """Whether the material is the one that the solution was measured in."""
    return same(run.material, create(SHIPPED, run.solution).material)


def recorded(run: Run, quantity: str) -> tuple[Recorded, ...]:
    """Recorded errors of a refinement of the reference solver at the usual time step, coarse to fine."""
    usual = timed_as_usual(run) and run.offset == Run.offset and not run.solver
    rows = table().get(key(run), ()) if usual else ()
    if not rows or not own_material(run):
        return ()
    return refinement(rows, quantity)


def key(run: Run) -> tuple[str, ...]:
    """Key of a refinement in the table."""
    return run.solution, run.method, str(run.ppc), *(str(getattr(run, name)) for name in AXES)


def table() -> Mapping[tuple[str, ...], list[Row]]:
    """Rows of recorded_axes.csv by refinement, see `key`."""
    return read(TABLE, "solution", "method", "ppc", *AXES)
