"""Sentence on failing controls: each has to be refused, and one that passes is an alarm."""

from collections.abc import Mapping, Sequence

from mpm_verify.cases.judging.records import Outcome


def said(found: Mapping[str, Sequence[Outcome]]) -> str:
    """Sentence on controls by name, each with the outcomes of all that has to see its mistake; empty without any."""
    if passed := [name for name, outcomes in found.items() if set(outcomes) == {Outcome.PASS}]:
        return f"ALARM: a control that must fail passed, so nothing sees its mistake: {'; '.join(passed)}."
    if undecided := [name for name, outcomes in found.items() if Outcome.FAIL not in outcomes]:
        return f"A control that must fail is undecided, or ended in an error: {'; '.join(undecided)}."
    every = [outcome for outcomes in found.values() for outcome in outcomes]
    refused = f"{every.count(Outcome.FAIL)} of {len(every)} refused"
    return f"The failing control failed, as it must: {refused}." if every else ""
