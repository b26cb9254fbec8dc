"""Failure of a run: a kind with numbers. The words for it are in reports/sentences/failures.py."""

from dataclasses import dataclass, field
from enum import StrEnum


class FailureKind(StrEnum):
    """Kinds of what ended a run, or why there is no error of it; in brackets `numbers` of the Failure, its `names`."""

    INVERTED = "inverted"  # det F is not above zero
    DOMAIN_INVERTED = "domain_inverted"  # a domain with corners of its own is turned inside out
    OUTSIDE_GRID = "outside_grid"  # a particle, or a part of its domain
    DOMAIN_TOO_WIDE = "domain_too_wide"  # for the support nodes of its basis [width, limit, in cells]
    NO_WIDTH = "no_width"  # a domain of no width
    SLAB = "slab"  # a particle domain as wide as the grid
    NOT_FINITE = "not_finite"  # x, v, F or sigma of a particle [value, where it is too large to be squared]
    ERROR_NOT_FINITE = "error_not_finite"  # an error norm
    UNSTABLE_STEP = "unstable_step"  # a wave crosses more than a cell in a step [dt, limit]
    EMPTY_CELL = "empty_cell"  # no particle in a cell that the body fills
    TIME_LIMIT = "time_limit"  # a solver of somebody else took longer than it may [seconds]
    SOLVER_ERROR = "solver_error"  # a solver of somebody else ended with an error [code]
    NO_ANSWER = "no_answer"  # a file that somebody else's solver was to write is not there <file>
    UNREADABLE = "unreadable"  # such a file cannot be read [line, farthest] <file; why: a code; word, column>
    NO_COLUMN = "no_column"  # such a file lacks what every answer has <file, column>
    OTHER_PARTICLES = (
        "other_particles"  # such a file has other particles than were given [found, expected; twice, other: ids] <file>
    )
    WORKER_DIED = "worker_died"  # of a cluster, each time that the run was given to one [times]
    NOT_RUN = "not_run"  # nobody has run it yet
    OSCILLATES = "oscillates"  # no error can be estimated of a value that goes to and fro as cells get finer
    NO_ERROR = "no_error"  # it came to its end, and no error was measured


@dataclass(frozen=True)
class Failure:
    """Reason why a run could not go on: a result, not a crash.

    Parameters
    ----------
    kind
        What happened.
    step
        Steps that were done; -1 where no step has to do with it.
    particle
        Index in the initial layout, -1 if none.
    cell
        Column and row of the particle's cell, None where there is none.
    numbers, names
        What FailureKind tells in brackets.
    """

    kind: FailureKind
    step: int = 0
    particle: int = -1
    cell: tuple[int, int] | None = None
    numbers: dict[str, float] = field(default_factory=dict, hash=False)
    names: dict[str, str] = field(default_factory=dict, hash=False)


class RunFailed(Exception):  # noqa: N818 - a failed run is a result, not an error
    """The run cannot go on; `failure` says why."""

    def __init__(
        self,
        kind: FailureKind,
        step: int = 0,
        particle: int = -1,
        cell: tuple[int, int] | None = None,
        numbers: dict[str, float] | None = None,
        names: dict[str, str] | None = None,
    ) -> None:
        super().__init__(f"{kind} at step {step}, particle {particle}, cell {cell}")
        self.failure = Failure(kind, step, particle, cell, numbers or {}, names or {})
