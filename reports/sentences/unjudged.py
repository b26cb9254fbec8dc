"""Words for numbers that are shown and not judged: why nothing can be held, and what to run instead."""

from mpm_verify.cases.harness.checks import Check, Unjudged

SAID: dict[Unjudged, str] = {
    "": "",
    "few_grids": "not judged: a limit takes three grids; add them to --cells, such as 8,16,32",
    "not_usual": "not judged: how near it comes was measured at the usual parameters",
    "not_at_rest": "not judged: the run ended before it was at rest",
    "one_thread": "not judged: one thread ran alone; give --parallel 2, on a machine of two cores or more",
}


def source(check: Check) -> str:
    """Source of what a number is held against, and why it is not, if so."""
    return "; ".join(filter(None, [check.source, SAID[check.unjudged]]))
