"""The certificate: what a full campaign noticed, kept in the repository and quoted by each page."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any

from mpm_verify.cases.detect.defect import NONE
from mpm_verify.cases.detect.plant import examined
from mpm_verify.cases.detect.rates import QUICKLY, rates, real, rows

FILE = Path(__file__).with_name("certificate.json")


@dataclass(frozen=True)
class Certificate:
    """Numbers of a campaign.

    Parameters
    ----------
    date, examined, processor
        Day, digest of what was examined, and the machine.
    methods
        Methods that were examined.
    done, copies
        Copies that were asked, of those of the campaign.
    noticed, planted
        Defects that a check noticed, of those that it should.
    quick
        Those that `mms --quick` and the exactness battery noticed, of what computes.
    failed
        Those noticed with a FAIL.
    alarms, placebos
        Placebos that a check noticed, and all.
    equivalent
        Defects that nothing can see, which are not counted.
    kinds
        By kind: noticed, planted, and the 95 % interval of the fraction.
    missed
        Names of defects that nothing noticed.
    """

    date: str
    examined: str
    processor: str
    methods: list[str]
    done: int
    copies: int
    noticed: int
    planted: int
    quick: int
    failed: int
    alarms: int
    placebos: int
    equivalent: int
    kinds: dict[str, list[float]]
    missed: list[str]

    @property
    def current(self) -> bool:
        """Whether what was examined is what is here."""
        return self.examined == examined()


def of(results: Sequence[Any], copies: int, date: str, digest: str, processor: str) -> Certificate:
    """Certificate of Results of a campaign of so many copies. Raises ValueError where nothing was planted."""
    found = rows(results)
    mine, named = real(found), {one.name: one for one in rates(found)}
    if not mine:
        raise ValueError("nothing was planted: there is nothing to certify")
    quiet = [row for row in found if row.kind == "placebo" and row.name != NONE]
    return Certificate(
        date,
        digest,
        processor,
        sorted({row.method for row in found}),
        len(found),
        copies,
        named["all"].noticed,
        len(mine),
        named[QUICKLY].noticed,
        named["as FAIL"].noticed,
        sum(row.noticed() for row in quiet),
        len(quiet),
        sum(bool(row.equivalent) for row in found),
        {kind: [one.noticed, one.total, round(one.low, 4), round(one.high, 4)] for kind, one in named.items()},
        [row.name for row in mine if not row.noticed()],
    )


def write(certificate: Certificate, file: Path) -> None:
    """Write a certificate as JSON. Raises OSError."""
    file.write_text(json.dumps(asdict(certificate), indent=1) + "\n", encoding="utf-8")


@cache
def stored() -> Certificate | None:
    """The certificate of the repository; None where there is none, or a broken one."""
    try:
        data = json.loads(FILE.read_text(encoding="utf-8"))
        return Certificate(**{item.name: data[item.name] for item in fields(Certificate)})
    except (OSError, ValueError, KeyError, TypeError):
        return None
