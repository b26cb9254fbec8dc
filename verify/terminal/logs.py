"""Logs of failed runs of somebody else's solver on a terminal: the last lines that each printed."""

from collections.abc import Sequence

from rich.console import Console

from mpm_verify.reports.components.logs import Log
from mpm_verify.reports.sentences import failures

MOST = 3  # logs that are printed; the page has all


def show(out: Console, logs: Sequence[Log]) -> None:
    """Print logs."""
    for log in logs[:MOST]:
        first, *lines = str(log).splitlines()
        out.print(f"\nLOG  {first}", markup=False)
        for line in lines:
            out.print(line, markup=False, soft_wrap=True)
    if more := failures.more_logs(len(logs) - MOST):
        out.print(more, markup=False)
