"""Words of the speed of methods: on which processor, and what the numbers are."""

from collections.abc import Mapping, Sequence
from inspect import getdoc
from typing import Any

from mpm_verify.cases.bench import case
from mpm_verify.reports.words import paragraphs

NOTES = (
    "Nodes: support nodes of a particle; ns: processor time of one particle in one step, on one thread, the median of "
    "all turns; million/s: such updates in a second. The time over another method is the median of the ratio within a "
    "turn, with its quartiles. Threads: their speed over that of one, by the clock; other work on the machine takes "
    "more from several than from one."
)
CAPTION = "Time of a step over that of the other method, with quartiles."


def statement(runs: Sequence[case.Run]) -> list[str]:
    """Statement of what is timed, which is the docstring of the case, and the sizes that these runs have."""
    sizes = dict.fromkeys((run.cells, run.ppc) for run in runs)
    here = ", ".join(f"{cells} cells along a side with {ppc} per cell" for cells, ppc in sizes)
    return [*paragraphs(getdoc(case) or ""), f"Here: {here}."]


def measured_on(rows: Sequence[Mapping[str, Any]]) -> str:
    """Processors that the numbers hold for."""
    named = ", ".join(dict.fromkeys(str(row["processor"]) for row in rows))
    return f"Measured on: {named}." if named else ""
