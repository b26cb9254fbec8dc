"""Campaign: defects planted one at a time in a copy, placebos that change nothing, and which of them checks notice.

Each defect is a change of one file (cases/detect/defects), each copy is asked in a process of its own, and a crash or a
hang is a catch. Noticed is what any check answers otherwise than for the sound package.
The contract of a case is told in cases/harness/contract.py.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from mpm_verify.cases.detect.defect import NONE
from mpm_verify.cases.detect.rates import QUICKLY, Rate, Row, rates, real, rows
from mpm_verify.cases.detect.run import AXES, QUICK, USUAL, Result, Run, one
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.solver.plugins import METHODS
from mpm_verify.solver.plugins import canonical as canonical_name

__all__ = ["AXES", "QUICK", "Result", "Run"]

ENOUGH = 20  # defects of a kind, below which no rate is asked
WANTED = {"order": 0.97, "all": 0.92, QUICKLY: 0.85, "as FAIL": 0.90}
OVERWRITTEN = "gamma-overwritten"


@dataclass(frozen=True)
class Campaign:
    """Analysis: rows of all planted copies, rates, and what is asked of them."""

    rows: tuple[Row, ...]
    rates: tuple[Rate, ...]
    checks: tuple[Check, ...]

    @property
    def missed(self) -> list[Row]:
        """Defects that no check noticed."""
        return [row for row in real(self.rows) if not row.noticed()]

    @property
    def alarms(self) -> list[Row]:
        """Placebos that a check noticed."""
        return [row for row in self.rows if row.kind == "placebo" and row.noticed()]


def title(runs: Sequence[Run]) -> str:
    """Title of a campaign."""
    methods = dict.fromkeys(run.method.upper() for run in runs)
    return f"What the checks notice: planted defects, {', '.join(methods)}"


def canonical(values: dict[str, Any]) -> dict[str, Any]:
    """Values with a method that the defect is in."""
    planted = one(values.get("defect", NONE))
    method = canonical_name(METHODS, values.get("method", USUAL))
    values["method"] = method if not planted.methods or method in planted.methods else planted.methods[0]
    return values


def companions(runs: Sequence[Run]) -> list[Run]:
    """Runs with the sound package of each method first."""
    return [*dict.fromkeys(replace(run, defect=NONE) for run in runs), *(run for run in runs if run.defect != NONE)]


def examine(study: Study[Run], results: Mapping[str, Result], store: Store) -> Campaign:
    """Rates of what is stored, and the checks where there are enough defects for them."""
    found = rows([results[run.digest] for run in study.runs if run.digest in results])
    made = rates(found)
    checks = [
        Check("Rates", each.name, each.fraction, WANTED[each.name], "at_least", "wanted of a campaign")
        for each in made
        if each.name in WANTED and each.total >= ENOUGH
    ]
    checks.append(
        Check("Copies", "copies that were asked", float(len(found)), float(len(study.runs)), "at_least", "the campaign")
    )
    quiet = [row for row in found if row.kind == "placebo" and row.name != NONE]
    checks.append(
        Check(
            "Placebos",
            f"alarms of {len(quiet)}",
            float(sum(row.noticed() for row in quiet)),
            0.0,
            "at_most",
            "nothing that matters is changed",
        )
    )
    known = [row for row in found if row.name == OVERWRITTEN]
    checks += [Check("Rates", OVERWRITTEN, float(row.noticed()), 1.0, "at_least", "known blind spot") for row in known]
    return Campaign(tuple(found), tuple(made), tuple(checks))
