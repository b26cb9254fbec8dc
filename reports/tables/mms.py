"""Stored results as pandas data frames, full digits, one row a fact: what the CSV files hold and the page shows."""

from dataclasses import asdict
from itertools import product
from pathlib import Path
from typing import Any

import pandas as pd

from mpm_verify.cases.harness.axes import cell_crossings, particle_axes, position_axes, time_axes
from mpm_verify.cases.harness.study import Head, QuantityPlan
from mpm_verify.cases.mms.run import NORMS, QUANTITIES
from mpm_verify.reports.figures.local_orders import orders as pairs
from mpm_verify.reports.frames import Record, flat, joined
from mpm_verify.reports.sentences import commands, failures
from mpm_verify.reports.sentences import stalls as told
from mpm_verify.reports.tables.cost import compares, costs

Rows = list[dict[str, Any]]
Key = tuple[Head, str, str]


def write(record: Record, folder: Path) -> None:
    """Write one CSV file for each table into `folder`; numbers read back as they are stored."""
    for name, frame in frames(record).items():
        frame.to_csv(folder / f"{name}.csv", index=False, lineterminator="\n")


def frames(record: Record) -> dict[str, pd.DataFrame]:
    """All tables by name; one without rows is none. Of a study without refinements there are the runs alone."""
    if not record.study.plans:
        return {"runs": pd.DataFrame(runs(record))}
    made = {
        "verdicts": verdicts(record),
        "errors": errors(record),
        "orders": orders(record),
        "contamination": contamination(record),
        "stalls": stalls(record),
        "time_step": time_step(record),
        "particles_per_cell": particles_per_cell(record),
        "position": position(record),
        "runs": runs(record),
        **({"cost": costs(record)} if compares(record) else {}),
    }
    return {name: pd.DataFrame(rows) for name, rows in made.items() if rows}


def roles(record: Record) -> dict[Key, str]:
    """Role of each planned quantity, `judged` or `shown`; what has no plan is shown."""
    return {key(plan): "judged" if plan.judged else "shown" for plan in record.study.plans}


def verdicts(record: Record) -> Rows:
    """Rows, one for each planned quantity. Where nothing was expected there is no verdict, only a slope."""
    rows = []
    for found in record.findings:
        plan, v, e = found.plan, found.verdict, found.plan.expectation
        expected = None if e is None else e.kind if e.order is None else e.order
        low, high = v.interval or (None, None)
        rows.append(
            named(record, plan)
            | {"role": "judged" if plan.judged else "shown", "expected": expected, "observed": v.observed}
            | {"low": low, "high": high, "verdict": str(v.outcome) if e else None}
            | {"code": str(v.reason.code) if e else None, "reason": commands.reason(record.study, found) if e else None}
            | {"source": e.source if e else None}
        )
    return rows


def errors(record: Record) -> Rows:
    """Rows, one for each finished run and quantity, with every norm and the rms of the exact quantity."""
    rows = []
    for run in record.study.runs:
        result = record.result(run)
        for quantity in QUANTITIES if result and result.status == "finished" else ():
            norms = {norm: record.error(run, quantity, norm) for norm in NORMS}
            head = record.columns(run) | {"cells": run.cells}
            exact = result.scale.get(quantity) if result else None
            where = {"offset_x": run.offset[0], "offset_y": run.offset[1]}
            rows.append(head | {"courant": run.courant} | where | {"quantity": quantity} | norms | {"exact_rms": exact})
    return rows


def orders(record: Record) -> Rows:
    """Rows, one for each pair of consecutive cell sizes, for every series, quantity and norm."""
    rows, role, passed = [], roles(record), crossings(record)
    for s in record.series:
        for quantity in QUANTITIES:
            for norm in NORMS:
                name = (s.head, quantity, norm)
                for coarse, fine, order in pairs(record, s, quantity, norm):
                    rows.append(
                        record.columns(s.first)
                        | {"quantity": quantity, "norm": norm}
                        | {"role": role.get(name, "shown"), "from_cells": coarse, "to_cells": fine, "order": order}
                        | {"crossings_per_particle": passed.get((s.head, fine))}
                    )
    return rows


