"""JSON document of --json, of every case. CI jobs read it: its shape changes only with VERSION.

Each row of `runs` has the fields of the case's Run beside those of RunRow, each row of `verdicts` and `shown` those
that name its refinement. `schema` derives the JSON schema from the records below and from the case's Run.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from mpm_verify.cases.harness.axes import middle, particle_axes, position_axes, time_axes
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.controls import Control
from mpm_verify.cases.harness.study import ResultRecord
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.fit import local
from mpm_verify.cases.judging.records import Ended
from mpm_verify.cases.judging.stall import Cause, Stall
from mpm_verify.reports.frames import USUAL, Record, joined
from mpm_verify.reports.sentences import commands, controls, failures, stalls
from mpm_verify.solver.failure import Failure
from mpm_verify.solver.plugins import label

VERSION = 4
REFINEMENT_ROWS = ("VerdictRow", "ShownRow")
Row = dict[str, Any]


@dataclass(frozen=True)
class FailureRow:
    """Failure of a run; `particle` is -1 where none has to do with it."""

    kind: str
    step: int
    particle: int
    cell: list[int] | None
    numbers: dict[str, float | None]


@dataclass(frozen=True)
class EndedRow:
    """Level without an error."""

    h: float
    replicate: int
    failure: FailureRow


@dataclass(frozen=True)
class CauseRow:
    """Cause of a stall that was weighed; `weight` is the fraction of the excess that it explains."""

    code: str
    name: str
    finding: str
    weight: float
    numbers: dict[str, Any]
    peer: str | None
    measured: str


@dataclass(frozen=True)
class StallRow:
    """Stall, where an order falls; `order` on the finest pair of levels, `before` on the coarser ones."""

    coarser: int | None
    cells: int
    where: str
    order: float | None
    before: list[float]
    named: list[str]
    causes: list[CauseRow]
    ended: EndedRow | None


@dataclass(frozen=True)
class ShownRow:
    """Measurements of a quantity; lists run over the levels, coarse to fine, null where there is none.

    `local_orders` run over the pairs of levels next to each other: null where an error is zero or not there.
    """

    quantity: str
    norm: str
    observed: float | None
    interval: list[float] | None
    local_orders: list[float | None]
    crossings: list[float | None]
    stall: StallRow | None


@dataclass(frozen=True)
class VerdictRow(ShownRow):
    """Verdict on a judged quantity; `expected` is an order, or a word such as diverges."""

    expected: float | str | None
    verdict: str
    code: str
    numbers: dict[str, Any]
    failed: list[EndedRow]
    wanted: dict[str, Any] | None
    reason: str


@dataclass(frozen=True)
class CheckRow:
    """Check, a number beside what it is held against; null for a number that is not finite."""

    group: str
    name: str
    found: float | None
    expected: float | None
    way: str
    within: float | None
    source: str
    outcome: str


@dataclass(frozen=True)
class ControlRow:
    """Negative control: on how many verdicts it was tried, and those that passed all the same, by their refinement."""

    code: str
    name: str
    tried: int
    refused: bool
    passed: list[str]


@dataclass(frozen=True)
class RunRow:
    """Run, and how it ended; `errors` by quantity and norm, null of a failed run.

    `log` are the last lines that a solver of somebody else printed, and `log_file` has all of it.
    """

    digest: str
    status: str
    failure: FailureRow | None
    reason: str
    errors: dict[str, dict[str, float]] | None
    values: dict[str, float | None]
    time_steps: int
    particles: int
    crossings: int | None
    gap: float | None
    wall_s: float
    log: list[str]
    log_file: str | None


@dataclass(frozen=True)
class Document:
    """Document of a study: `axes` are what is judged along the axes beside the cells; `more` is what the case adds."""

    version: int
    case: str
    study: str
    title: str
    outcome: str
    exit_code: int
    verdicts: list[VerdictRow]
    shown: list[ShownRow]
    axes: dict[str, list[dict[str, Any]]]
    checks: list[CheckRow]
    controls: list[ControlRow]
    runs: list[RunRow]
    more: dict[str, Any]
    report: str | None


def document(record: Record, page: Path | None, more: Row) -> str:
    """Text of the document; `page` is None where none is drawn."""
    study, found = record.study, record.analysis
    content = {
        "version": VERSION,
        "case": label(study.case),
        "study": study.name,
        "title": study.title,
        "outcome": str(found.outcome),
        "exit_code": found.exit_code,
        "verdicts": [verdict(record, f) for f in found.findings if f.counts],
        "shown": [shown(record, f) for f in found.findings if not f.counts],
        "axes": axes(record),
        "checks": [asdict(check_row(check)) for check in found.checks],
        "controls": [asdict(control_row(record, control)) for control in found.controls],
        "runs": [
            run_row(record.results[run.digest], record.store.log(run.digest))
            for run in study.runs
            if run.digest in record.results
        ],
        "more": finite(more),
        "report": str(page) if page else None,
    }
    return json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False)


def verdict(record: Record, finding: Finding) -> Row:
    """Row of a judged quantity; `code`, `numbers`, `failed` and `wanted` are what `reason` says in words."""
    study, expectation, r = record.study, finding.plan.expectation, finding.verdict.reason
    typed = commands.command(study, finding, record.store.folder)
    order = expectation.order if expectation else None
    row = {
        "expected": expectation.kind if expectation and order is None else order,
        "verdict": str(finding.verdict.outcome),
        "code": str(r.code),
        "numbers": finite(r.numbers),
        "failed": [asdict(ended(end)) for end in r.failed],
        "wanted": {**asdict(r.wanted), "command": typed} if r.wanted else None,
        "reason": commands.reason(study, finding),
    }
    return joined(shown(record, finding), row)


def shown(record: Record, finding: Finding) -> Row:
    """Row of the measurements of a quantity, judged or not."""
    plan, v = finding.plan, finding.verdict
    row = ShownRow(
        plan.quantity, plan.norm, v.observed, None if v.interval is None else list(v.interval), pairs(finding),
        list(finding.crossings), stall(finding.stall) if finding.stall else None,
    )  # fmt: skip
    return joined(record.columns(plan.run), asdict(row))


def pairs(finding: Finding) -> list[float | None]:
    """Local order of each pair of levels next to each other."""
    return local([(each.h, 0.0 if each.ended else middle(each.errors)) for each in finding.levels])


def stall(found: Stall) -> StallRow:
    """Row of a stall, and the causes that were weighed, the weightiest first."""
    causes = [cause(each) for each in found.causes]
    return StallRow(
        found.coarser, found.cells, stalls.where(found), found.order, list(found.before),
        [str(each.code) for each in found.named], causes, ended(found.ended) if found.ended else None,
    )  # fmt: skip


def cause(found: Cause) -> CauseRow:
    """Row of a cause of a stall; `measured` says in words what its numbers are."""
    return CauseRow(
        str(found.code), stalls.name(found), str(found.finding), found.weight, finite(found.numbers),
        found.peer.method if found.peer else None, stalls.measured(found),
    )  # fmt: skip


def ended(end: Ended) -> EndedRow:
    """Row of a level without an error."""
    return EndedRow(end.h, end.replicate, failure(end.failure))


def failure(found: Failure) -> FailureRow:
    """Row of what ended a run, as codes and numbers."""
    return FailureRow(str(found.kind), found.step, found.particle, list(found.cell) if found.cell else None,
                      finite(found.numbers))  # fmt: skip


def axes(record: Record) -> dict[str, list[Row]]:
    """Rows of the axes beside the cells, of the first judged quantity; an axis with one value is empty."""
    runs, results = record.study.runs, record.results
    if not record.study.plans:
        return {"time": [], "particles": [], "position": []}
    plan = next((plan for plan in record.study.plans if plan.judged), record.study.plans[0])
    of = plan.quantity, plan.norm
    times = [
        joined(record.columns(a.run), {"cells": a.run.cells, "courants": list(a.courants), "errors": list(a.errors)})
        | {"orders": list(a.orders), "fractions": list(a.fractions)}
        for a in time_axes(runs, results, *of)
    ]
    particles = [
        {key: value for key, value in record.columns(a.run).items() if key != "ppc"}
        | {"cells": a.run.cells, "ppc": list(a.ppc), "errors": list(a.errors), "orders": list(a.orders)}
        for a in particle_axes(runs, results, *of)
    ]
    positions = [
        joined(record.columns(a.run), {"cells": list(a.cells), "errors": [list(errors) for errors in a.errors]})
        for a in position_axes(runs, results, *of)
    ]
    return {"time": times, "particles": particles, "position": positions}


def check_row(check: Check) -> CheckRow:
    """Row of a check with its outcome."""
    found, expected, within = (x if isfinite(x) else None for x in (check.found, check.expected, check.within))
    return CheckRow(
        check.group, check.name, found, expected, check.way, within, check.source, str(check.outcome)
    )  # fmt: skip


def control_row(record: Record, control: Control) -> ControlRow:
    """Row of a negative control."""
    passed = [record.label(plan.run) for plan in control.passed]
    return ControlRow(str(control.code), controls.name(control), len(control.tried), control.refused, passed)


def run_row(result: ResultRecord[Any], log: Path | None) -> Row:
    """Row of a run with all its parameters."""
    row = RunRow(
        result.digest, result.status, failure(result.failure) if result.failure else None,
        failures.failure(result.failure) if result.failure else "", result.errors or None,
        finite(result.values), result.steps, result.particles, result.crossings, result.gap, result.wall_s,
        list(getattr(result, "log", ())), str(log) if log else None,
    )  # fmt: skip
    return joined(finite(asdict(result.run)), asdict(row))


def finite(value: Any) -> Any:
    """Value with null for numbers that are not finite, which JSON cannot write."""
    if isinstance(value, dict):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [finite(one) for one in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def schema(case: str) -> Row:
    """JSON schema (draft 2020-12) of the document of a case. Raises ValueError for another name."""
    contract = case_named(case)
    fields = TypeAdapter(contract.Run).json_schema(mode="serialization")["properties"]
    whole = TypeAdapter(Document).json_schema(mode="serialization")
    for definition in whole["$defs"].values():
        definition["additionalProperties"] = False
    needed = {"RunRow": list(fields)} | {name: [key for key in USUAL if key in fields] for name in REFINEMENT_ROWS}
    for name, keys in needed.items():
        definition = whole["$defs"][name]
        clash = definition["properties"].keys() & fields.keys()
        if clash:
            raise ValueError(f"the Run of {case} has the field {sorted(clash)[0]!r}, a name of {name}")
        definition["properties"] |= {key: nullable(field) for key, field in fields.items()}
        definition["required"] += keys
    if contract.quantities and not hasattr(contract.module, "measures"):
        norms = exactly(contract.norms, {"type": "number"})
        errors = {"anyOf": [exactly(contract.quantities, norms), {"type": "null"}]}
        whole["$defs"]["RunRow"]["properties"]["errors"] = errors
    whole["properties"]["version"] = {"const": VERSION}
    whole["additionalProperties"] = False
    return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | whole | {"title": f"verify {case} --json"}


def exactly(keys: Sequence[str], value: Row) -> Row:
    """An object that has these keys and no other, with values of one kind."""
    return {
        "type": "object", "properties": dict.fromkeys(keys, value), "required": list(keys),
        "additionalProperties": False,
    }  # fmt: skip


def nullable(field: Row) -> Row:
    """Schema of a field whose value may be null for a number that is not finite."""
    return {"anyOf": [field, {"type": "null"}]} if field.get("type") == "number" else field
