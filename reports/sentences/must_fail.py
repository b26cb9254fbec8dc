"""Sentence on failing controls: each has to be refused, and one that passes is an alarm."""

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from importlib.util import find_spec

from mpm_verify.cases.judging.records import Outcome
from mpm_verify.reports.frames import Record
from mpm_verify.solver.plugins import CASES, available


def of_case(record: Record) -> str:
    """Sentence on the failing controls of a study: `control` of the words of its case; empty where that has none."""
    case = record.study.case
    if case not in available(CASES) or not find_spec(words := f"{__package__}.{case}"):
        return ""
    control: Callable[[Record], str] = getattr(import_module(words), "control", lambda record: "")
    return control(record)


def said(found: Mapping[str, Sequence[Outcome]]) -> str:
    """Sentence on controls by name, each with the outcomes of all that has to see its mistake; empty without any."""
    if passed := [name for name, outcomes in found.items() if set(outcomes) == {Outcome.PASS}]:
        return f"ALARM: a control that must fail passed, so nothing sees its mistake: {'; '.join(passed)}."
    if undecided := [name for name, outcomes in found.items() if Outcome.FAIL not in outcomes]:
        return f"A control that must fail is undecided, or ended in an error: {'; '.join(undecided)}."
    every = [outcome for outcomes in found.values() for outcome in outcomes]
    refused = f"{every.count(Outcome.FAIL)} of {len(every)} refused"
    return f"The failing control failed, as it must: {refused}." if every else ""
