"""Power and safety of the order rule in words: names of sequences, what is promised, what no rule can tell."""

import re
from collections.abc import Sequence

from mpm_verify.cases.judging.known import CELLS
from mpm_verify.cases.judging.power import SAFE, SOUND, Promise, Row, Standing, floors, interval
from mpm_verify.reports import words

RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
KINDS = {"bad_passes": "worst bad passes", "sound_fails": "worst sound fails", "clean_passes": "clean passes"}
KEPT = {Standing.SHOWN: "yes", Standing.OPEN: "not shown", Standing.BROKEN: "NO"}
ANSWERS = {Standing.SHOWN: "kept", Standing.OPEN: "not shown to be kept, nor broken", Standing.BROKEN: "not kept"}
HEAD = ("levels", "rate", "sequence", "scatter", "%", "95 % interval", "wanted", "kept")


def name(sequence: str) -> str:
    """Formula as people write it: `h² + 40 h⁴`."""
    raised = re.sub(r"\^(\d)(?!\.)", lambda match: match[1].translate(RAISED) * (match[1] != "1"), sequence)
    return raised.replace("1e-", "1e\N{MINUS SIGN}").replace("%", " %").replace(" - ", " \N{MINUS SIGN} ")


def scatter(fraction: float) -> str:
    """Scatter as per cent: `3 %`."""
    return words.percent(fraction, 0)


def levels(key: str) -> str:
    """Name of levels with their cells."""
    return f"{key}, {', '.join(map(str, CELLS[key]))} cells"


def right(row: Row) -> str:
    """Right answer in a word."""
    return "sound" if row.sound else "bad"


def rates(row: Row) -> str:
    """Percentages of PASS, FAIL and INCONCLUSIVE: `74 / 0 / 26`."""
    return " / ".join(f"{100 * count / row.draws:.0f}" for count in (row.passed, row.failed, row.left))


def promise(one: Promise) -> tuple[str, ...]:
    """Cells of a promise, see HEAD."""
    row = one.row
    low, high = interval(one.count, row.draws)
    bound = f"{'≥' if one.kind == 'clean_passes' else '≤'} {100 * one.limit:.0f}"
    return (row.levels, KINDS[one.kind], name(row.sequence), scatter(row.scatter), f"{100 * one.count / row.draws:.1f}",
            f"{100 * low:.1f} to {100 * high:.1f}", bound, KEPT[one.standing])  # fmt: skip


def sentence(one: Promise) -> str:
    """Promise in a sentence, for JSON and for others who quote it."""
    levels, what, sequence, fraction, rate, ends, bound, _ = promise(one)
    told = f"{levels}: {what}, {sequence} with {fraction} scatter, in {rate} % of draws"
    return f"{told} (95 % interval {ends}), {bound} % wanted: {ANSWERS[one.standing]}"


def hidden(rows: Sequence[Row]) -> list[str]:
    """Sentences on sequences that no rule can tell from another, on which it is right as often."""
    found = []
    for one, least in floors(rows).items():
        if least > (SOUND if one.sound else SAFE):
            what = f"{name(one.sequence)} {'fails' if one.sound else 'passes'} {words.percent(one.wrong / one.draws)}"
            found.append(
                f"{one.levels}, {scatter(one.scatter)} scatter: {what}, by any rule at least {words.percent(least)}"
            )
    return found
