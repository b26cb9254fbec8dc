"""Benchmarks: problems with a known answer, each a file of cases/benchmark/problems.

Errors are judged by their order on refinement, numbers against closed forms, by the Richardson limit where a grid
misses them, and invariants to round-off. The contract of a problem is told in cases/benchmark/problem.py, that of a
case in cases/harness/contract.py.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import nan
from typing import Any

from mpm_verify.cases.benchmark.problem import AT_REST, Held, completed
from mpm_verify.cases.benchmark.run import Result, Run
from mpm_verify.cases.harness.build import Asked
from mpm_verify.cases.harness.checks import Check, Unjudged
from mpm_verify.cases.harness.refinement import Series, collect
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.cases.judging.richardson import extrapolate
from mpm_verify.solver.plugins import (
    METHODS,
    PROBLEMS,
    SMOOTHINGS,
    TRANSFERS,
    available,
    canonical_optional,
    create,
    label,
    split,
)
from mpm_verify.solver.plugins import canonical as canonical_name

__all__ = ["Result", "Run"]

COMMAND = "benchmark {run.problem}"

QUANTITIES, NORMS, JUDGED = ("u", "sigma"), ("rms",), None  # each problem has others, see `measures`
LEVELS = 3  # of a Richardson extrapolation


@dataclass(frozen=True)
class BenchmarkAnalysis:
    """Numbers of all problems, each beside what it is held against."""

    checks: tuple[Check, ...]


def title(runs: Sequence[Run]) -> str:
    """Title of a study, such as `Benchmarks: self_weight`."""
    names = dict.fromkeys(label(run.problem) for run in runs)
    return f"Benchmarks: {', '.join(names)}" + ", failing control" * all(run.control for run in runs)


def parts(asked: Asked) -> list[Asked]:
    """One for each problem, with its usual methods, cells and particles per cell."""
    found = []
    for name in asked.values.get("problem", available(PROBLEMS)):
        problem = create(PROBLEMS, name)
        usual = {
            "method": problem.methods,
            "cells": problem.quick if asked.quick else problem.cells,
            "ppc": (problem.ppc,),
            "smoothing": problem.smoothings,
        }
        found.append(replace(asked, values={**usual, **asked.values, "problem": (name,)}))
    return found


def canonical(values: dict[str, Any]) -> dict[str, Any]:
    """Specifications with only the parameters that differ from their defaults, and the problem's own material."""
    values["problem"] = canonical_name(PROBLEMS, values.get("problem", Run.problem))
    problem = create(PROBLEMS, values["problem"])
    values["material"] = completed(values.get("material") or problem.material, problem.constants)
    for key, package in {"method": METHODS, "transfer": TRANSFERS}.items():
        values[key] = canonical_name(package, values.get(key, getattr(Run, key)))
    values["smoothing"] = canonical_optional(SMOOTHINGS, values.get("smoothing", Run.smoothing))
    return values


def check(runs: Sequence[Run]) -> None:
    """Raise ValueError with one line for what a problem cannot have."""
    for run in runs:
        run.stated.check(run)


def measures(run: Run) -> tuple[tuple[str, str], ...]:
    """Quantity and norm of each error of the problem."""
    found: tuple[tuple[str, str], ...] = run.stated.measures(run)
    return found


def expectation(run: Run, quantity: str, norm: str) -> Expectation | None:
    """Expectation that the problem states; a failing control has that of what it spoils."""
    found: Expectation | None = run.stated.expectation(run, quantity, norm)
    return found


def examine(study: Study[Run], results: Mapping[str, Result], store: Store) -> BenchmarkAnalysis:
    """Hold the numbers of each refinement against what is known."""
    names = list(dict.fromkeys(run.problem for run in study.runs))
    return BenchmarkAnalysis(
        tuple(
            one
            for series in sorted(collect(study.runs), key=lambda series: names.index(series.first.problem))
            for held in series.first.stated.held(series.first)
            for one in checks(held, series, results)
        )
    )


def part(run: Run) -> str:
    """Group of the checks of a refinement, such as `self_weight, cpdi`, with all that is not as usual."""
    smoothed = "" if run.smoothing == Run.smoothing else f" {label(run.smoothing)}"
    named = f"{label(run.problem)}, {label(run.method)}{smoothed}"
    return ", ".join([named, *unusual(run)]) + ", failing control" * run.control


def unusual(run: Run) -> list[str]:
    """Values of a run that are not as usual: material, particles per cell, transfer, time step, positions."""
    problem = run.stated
    material = completed(problem.material, problem.constants)
    return [
        *([apart(run.material, material)] if run.material not in ("", material) else []),
        *([f"{run.ppc} per cell"] if run.ppc != problem.ppc else []),
        *([label(run.transfer)] if run.transfer != Run.transfer else []),
        *([f"courant {run.courant:g}"] if run.courant != Run.courant else []),
        *(["offset {:g},{:g}".format(*run.offset)] if any(run.offset) else []),
    ]


def apart(material: str, usual: str) -> str:
    """Material in short: its name if that is another, and the parameters that are."""
    (name, rest), (other, given) = split(material), split(usual)
    here, there = (dict(item.partition("=")[::2] for item in one.split(",") if item) for one in (rest, given))
    told = [f"{key}={value}" for key, value in here.items() if there.get(key) != value]
    told += [f"usual {key}" for key in there.keys() - here.keys()] if name == other else []
    return " ".join(([label(name)] if name != other or not told else []) + told)


def checks(held: Held, series: Series, results: Mapping[str, Result]) -> list[Check]:
    """Checks of one number of a refinement."""
    group = part(series.first)
    done = [(run, results[run.digest]) for run in series.runs if run.digest in results and run.cells >= held.least]
    if held.least and len(done) < LEVELS:
        return []

    def made(name: str, found: float, result: Result | None = None, unjudged: Unjudged = "") -> Check:
        failure = result.failure if result else None
        why = held.unjudged or unjudged or moving(held, [result] if result else [])
        return Check(group, name, found, held.expected, held.way, held.source, held.within, failure, why)

    if held.of == "each":
        each = [made(f"{held.name}, {run.cells} cells", value(held, one), one) for run, one in done]
        settled = held.limit and len(done) >= LEVELS
        return each + (checks(replace(held, of="limit", within=held.limit), series, results) if settled else [])
    if held.of == "finest" or len(done) < LEVELS:
        few: Unjudged = "few_grids" if held.of == "limit" else ""
        return [made(f"{held.name}, {run.cells} cells", value(held, one), one, few) for run, one in done[-1:]]
    failed = next((one for _, one in done[: -LEVELS - 1 : -1] if one.failure), None)
    if failed:
        return [made(held.name, nan, failed)]
    h, f = zip(*((1 / run.cells, value(held, one)) for run, one in done[: -LEVELS - 1 : -1]), strict=True)
    limit, why = extrapolate(h, f), moving(held, [one for _, one in done[-LEVELS:]])
    if limit.kind in ("converges", "equal"):
        return [made(f"{held.name}, limit", limit.limit, unjudged=why)]
    return [made(f"{held.name}, {done[-1][0].cells} cells", limit.finest, unjudged=why)]


def moving(held: Held, results: Sequence[Result]) -> Unjudged:
    """Mark of a number at rest where one of the runs that it is made of ended before."""
    return "not_at_rest" if held.rests and any(one.values.get(AT_REST) == 0 for one in results) else ""


def value(held: Held, result: Result) -> float:
    """Number of a run; not a number of one that failed."""
    return result.values.get(held.name, nan)