def contamination(record: Record) -> Rows:
    """Rows of the fractions of the finest error that are not of the expected order, for each quantity with an order."""
    rows = []
    for found in record.findings:
        mixed = found.verdict.contamination
        if mixed is not None:
            row = named(record, found.plan)
            row |= {"role": "judged" if found.counts else "shown"}
            rows.append(row | {"lower_order": mixed.lower, "floor": mixed.floor, "at_most": mixed.most})
    return rows


def runs(record: Record) -> Rows:
    """Rows, one for each run of the study, done or not, with every parameter."""
    rows = []
    for run in record.study.runs:
        result = record.result(run)
        row: dict[str, Any] = {"status": result.status if result else "not run"}
        if result is not None:
            row |= {"time_steps": result.steps, "particles": result.particles, "dt": result.dt}
            row |= {"wall_s": result.wall_s, "cpu_s": result.cpu_s, "peak_memory_mb": result.peak_memory_mb}
            row |= {"crossings": result.crossings, "gap": result.gap}
            row |= {"digest": result.digest}
            failure = result.failure
            if failure is not None:
                row |= {"failure": str(failure.kind), "reason": failures.cause(failure)}
                row |= {"failed_step": failure.step, "failed_particle": failure.particle}
                row |= {"failed_cell": " ".join(map(str, failure.cell)) if failure.cell else None}
        rows.append(joined(flat(asdict(run)), row))
    return rows


def stalls(record: Record) -> Rows:
    """Rows, one for each stall and cause, the weightiest first."""
    rows = []
    for found in record.findings:
        for cause in found.stall.causes if found.stall else ():
            row = named(record, found.plan)
            row |= {
                "where": told.where(found.stall) if found.stall else None,
                "code": str(cause.code),
                "cause": told.name(cause),
            }
            rows.append(row | {"finding": str(cause.finding), "weight": cause.weight, "measured": told.measured(cause)})
    return rows


def time_step(record: Record) -> Rows:
    """Rows, one for each time step of each series that has several, for every quantity and norm; the largest first."""
    rows = []
    for quantity, norm in product(QUANTITIES, NORMS):
        for a in time_axes(record.study.runs, record.results, quantity, norm):
            head = record.columns(a.run) | {"cells": a.run.cells}
            for courant, error, order, part in zip(a.courants, a.errors, (None, *a.orders), a.fractions, strict=True):
                row = head | {"quantity": quantity, "norm": norm, "courant": courant, "error": error}
                rows.append(row | {"order": order, "fraction_of_time_step": part})
    return rows


def particles_per_cell(record: Record) -> Rows:
    """Rows, one for each particle count of each method and cell size that has several, for every quantity and norm."""
    rows = []
    for quantity, norm in product(QUANTITIES, NORMS):
        for a in particle_axes(record.study.runs, record.results, quantity, norm):
            head = record.columns(a.run) | {"cells": a.run.cells}
            head.pop("ppc")
            for count, error, order in zip(a.ppc, a.errors, (None, *a.orders), strict=True):
                row = head | {"quantity": quantity, "norm": norm, "ppc": count, "error": error}
                rows.append(row | {"order_in_spacing": order})
    return rows


def position(record: Record) -> Rows:
    """Rows, one for each cell size of each series with replicates, for every quantity and norm."""
    rows = []
    for quantity, norm in product(QUANTITIES, NORMS):
        for a in position_axes(record.study.runs, record.results, quantity, norm):
            head = record.columns(a.run)
            for cells, errors, (low, mid, high) in zip(a.cells, a.errors, a.ends, strict=True):
                row = head | {"quantity": quantity, "norm": norm, "cells": cells, "runs": len(errors)}
                rows.append(row | {"usual": errors[0], "smallest": low, "median": mid, "largest": high})
    return rows


def crossings(record: Record) -> dict[tuple[Head, int], float]:
    """Mean number of cell faces that a particle crossed, by refinement and cells."""
    every = [
        (series.head, run.cells, cell_crossings(record.result(run))) for series in record.series for run in series.runs
    ]
    return {(head, cells): passed for head, cells, passed in every if passed is not None}


def named(record: Record, plan: QuantityPlan[Any]) -> dict[str, Any]:
    """Names and values that tell a planned quantity."""
    return joined(record.columns(plan.run), {"quantity": plan.quantity, "norm": plan.norm})


def key(plan: QuantityPlan[Any]) -> Key:
    """Key of a planned quantity."""
    return plan.head, plan.quantity, plan.norm
