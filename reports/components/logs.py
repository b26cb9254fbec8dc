"""Logs of runs of somebody else's solver that failed: the last lines, once for all that ended alike."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpm_verify.cases.mms.digits.records import Compared
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import failures

FILE = "log.txt"  # of a comparison, beside its page


@dataclass(frozen=True)
class Log:
    """Log of a failed run: why it failed, where all is that it printed, and its last lines."""

    sentence: str
    lines: tuple[str, ...]

    def __str__(self) -> str:
        """Text of several lines."""
        return "\n".join([self.sentence, *(f"  | {line}" for line in self.lines)])


def failed(record: Record, results: Iterable[Any] | None = None) -> list[Log]:
    """Logs of the runs of a program that failed, or of these, one for all that ended alike; of others there is none."""
    found: dict[tuple[str, tuple[str, ...]], dict[str, Any]] = {}
    for result in record.results.values() if results is None else results:
        if result and result.failure and getattr(result.run, "solver", ""):
            found.setdefault((failures.failure(result.failure), result.log), {})[result.digest] = result
    return [Log(sentence(record, list(alike.values())), lines) for (_, lines), alike in found.items()]


def sentence(record: Record, alike: Sequence[Any]) -> str:
    """Sentence of the log of failed runs that ended alike."""
    first, others = alike[0], len(alike) - 1
    step = f", Courant number {first.run.courant:g}" if hasattr(first.run, "courant") else ""
    file = str(record.store.log(first.digest) or "")
    return failures.logged(f"{first.run}{step}", first.failure, len(first.log), file, others)


def of_comparison(run: Any, found: Compared, folder: Path | None) -> list[Log]:
    """Log of an answer that failed; `folder` has all of it, where a page is drawn."""
    if found.failure is None:
        return []
    file = str(folder / FILE) if folder and found.log.text else ""
    return [Log(failures.logged(str(run), found.failure, len(found.log.lines), file), found.log.lines)]
