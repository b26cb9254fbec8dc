"""Study in a few lines of Markdown, for the summary of a CI job."""

from mpm_verify.reports import words
from mpm_verify.reports.components.logs import failed
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import commands, controls, must_fail, own_solver, verdicts
from mpm_verify.reports.sentences.headline import badge, headline, passed
from mpm_verify.reports.tables.markdown import escaped, row

MARKS = {"PASS": "✅", "FAIL": "❌", "INCONCLUSIVE": "❔", "ERROR": "⚠️"}
MET = "🔷"  # a registered non-convergence that was seen


def markdown(record: Record) -> str:
    """Heading with the outcome, a row for each judged quantity and for each check that did not pass."""
    study, found = record.study, record.analysis
    lines = [f"### {MARKS[found.outcome]} {found.outcome}: {escaped(study.title)}", "", f"`{study.command}`", ""]
    if finding := headline(record):
        lines += [finding, ""]
    judged = [f for f in found.findings if f.counts]
    if judged:
        lines += ["| | refinement | quantity | order | expected | reason |", "| --- | --- | --- | --- | --- | --- |"]
        for f in judged:
            plan, v = f.plan, f.verdict
            said = badge(f)
            mark = MARKS[v.outcome] if said == v.outcome else MET
            cells = (f"{mark} {said}", record.label(plan.run), words.measured(plan),
                     words.order(v.observed), verdicts.registered(plan.expectation),
                     commands.reason(study, f))  # fmt: skip
            lines.append(row(cells))
    if spoilt := must_fail.of_case(record):
        lines += ["", spoilt]
    if told := controls.sentence(found.controls):
        lines += ["", told]
    lines += [f"- {escaped(hint)}" for hint in own_solver.hints(record.results.values())]
    for log in failed(record):
        lines += [f"- {escaped(log.sentence)}", "", *(f"      {line}" for line in log.lines), ""]
    if found.checks:
        missed = [check for check in found.checks if check.outcome != "PASS"]
        lines += ["", passed(found.checks)]
        lines += [f"- {MARKS[check.outcome]} {escaped(f'{check.group}: {check.name}')}" for check in missed]
    return "\n".join(lines) + "\n"
