"""Findings as badges: each judged quantity and each part of the checks in a few words, what did not pass first."""

from collections.abc import Sequence
from dataclasses import dataclass

from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.judging.records import Outcome, worst
from mpm_verify.reports import words
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.headline import badge

MET = "MET"  # look of a registered non-convergence that was seen: not that of a convergence
MOST = 12  # badges of a page; more that pass are counted


@dataclass(frozen=True)
class Badge:
    """Badge: `look` picks shape and colour, `badge` stands before the text, `goal` is what it leads to."""

    look: str
    badge: str
    text: str
    goal: str = ""


def of_findings(record: Record, goal: str = "") -> list[Badge]:
    """Badges of the judged quantities, that lead to their cards, or to `goal`."""
    counted = [finding for finding in record.findings if finding.counts]
    several = len({(f.plan.quantity, f.plan.norm) for f in counted}) > 1
    found = []
    for number, f in enumerate(counted, 1):
        said, observed = badge(f), f.verdict.observed
        look = str(f.verdict.outcome) if said == f.verdict.outcome else MET
        measured = f", {words.measured(f.plan)}" if several else ""
        order = "" if observed is None else f": order {words.order(observed)}"
        text = f"{record.label(f.plan.run)}{measured}{order}"
        found.append(Badge(look, said, text, goal or f"finding-{number}"))
    return found


def of_checks(checks: Sequence[Check]) -> list[Badge]:
    """Badges of the parts of the checks, each with how many pass."""
    found = []
    for group in dict.fromkeys(check.group for check in checks):
        mine = [check.outcome for check in checks if check.group == group]
        end = worst(mine)
        goal = "" if end is Outcome.PASS else "missed"
        found.append(Badge(str(end), f"{mine.count(Outcome.PASS)} of {len(mine)}", group, goal))
    return found


def shortened(found: Sequence[Badge], most: int = MOST) -> list[Badge]:
    """Badges of a page: all where they are few, else those that do not pass, and of the others how many."""
    passed = [one for one in found if one.look == "PASS"]
    others = [one for one in found if one.look != "PASS"]
    if len(found) <= most:
        return [*others, *passed]
    shown = others[:most] + passed[: max(0, most - len(others))]
    left = [(look, sum(one.look == look for one in found) - sum(one.look == look for one in shown))
            for look in dict.fromkeys(one.look for one in found)]  # fmt: skip
    return [*shown, *(Badge(look, f"and {count}", "more" if look != "PASS" else "more that pass")
                      for look, count in left if count)]  # fmt: skip
