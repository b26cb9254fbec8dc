"""The JSON document of --json. CI jobs read it: its shape changes only with VERSION, and schema.json says it."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from mpm_verify.cases.harness.axes import particle_axes, position_axes, time_axes
from mpm_verify.cases.harness.study import NORMS, QUANTITIES, Result, Run, Study
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.records import Ended
from mpm_verify.cases.judging.stall import Cause, Stall
from mpm_verify.reports.sentences import commands, failures, stalls
from mpm_verify.solver.failure import Failure

VERSION = 3
SCHEMA = Path(__file__).with_name("schema.json")


def document(study: Study, found: Sequence[Finding], results: Mapping[str, Result], report: Path) -> str:
    """The document as text."""
    content = {
        "version": VERSION,
        "study": study.name,
        "verdicts": [verdict(study, f) for f in found if f.plan.judged],
        "shown": [shown(f) for f in found if not f.plan.judged],
        "axes": axes(study.runs, results),
        "runs": [row(results[run.digest]) for run in study.runs if run.digest in results],
        "report": str(report),
    }
    return json.dumps(content, indent=1, allow_nan=False)


def verdict(study: Study, finding: Finding) -> dict[str, Any]:
    """A judged quantity; `code`, `numbers`, `failed` and `wanted` are what `reason` says in words."""
    expectation, r = finding.plan.expectation, finding.verdict.reason
    order = expectation.order if expectation else None
    return {
        **shown(finding),
        "expected": expectation.kind if expectation and order is None else order,
        "verdict": str(finding.verdict.outcome),
        "code": str(r.code),
        "numbers": {name: list(n) if isinstance(n, tuple) else n for name, n in r.numbers.items()},
        "failed": [ended(end) for end in r.failed],
        "wanted": {**asdict(r.wanted), "command": commands.command(study, finding)} if r.wanted else None,
        "reason": commands.reason(study, finding),
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
        "coarser": found.coarser,
        "cells": found.cells,
        "where": stalls.where(found),
        "order": found.order,
        "before": list(found.before),
        "named": [str(cause.code) for cause in found.named],
        "causes": [cause(each) for each in found.causes],
        "ended": ended(found.ended) if found.ended else None,
    }


def cause(found: Cause) -> dict[str, Any]:
    """A cause of a stall; `measured` says in words what its numbers are."""
    return {
        "code": str(found.code),
        "name": stalls.name(found),
        "finding": str(found.finding),
        "weight": found.weight,
        "numbers": found.numbers,
        "peer": found.peer.method if found.peer else None,
        "measured": stalls.measured(found),
    }


def ended(end: Ended) -> dict[str, Any]:
    """A level without an error."""
    return {"h": end.h, "replicate": end.replicate, "failure": failure(end.failure)}


def failure(found: Failure) -> dict[str, Any]:
    """What ended a run, as codes and numbers."""
    return {**asdict(found), "cell": list(found.cell) if found.cell else None}


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
        "failure": failure(result.failure) if result.failure else None,
        "reason": failures.failure(result.failure) if result.failure else "",
        "errors": {q: {n: result.errors[q][n] for n in NORMS} for q in QUANTITIES} if result.errors else None,
        "steps": result.steps,
        "particles": result.particles,
        "crossings": result.crossings,
        "gap": result.gap,
        "wall_s": result.wall_s,
    }
