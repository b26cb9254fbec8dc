"""Tables of any case: runs with all their parameters and numbers, and the levels of each refinement."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd

from mpm_verify.cases.harness.axes import middle
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.fit import local
from mpm_verify.reports.frames import Record, flat, joined
from mpm_verify.reports.sentences import commands, failures

Rows = list[dict[str, Any]]


def frames(record: Record) -> dict[str, pd.DataFrame]:
    """All tables by name; one without rows is none."""
    made = {"runs": runs(record), "levels": every_level(record), "verdicts": verdicts(record)}
    return {name: pd.DataFrame(rows) for name, rows in made.items() if rows}


def write(record: Record, folder: Path) -> None:
    """Write one CSV file for each table; numbers read back as they are stored."""
    for name, frame in frames(record).items():
        frame.to_csv(folder / f"{name}.csv", index=False, lineterminator="\n")


def runs(record: Record) -> Rows:
    """Rows, one for each run, done or not, with every parameter, errors as `error QUANTITY NORM`, and values."""
    rows = []
    for run in record.study.runs:
        result = record.result(run)
        found: dict[str, Any] = {"status": "not run"}
        if result:
            errors = {f"error {q} {n}": e for q, norms in result.errors.items() for n, e in norms.items()}
            found = joined({"status": result.status, "digest": result.digest, "time_steps": result.steps}, errors,
                           {f"value {name}": value for name, value in result.values.items()},
                           {"failure": failures.failure(result.failure) if result.failure else ""})  # fmt: skip
        rows.append(joined(flat(asdict(run)), found))
    return rows


def levels(record: Record, found: Finding) -> Rows:
    """Rows of a finding, one for each cell size: error, local order, and why there is none."""
    rows: Rows = []
    last: tuple[float, float] | None = None
    for level in found.levels:
        size = {record.by: record.size(level.h)}
        if level.ended:
            rows.append({**size, "error": None, "order": None, "ended": failures.failure(level.ended.failure)})
            continue
        error = middle(level.errors)
        order = local([last, (level.h, error)])[0] if last else None
        rows.append({**size, "error": error, "order": order, "ended": ""})
        last = (level.h, error)
    return rows


def every_level(record: Record) -> Rows:
    """Rows of the levels of all findings."""
    return [
        joined(record.columns(f.plan.run), {"quantity": f.plan.quantity, "norm": f.plan.norm}, row)
        for f in record.findings
        for row in levels(record, f)
    ]


def verdicts(record: Record) -> Rows:
    """Rows, one for each finding."""
    return [
        joined(
            record.columns(f.plan.run),
            {"quantity": f.plan.quantity, "norm": f.plan.norm, "role": "judged" if f.counts else "shown"},
            {"verdict": str(f.verdict.outcome), "order": f.verdict.observed, "code": str(f.verdict.reason.code),
             "reason": commands.reason(record.study, f)},
        )
        for f in record.findings
    ]  # fmt: skip
