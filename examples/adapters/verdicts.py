"""Verdicts of the rule, as it is now, on what is stored of a study of a public code."""

import json
from dataclasses import replace
from functools import cache

from study import COURANT, solver_of

from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.verdicts import findings
from mpm_verify.cases.mms.run import Result
from mpm_verify.reports.sentences import commands

EXPECTED = {"--as": ("method", str), "--order": ("order", float), "--precision": ("precision", str),
            "--time-step": ("time_step", str), "--courant": ("courant", float)}  # fmt: skip


@cache
def planned(study_text, version):
    """Study as the command plans it: its runs, and what is judged; of the study as a text, as it is asked for often."""
    study = json.loads(study_text)
    fixed = {"solver": solver_of(study), "solver_version": version, "ppc": 4}
    fixed |= {name: study[name] for name in ("solution", "material") if name in study}
    for option, text in options(study).items():
        name, kind = EXPECTED[option]
        fixed[name] = kind(text)
    values = {name: (value,) for name, value in fixed.items()} | {"cells": tuple(study["cells"])}
    return build(Asked("mms", values), "")


def options(study):
    """Options that say what is expected, with their texts."""
    return dict(zip(study["expect"][::2], study["expect"][1::2], strict=True))


def verdicts(study, found):
    """Outcome and reason of each quantity that has errors and can decide, by its name; u first."""
    return judged(json.dumps(study), json.dumps(found))


@cache
def judged(study_text, found_text):
    """Verdicts of a study and of what is stored of it, as texts: a page asks several times."""
    study, found = json.loads(study_text), json.loads(found_text)
    whole, usual = planned(study_text, found["version"]), float(options(study).get("--courant", COURANT))
    rows = {(row["cells"], True): row for row in found["runs"]}
    rows |= {(found["half"]["cells"], False): found["half"]} if found["half"] else {}
    levels = [(run, rows.get((run.cells, run.courant == usual))) for run in whole.runs]
    results = {run.digest: result(run, row) for run, row in levels if row}
    plans = tuple(one for one in whole.plans if (one.judged or one.refutes) and one.quantity in found["runs"][-1])
    plan = replace(whole, plans=plans)
    return {one.plan.quantity: (one.verdict.outcome.value, commands.reason(plan, one))
            for one in findings(plan, results)}  # fmt: skip


def result(run, row):
    """Finished run with the errors of a row."""
    errors = {name: {"rms": value} for name, value in row.items() if name not in ("cells", "floor")}
    return Result(run=run, digest=run.digest, status="finished", errors=errors, floor=row["floor"])
