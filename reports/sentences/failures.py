"""Failures in words: what ended a run, where and when, and what a program had printed."""

import signal
from dataclasses import replace

from mpm_verify.solver.failure import Failure, FailureKind

CAUSES = {
    FailureKind.INVERTED: "det F ≤ 0",
    FailureKind.DOMAIN_INVERTED: "the particle's domain is inverted",
    FailureKind.OUTSIDE_GRID: "the particle or a part of its domain left the grid",
    FailureKind.DOMAIN_TOO_WIDE: "the particle's domain is too wide for its method",
    FailureKind.NO_WIDTH: "the particle's domain has no width",
    FailureKind.SLAB: "a particle domain is as wide as the grid",
    FailureKind.NOT_FINITE: "a value that is not finite",
    FailureKind.ERROR_NOT_FINITE: "an error that is not finite",
    FailureKind.UNSTABLE_STEP: "the time step is above the stability limit",
    FailureKind.EMPTY_CELL: "no particle in a cell that the body fills",
    FailureKind.TIME_LIMIT: "the solver took longer than it may",
    FailureKind.SOLVER_ERROR: "the solver ended with an error",
    FailureKind.NO_ANSWER: "the solver has not written a file",
    FailureKind.UNREADABLE: "the solver has written a file that cannot be read",
    FailureKind.NO_COLUMN: "the solver has left out a column",
    FailureKind.OTHER_PARTICLES: "the solver has written other particles than it was given",
    FailureKind.WORKER_DIED: "the worker died each time, for want of memory perhaps",
    FailureKind.NOT_RUN: "not run yet",
    FailureKind.OSCILLATES: "the values go to and fro",
    FailureKind.NO_ERROR: "no error",
}
WHY = {  # of a file that cannot be read
    "empty": "it is empty",
    "no_text": "it is no text in UTF-8",
    "ragged": "a row has more values than the first line has names",
    "word": "{word} in column {column} is not a number",
    "json": "it is no JSON, line {line:g}",
    "no_object": 'it is not of the form {{"v_lag": 0.5}}',
    "lag": "{column} is not a number from -{farthest:g} to {farthest:g}",
    "b": "b is neither start nor end",
}
WIDTHS = {1.0: "a cell", 2.0: "two cells"}


def kind(kind: FailureKind) -> str:
    """Kind of failure in words: `det F ≤ 0`."""
    return CAUSES[kind]


def cause(failure: Failure) -> str:
    """Kind with its numbers: `dt = 0.5 is above the stability limit 0.2`."""
    n = failure.numbers
    if failure.kind is FailureKind.UNSTABLE_STEP and n:
        return f"dt = {n['dt']:.3g} is above the stability limit {n['limit']:.3g}"
    if failure.kind is FailureKind.DOMAIN_TOO_WIDE and n:
        limit = WIDTHS.get(n["limit"], f"{n['limit']:g} cells")
        return f"the particle's domain is wider than {limit}"
    if failure.kind is FailureKind.TIME_LIMIT and n:
        return f"the solver took longer than {n['seconds']:g} s"
    if failure.kind is FailureKind.WORKER_DIED and n:
        return f"{n['times']:g} workers died in it, for want of memory perhaps"
    return theirs(failure) or kind(failure.kind)


def theirs(failure: Failure) -> str:
    """Failure of a solver of somebody else, with what the file lacks; empty of any other."""
    n, file, k = failure.numbers, failure.names.get("file", ""), failure.kind
    if k is FailureKind.SOLVER_ERROR and n:
        said = f": {failure.names['said']}" if "said" in failure.names else ""
        limit = f" under a limit of {n['memory']:g} MB of memory" if "memory" in n else ""
        return f"the solver ended with {code(int(n['code']))}{limit}{said}"
    if not file:
        return ""
    if k is FailureKind.NO_ANSWER:
        return f"the solver has not written {file}"
    if k is FailureKind.UNREADABLE:
        why = WHY.get(failure.names.get("why", ""), "").format(**failure.names, **n)
        return f"{file} cannot be read{': ' * bool(why)}{why}"
    if k is FailureKind.NOT_FINITE:
        if "value" in n:
            return f"a value of {n['value']:.0e} in {file}, too large for an error of it"
        return f"a value that is not finite in {file}"
    if k is FailureKind.NO_COLUMN:
        return f"{file} has no column {failure.names['column']}"
    if k is FailureKind.OTHER_PARTICLES:
        return f"{file} has {n['found']:g} of the {n['expected']:g} particles that were given{ids(n)}"
    return ""


def ids(n: dict[str, float]) -> str:
    """Reason by an id, `: id 3 is there twice`; empty where none is told."""
    if "twice" in n:
        return f": id {n['twice']:g} is there twice"
    return f": id {n['other']:g} is none of 0 to {n['expected'] - 1:g}" if "other" in n else ""


def code(number: int) -> str:
    """Exit code or signal: `exit code 3`, `signal 11 (Segmentation fault)`."""
    if number >= 0:
        return f"exit code {number}"
    known = signal.strsignal(-number) if -number in signal.valid_signals() else None
    return f"signal {-number}{f' ({known})' if known else ''}"


def logged(run: str, ended: Failure, lines: int, file: str, others: int = 0) -> str:
    """Sentence on the log of a failed run: which one, why, how many ended alike, and where all of it is kept."""
    alike = f" ({others} other run{'s' * (others > 1)} ended alike)" if others else ""
    quiet = replace(ended, names={name: told for name, told in ended.names.items() if name != "said"})  # it follows
    return f"{run}: {failure(quiet)}{alike}; {printed(ended, lines, file)}"


def printed(ended: Failure, lines: int, file: str) -> str:
    """Introduction of the last lines of a log, or that there are none."""
    if lines:
        kept = f", all of it in {file}" if file else ""
        return f"{f'the last {lines} lines' if lines > 1 else 'the last line'} that it printed{kept}:"
    late = ", and what it still held back is not seen: let it write at once (python -u, fflush)"
    return f"it printed nothing{late if ended.kind is FailureKind.TIME_LIMIT else ''}."


def more_logs(number: int) -> str:
    """Sentence on logs that are not printed; empty where there are none."""
    return f"{number} other log{'s' * (number > 1)} of failed runs: on the page, and in --json." if number > 0 else ""


def failure(failure: Failure) -> str:
    """Cause, then step, particle and cell: `det F ≤ 0 at step 21, particle 35 in cell (2, 2)`."""
    when = f" at step {failure.step}" if failure.step >= 0 else ""
    where = f", particle {failure.particle}" if failure.particle >= 0 else ""
    where += f" in cell {failure.cell}" if failure.cell else ""
    return f"{cause(failure)}{when}{where}"


def replicate(number: int) -> str:
    """Number of the run of a level; empty for the one at the usual positions."""
    return f", replicate {number + 1}" if number else ""


def check(name: str, failure: Failure | None) -> str:
    """Name of a check, with what ended the run that was to give its number."""
    when = f" at step {failure.step}" if failure and failure.step >= 0 else ""
    return f"{name}: {cause(failure)}{when}" if failure else name
