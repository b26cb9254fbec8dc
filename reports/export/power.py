"""Power and safety of the order rule as files: a table in CSV, which reads back, and a page in Markdown."""

import csv
from collections.abc import Iterator, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from mpm_verify.cases.judging.known import CELLS
from mpm_verify.cases.judging.power import Row, floors, promises
from mpm_verify.reports.sentences import power as words

NAMES = [item.name for item in fields(Row)]
RULE = ("---",) * len(words.HEAD)
DERIVED = ["draws", "pass_rate", "fail_rate", "least"]
PAGE = """# Power and safety of the rule

What the [rule](verdicts.md) says of {sequences} sequences of errors whose right verdict is known, on three sets of
levels, with scatter of 0 to 15 % (a standard deviation of the logarithm of each error): {draws} draws of each. Second
order is expected, and the errors are C = 1. A sequence is *sound* if it tends to second order, has it on the finest
pair of cells (1.8 to 2.3), and at most 10 % of its finest error is a leak or a floor, and *bad* otherwise. A floor of
1e−5 is sound down to h = 1/32 and bad at h = 1/128; h² / (1 + 16 h), of order 1.62 at h = 1/32, the other way round.
INCONCLUSIVE is never wrong; FAIL of a sound sequence and PASS of a bad one are. `verify power --out docs` writes this
page, its [table](power.csv) and its figure, and ends with 1 if a promise is broken.

![Fractions of PASS, FAIL and INCONCLUSIVE for each sequence, set of levels and scatter](power.png)

## What it promises

The worst of all sequences and scatters but those that no rule can tell, and clean second order with 3 % scatter:

{promises}

"Yes": the rate is as wanted. "Not shown": it is not, while its interval reaches to what is wanted, so these draws show
neither that the promise is kept nor that it is broken. "NO", broken: the whole interval is on the wrong side.

## What no rule can tell

A sequence may differ by less than the scatter from another with the other right verdict. The most powerful test of the
two (Neyman & Pearson 1933), set to be right on the other as often as this rule, is wrong on it so often:

{hidden}

"In the square" is a first-order error of random sign: sums of squares add, and a part of 20 % raises the finest error
by 2 %.

## Rates
{tables}"""


def line(row: Row, least: float) -> dict[str, Any]:
    """Row of the table: numbers that were counted, then what derives from them."""
    rates = (row.draws, row.passed / row.draws, row.failed / row.draws, least)
    return asdict(row) | dict(zip(DERIVED, [rates[0], *(round(rate, 4) for rate in rates[1:])], strict=True))


def write(folder: Path, rows: Sequence[Row]) -> None:
    """Write power.csv and power.md."""
    least = floors(rows)
    with (folder / "power.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, [*NAMES, *DERIVED], lineterminator="\n")
        table.writeheader()
        table.writerows(line(row, least[row]) for row in rows)
    (folder / "power.md").write_text(markdown(rows), encoding="utf-8")


def read(file: Path) -> list[Row]:
    """Rows of a table that was written."""
    with file.open(newline="", encoding="utf-8") as text:
        return [_row(found) for found in csv.DictReader(text)]


def _row(found: dict[str, str]) -> Row:
    """Row from texts."""
    kinds: dict[str, Any] = {"sound": "True".__eq__, "sequence": str, "levels": str, "reason": str}
    kinds |= dict.fromkeys(("passed", "failed", "left"), int)
    return Row(**{name: kinds.get(name, float)(found[name]) for name in NAMES})


def markdown(rows: Sequence[Row]) -> str:
    """Page: what is promised, what no rule can tell, and a table for each set of levels."""
    return PAGE.format(
        sequences=len({row.sequence for row in rows}),
        draws=rows[0].draws,
        promises="\n".join(
            f"| {' | '.join(cells)} |" for cells in [words.HEAD, RULE, *map(words.promise, promises(rows))]
        ),
        hidden="\n".join(f"- {text}." for text in words.hidden(rows)) or "- Nothing here.",
        tables="\n".join(text for levels in CELLS for text in _table([row for row in rows if row.levels == levels])),
    )


def _table(rows: Sequence[Row]) -> Iterator[str]:
    """Lines of the table of one set of levels."""
    if not rows:
        return
    scatters = list(dict.fromkeys(row.scatter for row in rows))
    yield f"\n{words.levels(rows[0].levels).capitalize()}: PASS / FAIL / INCONCLUSIVE in % by scatter\n"
    yield f"| sequence | right | {' | '.join(map(words.scatter, scatters))} |"
    yield f"| --- | --- |{' --- |' * len(scatters)}"
    for _, several in by_sequence(rows):
        cells = " | ".join(map(words.rates, several))
        yield f"| {words.name(several[0].sequence)} | {words.right(several[0])} | {cells} |"


def by_sequence(rows: Sequence[Row]) -> list[tuple[str, list[Row]]]:
    """Rows of each sequence, those that are sound first."""
    found: dict[str, list[Row]] = {}
    for row in sorted(rows, key=lambda row: not row.sound):
        found.setdefault(row.sequence, []).append(row)
    return list(found.items())
