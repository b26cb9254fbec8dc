"""Cost of many methods: error, updates and time of each on its finest grid, and what a given error costs."""

from itertools import pairwise
from math import exp, log
from typing import Any

from mpm_verify.cases.harness.refinement import Series
from mpm_verify.reports.figures.convergence import methods
from mpm_verify.reports.frames import Record

MANY = 4  # methods, from which on a study is a comparison
TARGET = 0.01  # error over the exact rms at which costs are compared


def compares(record: Record) -> bool:
    """Whether the study has so many methods that a comparison by cost says something."""
    return len(methods(record)) >= MANY


def costs(record: Record) -> list[dict[str, Any]]:
    """Rows, one for each series: what its finest run took, and what an error of TARGET costs, if reached."""
    rows = []
    for s in record.series:
        results = [r for run in s.runs if (r := record.result(run)) and r.status == "finished"]
        if results:
            last = results[-1]
            rows.append(
                record.columns(s.first)
                | {"cells": last.run.cells}
                | {"relative_error": last.errors["u"]["rms"] / last.scale["u"], "updates": last.updates}
                | {"cpu_s": last.cpu_s, "ns_per_update": 1e9 * last.cpu_s / max(1, last.updates)}
                | {f"{kind}_at_{TARGET:g}": _at_target(record, s, kind) for kind in ("updates", "cpu_s")}
            )
    return rows


def _at_target(record: Record, series: Series, kind: str) -> float | None:
    """Cost at which the error first falls to TARGET, between two levels on straight lines in logarithms."""
    points = []
    for run, error in record.errors(series, "u", "rms"):
        result = record.result(run)
        if result and result.scale.get("u"):
            points.append((result.updates if kind == "updates" else result.cpu_s, error / result.scale["u"]))
    for (c0, e0), (c1, e1) in pairwise(points):
        if e1 <= TARGET < e0 and c0 > 0:
            return exp(log(c0) + (log(c1) - log(c0)) * (log(e0) - log(TARGET)) / (log(e0) - log(e1)))
    return points[0][0] if points and points[0][1] <= TARGET else None
