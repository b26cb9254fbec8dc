"""The verdicts in words: one card a judged quantity, and what the whole study comes to."""

from collections import Counter
from dataclasses import dataclass
from math import log

from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.order import Outcome
from mpm_verify.reports.components import audited, words
from mpm_verify.reports.components.stalls import short
from mpm_verify.reports.frames import Record
from mpm_verify.solver.plugins import on_screen

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
    """What one card says. `outcome` picks word, shape and colour; `facts` are (label, text)."""

    outcome: str
    title: str
    headline: str
    facts: tuple[tuple[str, str], ...]
    reason: str
    plain: str
    stall: str
    unseen: str
    seen: tuple[str, ...]


def cards(record: Record) -> list[Card]:
    """The cards of the judged quantities in the order of their declaration."""
    return [_card(record, found) for found in record.findings if found.plan.judged]


def summary(record: Record) -> str:
    """`4 of 5 judged quantities PASS, 1 is INCONCLUSIVE.`"""
    counts = Counter(str(f.verdict.outcome) for f in record.findings if f.plan.judged)
    total = counts.total()
    if not total:
        return "This study judges nothing: it only shows."
    others = [f"{counts[word]} {word}" for word in words.MEANING if word != "PASS" and counts[word]]
    passed = f"{counts['PASS']} of {words.count(total, 'judged quantity').replace('quantitys', 'quantities')} PASS"
    return ", ".join([passed, *others]) + "."


def _card(record: Record, found: Finding) -> Card:
    """One finding in words."""
    d, v, e = found.plan, found.verdict, found.plan.expectation
    diverges = e is not None and e.order is None
    title = f"{words.series(d)}: {words.quantity(d.quantity)} in {d.norm}"
    if len(record.solutions) > 1:
        title += f", {on_screen(d.solution)}"
    facts = (
        ("Observed order", words.order(v.observed)),
        ("Interval", words.interval(v.interval)),
        ("Expected", words.expected(d)),
        ("Expectation from", (e.source if e else "") or "not given"),
    )
    falls = diverges and e is not None and e.stall is not None
    headline = (STALLS if falls else DIVERGES if diverges else PLAIN)[v.outcome]
    plain = divergence(record, found) if diverges and not falls and v.outcome is Outcome.PASS else ""
    return Card(
        str(v.outcome),
        title,
        headline,
        facts,
        _sentence(v.reason),
        plain,
        short(found),
        audited.short(record, d.solution),
        tuple(spot.sentence for spot in audited.seen(record, d.solution)),
    )


def divergence(record: Record, found: Finding) -> str:
    """Divergence said plainly, with the growth of rms against the fall of printed where both were measured."""
    d = found.plan
    series = record.series_of(d)
    name = "Classical MPM" if d.method == "mpm" else words.method(d.method)
    claim = f"{name} diverges here with refinement"
    true, printed = record.errors(series, d.quantity, "rms"), record.errors(series, d.quantity, "printed")
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


def _sentence(reason: str) -> str:
    """A capital letter in front, a full stop behind."""
    reason = words.prose(reason)
    return f"{reason[:1].upper()}{reason[1:]}." if reason and not reason.endswith(".") else reason
