"""Progress bar with the time left, on standard error, silent when that is not a terminal."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from mpm_verify.cases.harness.checkpoint import News, Note
from mpm_verify.cases.harness.runner import Result, Run
from mpm_verify.reports.sentences.checkpoints import note


class Silent:
    """Listener that prints what a run has to tell, and nothing else."""

    def hear(self, news: Sequence[News]) -> None:
        """Hear of runs under way: digests, each with the fraction that is done, or with a note."""
        for digest, told in news:
            if isinstance(told, Note):
                say(note(told))
            else:
                self.move(digest, told)

    def move(self, digest: str, fraction: float) -> None:
        """Hear what fraction of a run is done."""

    def done(self, result: Result) -> None:
        """Hear that a run has ended."""


class Bar(Silent):
    """Bar that grows with what the runs cost, not with their number."""

    def __init__(self, bar: Any, waiting: Sequence[Run], cost: Callable[[Run], float]) -> None:
        self.bar, self.costs, self.fractions = bar, {run.digest: cost(run) for run in waiting}, dict[str, float]()
        self.task = bar.add_task("", total=sum(self.costs.values()), runs=0, of=len(waiting), last="")
        self.finished = 0

    def move(self, digest: str, fraction: float) -> None:
        """Move the bar."""
        self.fractions[digest] = fraction
        self.bar.update(self.task, completed=sum(self.costs[digest] * part for digest, part in self.fractions.items()))

    def done(self, result: Result) -> None:
        """Name the run that has ended."""
        self.finished += 1
        last = f"{result.run}: {result.status}"
        self.bar.update(self.task, runs=self.finished, last=last)
        self.move(result.digest, 1.0)


def say(line: str) -> None:
    """Print a line on standard error, if there is one and anybody reads it."""
    if line and sys.stderr is not None:
        with suppress(OSError, ValueError):
            print(f"verify: {line}", file=sys.stderr, flush=True)


@contextmanager
def progress(waiting: Sequence[Run], cost: Callable[[Run], float]) -> Iterator[Silent]:
    """Bar on a terminal, and Silent elsewhere or where nothing is to be done."""
    if not waiting or sys.stderr is None or not sys.stderr.isatty():
        yield Silent()
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.percentage:>3.0f} %"),
        BarColumn(bar_width=24),
        TimeRemainingColumn(),
        TextColumn("left, {task.fields[runs]} of {task.fields[of]} runs  {task.fields[last]}"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        yield Bar(bar, waiting, cost)
