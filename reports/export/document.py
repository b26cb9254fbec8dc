"""The JSON document of --json. CI jobs read it: its shape changes only with VERSION, and schema.json says it."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from mpm_verify.cases.harness.axes import particle_axes, position_axes, time_axes
from mpm_verify.cases.harness.study import NORMS, QUANTITIES, Result, Run, Study
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.stall import Stall

VERSION = 2
SCHEMA = Path(__file__).with_name("schema.json")


def document(study: Study, found: Sequence[Finding], results: Mapping[str, Result], report: Path) -> str:
    """The document as text."""
    content = {
        "version": VERSION,
        "study": study.name,
        "verdicts": [verdict(f) for f in found if f.plan.judged],
        "shown": [shown(f) for f in found if not f.plan.judged],
        "axes": axes(study.runs, results),
        "runs": [row(results[run.digest]) for run in study.runs if run.digest in results],
        "report": str(report),
    }
    return json.dumps(content, indent=1, allow_nan=False)


def verdict(finding: Finding) -> dict[str, Any]:
    """A judged quantity."""
    expectation = finding.plan.expectation
    order = expectation.order if expectation else None
    return {
        **shown(finding),
        "expected": expectation.kind if expectation and order is None else order,
        "verdict": str(finding.verdict.outcome),
        "reason": finding.verdict.reason,
    }


def shown(finding: Finding) -> dict[str, Any]:
    """What is measured of a quantity, judged or not."""
    d, v = finding.plan, finding.verdict
    return {
        "method": d.method,
        "solution": d.solution,
        "ppc": d.ppc,
        "quantity": d.quantity,
        "norm": d.norm,
        "observed": v.observed,
        "interval": None if v.interval is None else list(v.interval),
        "local_orders": list(v.local_orders),
        "crossings": list(finding.crossings),
        "stall": stall(finding.stall) if finding.stall else None,
    }


def stall(found: Stall) -> dict[str, Any]:
    """Where an order falls, and the causes that were weighed, the weightiest first."""
    return {
        "where": found.where,
        "order": found.order,
        "before": list(found.before),
        "named": [cause.name for cause in found.named],
        "causes": [{**asdict(cause), "finding": str(cause.finding)} for cause in found.causes],
    }


def axes(runs: Sequence[Run], results: Mapping[str, Result]) -> dict[str, list[dict[str, Any]]]:
    """u in rms along the axes beside the cells; an axis with one value is empty."""
    times = [
        {**point(a.run), "cells": a.run.cells, "courants": list(a.courants), "errors": list(a.errors)}
        | {"orders": list(a.orders), "shares": list(a.shares)}
        for a in time_axes(runs, results)
    ]
    particles = [
        {"method": a.run.method, "solution": a.run.solution, "cells": a.run.cells, "ppc": list(a.ppc)}
        | {"errors": list(a.errors), "orders": list(a.orders)}
        for a in particle_axes(runs, results)
    ]
    positions = [
        {**point(a.run), "cells": list(a.cells), "errors": [list(errors) for errors in a.errors]}
        for a in position_axes(runs, results)
    ]
    return {"time": times, "particles": particles, "position": positions}


def point(run: Run) -> dict[str, Any]:
    """What names a series."""
    return {"method": run.method, "solution": run.solution, "ppc": run.ppc}


def row(result: Result) -> dict[str, Any]:
    """A run."""
    run = result.run
    return {
        "method": run.method,
        "solution": run.solution,
        "material": run.material,
        "cells": run.cells,
        "ppc": run.ppc,
        "courant": run.courant,
        "transfer": run.transfer,
        "stress": run.stress,
        "layout": run.layout,
        "offset": list(run.offset),
        "status": result.status,
        "reason": str(result.failure) if result.failure else "",
        "errors": {q: {n: result.errors[q][n] for n in NORMS} for q in QUANTITIES} if result.errors else None,
        "steps": result.steps,
        "particles": result.particles,
        "crossings": result.crossings,
        "gap": result.gap,
        "wall_s": result.wall_s,
    }
