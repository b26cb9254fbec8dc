"""A progress bar with the time left, on standard error, silent when that is not a terminal."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from cases.study import Result, Run


@contextmanager
def progress(waiting: Sequence[Run], cost: Callable[[Run], float]) -> Iterator[Callable[[Result], None]]:
    """Yields what is to be told of each finished run; the bar grows with what the runs cost, not with their number."""
    if not waiting or not sys.stderr.isatty():
        yield lambda result: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.percentage:>3.0f} %"),
        BarColumn(),
        TextColumn("{task.fields[runs]}/" + str(len(waiting)) + " runs"),
        TimeRemainingColumn(elapsed_when_finished=True),
        TextColumn("{task.fields[last]}"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=sum(map(cost, waiting)), runs=0, last="")
        finished = 0

        def done(result: Result) -> None:
            nonlocal finished
            finished += 1
            run = result.run
            last = f"{run.method} {run.cells}² cells, {run.ppc} per cell: {result.failure or 'finished'}"
            bar.update(task, advance=cost(run), runs=finished, last=last)

        yield done
