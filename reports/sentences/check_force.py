"""Sentences on the check of exported sources."""

from mpm_verify.mms.export.checking import Checked, Outcome
from mpm_verify.mms.export.process import Ended


def sentence(checked: Checked) -> str:
    """Line on the outcome of one language."""
    c = checked
    if c.outcome is Outcome.AGREES:
        return f"agrees in {c.rows} rows; the largest error is {c.worst:.2g} of its tolerance, in {c.column}"
    if c.outcome is Outcome.DISAGREES:
        largest = f"the largest error is {c.worst:.2g} times its tolerance, in {c.column}"
        return f"DISAGREES in {c.failed} of {c.rows} rows; {largest}"
    if c.outcome is Outcome.NO_COMPILER:
        return f"not checked: there is no {c.program} on this machine"
    if c.outcome is Outcome.NOT_COMPILED:
        return f"DISAGREES: it does not compile: {ending(c.ended)}"
    if c.outcome is Outcome.NOT_RUN:
        return f"DISAGREES: the program that calls it does not run: {ending(c.ended)}"
    return "DISAGREES: what the program that calls it prints is not the table that it should be"


def ending(ended: Ended | None) -> str:
    """End of a program in words, with the first line of its error output that names an error."""
    if ended is None or ended.code is None:
        return "its time was up"
    lines = [line.strip() for line in ended.said.splitlines() if line.strip()]
    named = [line for line in lines if "error" in line.lower()]
    return f"exit code {ended.code}" + (f": {(named or lines)[0][:200]}" if lines else "")
