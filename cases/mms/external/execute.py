"""One run of the external case: a case folder is written, somebody else's program reads it, its answer is compared."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.harness.study import Arrays, parameters
from mpm_verify.cases.mms.exact import audited, manufactured
from mpm_verify.cases.mms.external.errors import Found, compare
from mpm_verify.cases.mms.external.evidence import Evidence
from mpm_verify.cases.mms.external.hints import hints
from mpm_verify.cases.mms.external.motion import still
from mpm_verify.cases.mms.run import Result, Run
from mpm_verify.cases.solvers.asking import Answer, ask, positions
from mpm_verify.mms.discretisation import dimension
from mpm_verify.mms.duration import lasting
from mpm_verify.mms.export.case import Exported, Names, export
from mpm_verify.mms.export.slice import sliced
from mpm_verify.mms.export.start import named
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create

FRAMES = 16
ROUND = {"double": float(np.finfo(np.float64).eps), "single": float(np.finfo(np.float32).eps)}


def execute(run: Run, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Result, Arrays]:
    """Run the program to its end, or to where it fails: that is a Result too. `tick` hears the fraction of frames."""
    case = exported(run)
    answer = answered(run, case, tick)
    found, why = Found({}, {}, {}), dict[str, float]()
    if answer.frames:
        exact, X, dt = exact_of(run), positions(case), case.record.dt
        found = compare(exact, X, case.particles["V0"], dt, answer.frames, answer.told)
        why = hints(exact, case, answer.frames, answer.told)
    result, numbers = result_of(run, case, found, answer.failure), answer.told.numbers
    return replace(result, wall_s=answer.wall_s, log=answer.log.lines, exit_code=answer.exit_code,
                   told=answer.told.version, values=why | numbers), answer.log.kept  # fmt: skip


def answered(run: Run, case: Exported, tick: Callable[[float], None] = lambda fraction: None) -> Answer:
    """Answer of a command or of a Python function to a case.

    Where nothing moves that is known of its frames.
    """
    start, exact = named(run.start), exact_of(run)
    answer = ask(run, case, start.force(exact.b, case.record.dt) if start else exact.b, tick)
    if not answer.frames or "still" not in still(Evidence(exact, case, answer.frames, answer.told)):
        return answer
    return replace(answer, frames={step: replace(frame, moves=False) for step, frame in answer.frames.items()})


@cache
def exported(run: Run) -> Exported:
    """Content of the case folder."""
    solution = sliced(lasting(create(SOLUTIONS, run.solution), run.periods), run.dim, run.cells)
    material = create(MATERIALS, run.material)
    names = Names(run.solution, run.material)
    return export(
        names,
        solution,
        material,
        run.cells,
        run.ppc,
        run.courant_number,
        FRAMES,
        checked=False,
        start=named(run.start),
        precision=run.precision,  # type: ignore[arg-type]
    )


@cache
def exact_of(run: Run) -> Manufactured:
    """Exact solution in as many dimensions as the case has."""
    solution, material = create(SOLUTIONS, run.solution), create(MATERIALS, run.material)
    if dimension(solution) == run.dim:
        return manufactured(run.solution, run.material)
    return manufacture(sliced(solution, run.dim, run.cells), material, material.rho0)


def result_of(run: Run, case: Exported, found: Found, failure: Failure | None) -> Result:
    """Result with the errors that were found."""
    finite = all(np.isfinite(list(norms.values())).all() for norms in found.errors.values())
    if not failure and not finite:
        failure = Failure(FailureKind.ERROR_NOT_FINITE, case.record.steps)
    walk = ROUND[run.precision] * float(np.sqrt(case.record.steps))
    extent = float(np.ptp(case.particles["X"]))
    size = {**found.scale, "u": extent, "F": 1.0}
    floor = {q: float(max(digits, walk * size[q])) for q, digits in found.floor.items()}
    return Result(
        run=run,
        digest=run.digest,
        status="failed" if failure else "finished",
        errors={} if failure else found.errors,
        steps=case.record.steps,
        particles=case.record.particles,
        dt=case.record.dt,
        scale=found.scale,
        floor={} if failure else floor,
        failure=failure,
        crossings=None,
        audit=audited(run.solution, run.material, run.periods),
        environment=environment(),
        parameters=parameters("solution", create(SOLUTIONS, run.solution))
        | parameters("material", create(MATERIALS, run.material)),
    )
