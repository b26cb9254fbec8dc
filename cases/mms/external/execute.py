"""One run of the external case: a case folder is written, somebody else's program reads it, its answer is compared."""

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.harness.study import Arrays, parameters
from mpm_verify.cases.mms.exact import audited, manufactured
from mpm_verify.cases.mms.external.answer import Frame, read
from mpm_verify.cases.mms.external.callables import Case, called
from mpm_verify.cases.mms.external.column_map import parsed
from mpm_verify.cases.mms.external.command import PYTHON, filled
from mpm_verify.cases.mms.external.components import reference
from mpm_verify.cases.mms.external.errors import Found, compare
from mpm_verify.cases.mms.external.hints import hints
from mpm_verify.cases.mms.external.levels import USUAL, Levels, levels
from mpm_verify.cases.mms.external.mapped import read as read_mapped
from mpm_verify.cases.mms.run import Result, Run
from mpm_verify.mms.discretisation import dimension
from mpm_verify.mms.export.case import Exported, Names, export
from mpm_verify.mms.export.files import files
from mpm_verify.mms.export.process import Ended
from mpm_verify.mms.export.process import run as run_program
from mpm_verify.mms.export.slice import sliced
from mpm_verify.mms.export.start import named
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.solver.failure import Failure, FailureKind, RunFailed
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create
from mpm_verify.solver.state import Floats

FRAMES = 16
LOG, LINES, WIDTH = "log.txt", 5, 300  # of the log, the last lines that are kept with the Result
ROUND = {"double": float(np.finfo(np.float64).eps), "single": float(np.finfo(np.float32).eps)}


@dataclass(frozen=True)
class Answer:
    """Answer of a solver: its frames by step, what it states, and how it ended; no frames where it failed."""

    frames: dict[int, Frame]
    told: Levels
    failure: Failure | None = None
    wall_s: float = 0.0
    log: tuple[str, ...] = ()
    exit_code: int | None = None


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
    return replace(result, wall_s=answer.wall_s, log=answer.log, exit_code=answer.exit_code,
                   told=answer.told.version, values=why | numbers), {}  # fmt: skip


def answered(run: Run, case: Exported, tick: Callable[[float], None] = lambda fraction: None) -> Answer:
    """Answer of a command or of a Python function to a case."""
    return in_process(run, case) if run.solver.startswith(PYTHON) else by_command(run, case, tick)


def by_command(run: Run, case: Exported, tick: Callable[[float], None]) -> Answer:
    """Answer of a command, in a folder that is removed."""
    with tempfile.TemporaryDirectory(prefix="mpm-verify-") as top:
        folder, out = Path(top) / "case", Path(top) / "out"
        out.mkdir()
        for name, text in files(case).items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
        words, room = filled(run.solver, folder, out), run.memory_limit * 2**20

        def look() -> None:
            tick(len(list(out.glob("result_*"))) / (1 + len(case.record.frames)))

        started = time.perf_counter()
        ended = run_program(words, out, run.time_limit, into=LOG, memory=room, look=look, here=Path.cwd())
        wall = time.perf_counter() - started
        failure, frames, told = None, dict[int, Frame](), Levels()
        log = last_lines(out / LOG, ended)
        try:
            check(ended, run.time_limit, log)
            told = levels(out, parsed(run.columns).levels if run.columns else USUAL)
            frames = frames_of(run, case, out)
        except RunFailed as error:
            failure = error.failure
        return Answer(frames, told, failure, wall, log, ended.code)


def in_process(run: Run, case: Exported) -> Answer:
    """Answer of a Python function."""
    exact, failure, frames, told = exact_of(run), None, dict[int, Frame](), Levels()
    started = time.perf_counter()
    try:
        start = named(run.start)
        force = start.force(exact.b, case.record.dt) if start else exact.b
        given = Case(case.record, case.particles, force)
        frames, told = called(run.solver, given, positions(case), spacing(case))
    except RunFailed as error:
        failure = error.failure
    return Answer(frames, told, failure, time.perf_counter() - started)


def positions(case: Exported) -> Floats:
    """Reference positions (P,d) of the particles of a case."""
    return reference(case.particles, case.record.dimension)


def check(ended: Ended, seconds: float, log: tuple[str, ...]) -> None:
    """Raise RunFailed for a program that did not end with 0, with the last line that it printed."""
    names = {"said": log[-1]} if log else {}
    if ended.code is None:
        raise RunFailed(FailureKind.TIME_LIMIT, -1, numbers={"seconds": seconds}, names=names)
    if ended.code != 0:
        raise RunFailed(FailureKind.SOLVER_ERROR, -1, numbers={"code": float(ended.code)}, names=names)


@cache
def exported(run: Run) -> Exported:
    """Content of the case folder."""
    solution = sliced(create(SOLUTIONS, run.solution), run.dim, run.cells)
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


def spacing(case: Exported) -> float:
    """Distance of particles at reference, a length."""
    return float(case.record.dx * case.record.ppc ** (-1 / case.record.dimension))


def frames_of(run: Run, case: Exported, out: Path) -> dict[int, Frame]:
    """Frames that a program has written, by step. Raises RunFailed for what is missing or cannot be read."""
    X, steps = positions(case), case.record.frames
    if run.columns:
        return read_mapped(out, parsed(run.columns), steps, case.record.dt, X, spacing(case))
    return {step: read(out, step, X, spacing(case)) for step in steps}


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
        audit=audited(run.solution, run.material),
        environment=environment(),
        parameters=parameters("solution", create(SOLUTIONS, run.solution))
        | parameters("material", create(MATERIALS, run.material)),
    )


def last_lines(log: Path, ended: Ended) -> tuple[str, ...]:
    """Last lines that the program printed, those on its error output last."""
    said = log.read_bytes()[-4 * LINES * WIDTH :].decode("utf-8", "replace") if log.exists() else ""
    lines = [line.strip()[:WIDTH] for line in f"{said}\n{ended.said}".splitlines() if line.strip()]
    return tuple(lines[-LINES:])
