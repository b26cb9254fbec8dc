"""Question to somebody else's solver: a case folder is written, the program reads it, and its answer is read.

A Python function is asked with arrays instead.
"""

import tempfile
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from mpm_verify.cases.solvers.answer import Frame, around, read
from mpm_verify.cases.solvers.callables import Case, called
from mpm_verify.cases.solvers.column_map import parsed
from mpm_verify.cases.solvers.command import FOLDERS, PYTHON, filled
from mpm_verify.cases.solvers.components import reference
from mpm_verify.cases.solvers.levels import USUAL, Levels, levels
from mpm_verify.cases.solvers.log import EMPTY, Log, logged, of_text
from mpm_verify.cases.solvers.mapped import read as read_mapped
from mpm_verify.mms.export.case import Exported
from mpm_verify.mms.export.files import files
from mpm_verify.mms.export.process import Ended
from mpm_verify.mms.export.process import run as run_program
from mpm_verify.solver.failure import Failure, FailureKind, RunFailed
from mpm_verify.solver.state import Floats

LOG = "log.txt"


class Asking(Protocol):
    """Run that says which solver is asked, and what it may take: a time in s, and memory in MB."""

    @property
    def solver(self) -> str:
        """Command, or the name of a Python function."""

    @property
    def columns(self) -> str:
        """Map of the columns that it writes."""

    @property
    def time_limit(self) -> float:
        """Seconds that it may take."""

    @property
    def memory_limit(self) -> float:
        """Address space that it may have, MB; 0: any."""


@dataclass(frozen=True)
class Answer:
    """Answer of a solver: its frames by step, what it states, and how it ended; no frames where it failed."""

    frames: dict[int, Frame]
    told: Levels
    failure: Failure | None = None
    wall_s: float = 0.0
    log: Log = EMPTY
    exit_code: int | None = None


def ask(
    run: Asking,
    case: Exported,
    force: Callable[[Floats, float], Floats],
    tick: Callable[[float], None] = lambda fraction: None,
) -> Answer:
    """Ask a command or a Python function.

    Parameters
    ----------
    run
        Solver and its limits.
    case
        Content of the case folder.
    force
        Body force per mass (n,d) of reference positions (n,d) and a time, for a Python function.
    tick
        Hears the fraction of the frames that are there.

    Returns
    -------
    Answer
        Frames, or what failed.
    """
    answer = in_process(run, case, force) if run.solver.startswith(PYTHON) else by_command(run, case, tick)
    if not case.record.axisymmetric:
        return answer
    return replace(answer, frames={step: around(frame) for step, frame in answer.frames.items()})


def by_command(run: Asking, case: Exported, tick: Callable[[float], None]) -> Answer:
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
        log = logged((out / LOG, out / f"{LOG}.err"), {str(folder): FOLDERS[0], str(out): FOLDERS[1]})
        try:
            check(ended, run, log)
            told = levels(out, parsed(run.columns).levels if run.columns else USUAL)
            frames = frames_of(run, case, out)
        except RunFailed as error:
            failure = error.failure
        return Answer(frames, told, failure, wall, log, ended.code)


def in_process(run: Asking, case: Exported, force: Callable[[Floats, float], Floats]) -> Answer:
    """Answer of a Python function."""
    failure, frames, told, log = None, dict[int, Frame](), Levels(), EMPTY
    started = time.perf_counter()
    try:
        given = Case(case.record, case.particles, force)
        frames, told = called(run.solver, given, positions(case), spacing(case))
    except RunFailed as error:
        failure = error.failure
        if raised := error.__cause__:
            log = of_text("".join(traceback.format_exception(raised)))
    return Answer(frames, told, failure, time.perf_counter() - started, log)


def positions(case: Exported) -> Floats:
    """Reference positions (P,d) of the particles of a case."""
    return reference(case.particles, case.record.dimension)


def check(ended: Ended, run: Asking, log: Log) -> None:
    """Raise RunFailed for a program that did not end with 0, with its limits and the last line that it printed."""
    names = {"said": log.lines[-1].strip()} if log.lines else {}
    if ended.code is None:
        raise RunFailed(FailureKind.TIME_LIMIT, -1, numbers={"seconds": run.time_limit}, names=names)
    if ended.code != 0:
        limit = {"memory": run.memory_limit} if run.memory_limit else {}
        raise RunFailed(FailureKind.SOLVER_ERROR, -1, numbers={"code": float(ended.code)} | limit, names=names)


def spacing(case: Exported) -> float:
    """Distance of particles at reference, a length."""
    return float(case.record.dx * case.record.ppc ** (-1 / case.record.dimension))


def frames_of(run: Asking, case: Exported, out: Path) -> dict[int, Frame]:
    """Frames that a program has written, by step. Raises RunFailed for what is missing or cannot be read."""
    X, steps = positions(case), case.record.frames
    if run.columns:
        return read_mapped(out, parsed(run.columns), steps, case.record.dt, X, spacing(case))
    return {step: read(out, step, X, spacing(case)) for step in steps}
