"""The JSON document of --json. CI jobs read it: its shape changes only with VERSION, and verify/schema.json says it."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cases.study import NORMS, QUANTITIES, Result, Study
from cases.verdicts import Finding

VERSION = 1
SCHEMA = Path(__file__).with_name("schema.json")


def document(study: Study, found: Sequence[Finding], results: Mapping[str, Result], report: Path) -> str:
    """The document as text."""
    content = {
        "version": VERSION,
        "study": study.name,
        "verdicts": [verdict(f) for f in found if f.declared.judged],
        "shown": [shown(f) for f in found if not f.declared.judged],
        "runs": [row(results[run.digest]) for run in study.runs if run.digest in results],
        "report": str(report),
    }
    return json.dumps(content, indent=1, allow_nan=False)


def verdict(finding: Finding) -> dict[str, Any]:
    """A judged quantity."""
    expectation = finding.declared.expectation
    order = expectation.order if expectation else None
    return {
        **shown(finding),
        "expected": "diverges" if order is None else order,
        "verdict": str(finding.verdict.outcome),
        "reason": finding.verdict.reason,
    }


def shown(finding: Finding) -> dict[str, Any]:
    """What is measured of a quantity, judged or not."""
    d, v = finding.declared, finding.verdict
    return {
        "method": d.method,
        "solution": d.solution,
        "ppc": d.ppc,
        "quantity": d.quantity,
        "norm": d.norm,
        "observed": v.observed,
        "interval": None if v.interval is None else list(v.interval),
        "local_orders": list(v.local_orders),
    }


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
        "status": result.status,
        "reason": str(result.failure) if result.failure else "",
        "errors": {q: {n: result.errors[q][n] for n in NORMS} for q in QUANTITIES} if result.errors else None,
        "steps": result.steps,
        "particles": result.particles,
        "wall_s": result.wall_s,
    }
