"""Words of benchmarks: the statement of a problem, which is the docstring of its file, and failing controls."""

from inspect import getdoc, getmodule

from mpm_verify.cases.benchmark.case import part
from mpm_verify.cases.benchmark.problem import Problem
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import must_fail
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
    return must_fail.said(found)
