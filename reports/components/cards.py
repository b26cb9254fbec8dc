"""Verdicts in words: one card a judged quantity, and what the whole study comes to."""

from collections import Counter
from dataclasses import dataclass
from math import log

from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.order import Outcome
from mpm_verify.reports import words
from mpm_verify.reports.components import audited
from mpm_verify.reports.components.badges import MET
from mpm_verify.reports.components.stalls import short
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import commands, verdicts
from mpm_verify.reports.sentences import headline as headlines

DIVERGES = {
    Outcome.PASS: "Does not converge, as registered before the run",
    Outcome.INCONCLUSIVE: "Not decided",
    Outcome.ERROR: "Nothing to judge",
    Outcome.FAIL: "Converges, and that was not expected",
}
STALLS = {**DIVERGES, Outcome.PASS: "Its order falls with refinement, as registered before the run"}
PLAIN = {
    Outcome.PASS: "Converges as expected",
    Outcome.FAIL: "Does not converge as expected",
    Outcome.INCONCLUSIVE: "Not decided",
    Outcome.ERROR: "Nothing to judge",
}


@dataclass(frozen=True)
class Card:
    """Content of one card. `look` picks shape and colour; `facts` are (label, text); `command` would decide."""

    outcome: str
    badge: str
    look: str
    title: str
    headline: str
    facts: tuple[tuple[str, str], ...]
    reason: str
    command: str
    plain: str
    stall: str
    unseen: str
    seen: tuple[str, ...]
    finished: bool = True  # whether a level did: what a solution cannot see matters only then
    source: str = ""
    number: int = 0  # from 1 on
    solution: str = ""


def cards(record: Record) -> list[Card]:
    """Cards of the judged quantities in the order of the plans."""
    counted = [found for found in record.findings if found.counts]
    return [_card(record, found, number) for number, found in enumerate(counted, 1)]


def summary(record: Record) -> str:
    """Summary such as `4 of 5 judged quantities PASS, 1 INCONCLUSIVE`."""
    counts = Counter(str(f.verdict.outcome) for f in record.findings if f.counts)
    total = counts.total()
    if not total:
        return "This study judges nothing: it only shows."
    others = [f"{counts[word]} {word}" for word in words.MEANING if word != "PASS" and counts[word]]
    passed = f"{counts['PASS']} of {words.count(total, 'judged quantity').replace('quantitys', 'quantities')} PASS"
    met = sum(headlines.badge(f) != f.verdict.outcome for f in record.findings if f.counts)
    registered = [f"{met} of them as a registered non-convergence"] if met else []
    return ", ".join([passed, *registered, *others]) + "."


def _card(record: Record, found: Finding, number: int) -> Card:
    """Card of one finding."""
    plan, v, e = found.plan, found.verdict, found.plan.expectation
    diverges = e is not None and e.order is None
    title = f"{record.label(plan.run)}: {words.quantity(plan.quantity)} in {plan.norm}"
    facts = (
        ("Observed order", words.order(v.observed)),
        ("Interval", words.interval(v.interval)),
        ("Expected", verdicts.registered(e)),
    )
    falls = diverges and e is not None and e.stall is not None
    headline = (STALLS if falls else DIVERGES if diverges else PLAIN)[v.outcome]
    grows = divergence(record, found) if diverges and not falls and v.outcome is Outcome.PASS else ""
    badge = headlines.badge(found)
    finished = not all(each.ended for each in found.levels)
    return Card(
        str(v.outcome),
        badge,
        str(v.outcome) if badge == v.outcome else MET,
        title,
        headline,
        facts,
        words.sentence(verdicts.said(v.reason)),
        commands.command(record.study, found, record.store.folder),
        grows,
        short(found),
        audited.short(record, plan.run.solution) if finished else "",
        tuple(audited.seen(record, plan.run.solution)) if finished else (),
        finished,
        (e.source if e else "") or "",
        number,
        getattr(plan.run, "solution", ""),
    )


def divergence(record: Record, found: Finding) -> str:
    """Sentence on divergence, with the growth of rms against the fall of printed where both were measured."""
    plan = found.plan
    series = record.series_of(plan)
    name = "Classical MPM" if plan.run.method == "mpm" else words.method(plan.run.method)
    claim = f"{name} diverges here with refinement"
    true, printed = record.errors(series, plan.quantity, "rms"), record.errors(series, plan.quantity, "printed")
    if len(true) < 2 or len(printed) < 2:
        return f"{claim}: {len(true)} of {words.count(len(series.runs), 'cell size')} could be finished."
    (first, high), (last, low) = printed[0], printed[-1]
    growth, fall = true[-1][1] / true[0][1], high / low
    span = f"from {words.cell_size(first.cells)} to {words.cell_size(last.cells)}"
    if growth <= 1 or fall <= 1:
        return f"{claim}: {span} its error in rms changes {growth:.1f}-fold."
    seeming = words.order(log(fall) / log(last.cells / first.cells))
    text = (
        f"{claim}, while the paper's printed norm shows it converging: {span} the error in rms grows {growth:.1f}-fold"
    )
    text += f" ({words.sci(true[0][1])} to {words.sci(true[-1][1])}), and printed falls {fall:.1f}-fold"
    return f"{text} ({words.sci(high)} to {words.sci(low)}), a seeming order of {seeming}."
