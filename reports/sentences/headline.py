"""Finding of a study in one line, such as `CPDI converges at order 2.01; MPM diverges`."""

from collections.abc import Sequence

from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.records import Expectation, Outcome
from mpm_verify.reports import words
from mpm_verify.reports.frames import Record
from mpm_verify.solver.plugins import label

VERBS = {  # of one method and of several, in the order in which they are told
    "wrong": ("does not converge as expected", "do not converge as expected"),
    "surprise": ("converges, which was not expected", "converge, which was not expected"),
    "nothing": ("has nothing to judge", "have nothing to judge"),
    "open": ("is not decided", "are not decided"),
    "converges": ("converges", "converge"),
    "diverges": ("diverges", "diverge"),
    "stalls": ("stalls", "stall"),
    "fails": ("fails", "fail"),
}
APART = ("solution", "ppc", "measured")  # fields that may tell apart where one method does this and where that
WITH = {"solution": "on {}", "ppc": "with {} per cell", "measured": "in {}"}

EARLIER = "Computed by other source code than is installed."


def met(e: Expectation | None) -> str:
    """Non-convergence that is registered: `diverges`, `stalls` or `fails`; empty where an order is."""
    if e is None or e.order is not None:
        return ""
    return "fails" if e.failed else e.kind


def badge(finding: Finding) -> str:
    """Outcome, or `diverges, as registered` where that was expected."""
    kind = met(finding.plan.expectation) if finding.verdict.outcome is Outcome.PASS else ""
    return f"{kind}, as registered" if kind else str(finding.verdict.outcome)


def headline(record: Record) -> str:
    """Sentence on what the judged methods do; empty where nothing is judged."""
    told: dict[str, list[Finding]] = {verb: [] for verb in VERBS}
    for finding in record.findings:
        if finding.counts:
            told[_verb(finding)].append(finding)
    clauses = [_clause(verb, found, told) for verb, found in told.items() if found]
    return f"{'; '.join(clauses)}." if clauses else ""


def passed(checks: Sequence[Check]) -> str:
    """Sentence on how many checks pass; empty without any."""
    count = sum(check.outcome is Outcome.PASS for check in checks)
    verb = "passes" if len(checks) == 1 else "pass"
    return f"{count} of {words.count(len(checks), 'check')} {verb}." if checks else ""


def _verb(finding: Finding) -> str:
    """Key of VERBS."""
    kind = met(finding.plan.expectation)
    outcome = finding.verdict.outcome
    if outcome is Outcome.PASS:
        return kind or "converges"
    if outcome is Outcome.FAIL:
        return "surprise" if kind else "wrong"
    return "nothing" if outcome is Outcome.ERROR else "open"


def _clause(verb: str, found: Sequence[Finding], told: dict[str, list[Finding]]) -> str:
    """Methods that do one thing."""
    methods = list(dict.fromkeys(_method(f) for f in found))
    names = [" ".join(filter(None, [words.method(name), _where(name, verb, told)])) for name in methods]
    listed = " and ".join(filter(None, [", ".join(names[:-1]), names[-1]]))
    return f"{listed} {VERBS[verb][len(methods) > 1]}{_orders(found) if verb == 'converges' else ''}"


def _method(finding: Finding) -> str:
    return str(getattr(finding.plan.run, "method", ""))


def _where(method: str, verb: str, told: dict[str, list[Finding]]) -> str:
    """Phrase on where a method does this, if it does something else elsewhere."""
    mine = [f for f in told[verb] if _method(f) == method]
    others = [f for key, found in told.items() if key != verb for f in found if _method(f) == method]
    for field in APART:
        here, there = ({str(getattr(f.plan.run, field, "")) for f in some} for some in (mine, others))
        if others and not here & there:
            return WITH[field].format(", ".join(label(value) for value in sorted(here)))
    quantities = {f.plan.quantity for f in mine}
    return (
        f"in {', '.join(sorted(quantities))}" if others and not quantities & {f.plan.quantity for f in others} else ""
    )


def _orders(found: Sequence[Finding]) -> str:
    """Orders that were observed, the lowest and the highest."""
    orders = sorted(f.verdict.observed for f in found if f.verdict.observed is not None)
    ends = list(dict.fromkeys(words.order(order) for order in orders[:1] + orders[-1:]))
    return f" at order {' to '.join(ends)}" if ends else ""
