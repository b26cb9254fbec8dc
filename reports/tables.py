"""Stored results as pandas data frames, full digits, one row a fact: what the CSV files hold and the page shows."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd

from cases.study import NORMS, QUANTITIES, Declared
from reports.figures.local_orders import orders as pairs
from reports.stored import Record

Rows = list[dict[str, Any]]
KEY = ("method", "solution", "ppc", "quantity", "norm")


def write(record: Record, folder: Path) -> None:
    """One CSV file a table into `folder`; numbers read back as they are stored."""
    for name, frame in frames(record).items():
        frame.to_csv(folder / f"{name}.csv", index=False, lineterminator="\n")


def frames(record: Record) -> dict[str, pd.DataFrame]:
    """All tables by name."""
    made = {
        "verdicts": verdicts(record),
        "errors": errors(record),
        "orders": orders(record),
        "contamination": contamination(record),
        "runs": runs(record),
    }
    return {name: pd.DataFrame(rows) for name, rows in made.items()}


def roles(record: Record) -> dict[tuple[Any, ...], str]:
    """`judged` or `shown` for each declared (method, solution, ppc, quantity, norm); what is not declared is shown."""
    return {key(d): "judged" if d.judged else "shown" for d in record.study.declared}


def verdicts(record: Record) -> Rows:
    """A row a declared quantity. Where nothing was expected there is no verdict, only a slope."""
    rows = []
    for found in record.findings:
        d, v, e = found.declared, found.verdict, found.declared.expectation
        expected = None if e is None else "diverges" if e.order is None else e.order
        low, high = v.interval or (None, None)
        rows.append(
            dict(zip(KEY, key(d), strict=True))
            | {"role": "judged" if d.judged else "shown", "expected": expected, "observed": v.observed}
            | {"low": low, "high": high, "verdict": str(v.outcome) if e else None, "reason": v.reason if e else None}
            | {"source": e.source if e else None}
        )
    return rows


def errors(record: Record) -> Rows:
    """A row a finished run and quantity, with every norm and the rms of the exact quantity."""
    rows = []
    for run in record.study.runs:
        result = record.result(run)
        for quantity in QUANTITIES if result and result.status == "finished" else ():
            norms = {norm: record.error(run, quantity, norm) for norm in NORMS}
            head = {"method": run.method, "solution": run.solution, "ppc": run.ppc, "cells": run.cells}
            exact = result.scale.get(quantity) if result else None
            rows.append(head | {"courant": run.courant, "quantity": quantity} | norms | {"exact_rms": exact})
    return rows


def orders(record: Record) -> Rows:
    """A row a pair of neighbouring cell sizes, for every series, quantity and norm."""
    rows, role = [], roles(record)
    for s in record.series:
        for quantity in QUANTITIES:
            for norm in NORMS:
                name = (s.first.method, s.first.solution, s.first.ppc, quantity, norm)
                for coarse, fine, order in pairs(record, s, quantity, norm):
                    row: dict[str, Any] = dict(zip(KEY, name, strict=True))
                    rows.append(
                        row | {"role": role.get(name, "shown"), "from_cells": coarse, "to_cells": fine, "order": order}
                    )
    return rows


def contamination(record: Record) -> Rows:
    """Shares of the finest error that are not of the expected order, for each quantity that has such an order."""
    rows = []
    for found in record.findings:
        shares = found.verdict.contamination
        if shares is not None:
            row: dict[str, Any] = dict(zip(KEY, key(found.declared), strict=True))
            row |= {"role": "judged" if found.declared.judged else "shown"}
            rows.append(row | {"lower_order": shares.lower, "floor": shares.floor, "at_most": shares.most})
    return rows


def runs(record: Record) -> Rows:
    """A row a run of the study, done or not, with every parameter."""
    rows = []
    for run in record.study.runs:
        row: dict[str, Any] = asdict(run) | {"status": "not run"}
        result = record.result(run)
        if result is not None:
            row |= {"status": result.status, "steps": result.steps, "particles": result.particles, "dt": result.dt}
            row |= {"wall_s": result.wall_s, "peak_memory_mb": result.peak_memory_mb}
            row |= {"digest": result.digest}
            failure = result.failure
            if failure is not None:
                row |= {"reason": failure.reason, "failed_step": failure.step, "failed_particle": failure.particle}
                row |= {"failed_cell": " ".join(map(str, failure.cell)) if failure.cell else None}
        rows.append(row)
    return rows


def key(d: Declared) -> tuple[Any, ...]:
    """What names a declared quantity."""
    return d.method, d.solution, d.ppc, d.quantity, d.norm
