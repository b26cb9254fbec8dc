"""Words of benchmarks: the statement of a problem, which is the docstring of its file, and failing controls."""

from inspect import getdoc, getmodule

from mpm_verify.cases.benchmark.case import part
from mpm_verify.cases.benchmark.problem import Problem
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.reports.frames import Record
from mpm_verify.reports.words import paragraphs


def statement(problem: Problem) -> list[str]:
    """Statement of a problem: its paragraphs and formulas, and where it is published."""
    texts = paragraphs(getdoc(getmodule(type(problem))) or "")
    return [*texts, *([f"Source: {problem.source}."] if problem.source else [])]


def control(record: Record) -> str:
    """Sentence on failing controls: each has to be refused, and one that passes is an alarm; empty without any."""
    names = dict.fromkeys(part(run) for run in record.study.runs if getattr(run, "control", False))
    found: dict[str, list[Outcome]] = {name: [] for name in names}
    judged = [(part(one.plan.run), one.verdict.outcome) for one in record.findings if one.counts] if names else []
    for name, outcome in [*judged, *((one.group, one.outcome) for one in record.analysis.checks)]:
        if name in found:
            found[name].append(outcome)
    passed = [name for name, outcomes in found.items() if set(outcomes) == {Outcome.PASS}]
    if passed:
        return f"ALARM: a control that must fail passed, so nothing sees its mistake: {'; '.join(passed)}."
    if undecided := [name for name, outcomes in found.items() if Outcome.FAIL not in outcomes]:
        return f"A control that must fail is undecided, or ended in an error: {'; '.join(undecided)}."
    every = [outcome for outcomes in found.values() for outcome in outcomes]
    refused = f"{every.count(Outcome.FAIL)} of {len(every)} refused"
    return f"The failing control failed, as it must: {refused}." if every else ""
