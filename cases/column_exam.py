"""A study of the column as an Examination: invariants of each run as checks, the paper's sentences, what refines."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np

from cases.checks import Check, Examination
from cases.column_claims import Claim, Ran, claims, families, shared, told
from cases.column_experiment import UNCERTAIN
from cases.column_run import ColumnResult, ColumnRun, ColumnStudy
from cases.richardson import Extrapolation, extrapolate
from cases.store import Store

BUDGET, AT_REST, DRIFT, SHRUNK = 0.01, 1e-4, 1e-9, 0.97
REFINES = {"cells": lambda run: 1 / run.cells, "courant": lambda run: run.courant, "ppc": lambda run: run.ppc**-0.5}
QUANTITIES = {"front_99": "front, 99 %", "front_999": "front, 99.9 %", "toe": "toe", "height": "height at the wall"}


@dataclass(frozen=True)
class Refined:
    """A refinement in one axis: levels finest first, and what three levels say at each place along it."""

    axis: str
    runs: str
    quantity: str
    levels: tuple[tuple[str, float], ...]
    found: tuple[Extrapolation, ...]  # of the finest three first


@dataclass(frozen=True)
class Collapse:
    """What a study holds: its results by digest, those that came to their end with their curves, and what they say."""

    study: ColumnStudy
    results: Mapping[str, ColumnResult]
    ran: tuple[Ran, ...]
    claims: tuple[Claim, ...]
    refined: tuple[Refined, ...]
    examination: Examination

    def label(self, run: ColumnRun) -> str:
        """A run by what the study varies; by its method, mesh and law where it varies nothing."""
        return shared(run, self.study.axes or ("method", "cells", "ppc", "law"))


def look(study: ColumnStudy, results: Mapping[str, ColumnResult], store: Store) -> Collapse:
    """Judge what is stored."""
    ended = [(run, results[run.digest]) for run in study.runs if run.digest in results]
    ran = tuple(Ran(run, one.values, curves(store, one)) for run, one in ended if one.status == "finished")
    said, refined = tuple(claims(ran, study.axes)), tuple(refinements(ran, study.axes))
    first = next(iter(results.values()), None)
    examination = Examination(
        f"column-{study.name}", study.title, study.command, lead(study, ran, said, len(ended)),
        tuple(checks(study, ran, results)), parameters(study, first), {}, first.environment if first else {},
    )  # fmt: skip
    return Collapse(study, results, ran, said, refined, examination)


def curves(store: Store, result: ColumnResult) -> dict[str, Any]:
    """Columns over time, by name."""
    arrays = store.arrays(result.digest)
    return {name[6:]: np.asarray(values, float) for name, values in arrays.items() if name.startswith("curve_")}


def checks(study: ColumnStudy, ran: Sequence[Ran], results: Mapping[str, ColumnResult]) -> list[Check]:
    """What holds whatever the experiment says: the worst of all runs, named."""
    there = [run for run in study.runs if run.digest in results]
    found = [Check("Runs", f"runs of {len(study.runs)} that came to their end", float(len(ran)), float(study.finish),
                   "at least", "declared by the study")]  # fmt: skip
    if not ran:
        return found
    axes = study.axes or ("method",)

    def worst(values: list[float]) -> tuple[str, float]:
        place = int(np.argmax(values))
        name = f" ({shared(ran[place].run, axes)})" if len(there) > 1 else ""
        return name, values[place]

    speed = [sqrt(2 * one.run.g * one.run.height) for one in ran]
    numbers = {
        "energy budget, residual over initial potential energy": (
            [one.values["unbalanced"] for one in ran], BUDGET, "at most", "every term is measured"),
        "momentum, particles less gravity, walls and damping, over m sqrt(2 g h)": (
            [one.values["most_momentum_lost"] / one.values["mass"] / v for one, v in zip(ran, speed, strict=True)],
            DRIFT, "at most", "conservation"),
        "mass, largest change over all": (
            [float(np.ptp(one.curves["mass"])) / one.values["mass"] for one in ran], 1e-6, "at most",
            "conservation; stored in single precision"),
        "work of walls that stand still, over initial potential energy": (
            [one.values["walls"] / float(one.curves["potential"][0]) for one in ran], 0.0, "at most",
            "they take what strikes them"),
        "kinetic energy of the grid at the end, over initial potential energy": (
            [one.values["on_grid"] / float(one.curves["potential"][0]) for one in ran], AT_REST, "at most",
            "run until it rests"),
    }  # fmt: skip
    for name, (values, bound, way, source) in numbers.items():
        which, value = worst(values)
        found.append(Check("Invariants", name + which, value, bound, way, source))  # type: ignore[arg-type]
    return found


def refinements(ran: Sequence[Ran], axes: Sequence[str]) -> list[Refined]:
    """Of mesh, time step and particle number, wherever a study has three levels or more."""
    found = []
    for axis in axes:
        for family in families(ran, axis) if axis in REFINES else ():
            levels = sorted(family, key=lambda one: REFINES[axis](one.run))
            words = shared(levels[0].run, [other for other in axes if other != axis])
            for key, name in QUANTITIES.items() if len(levels) > 2 else ():
                h, f = [REFINES[axis](one.run) for one in levels], [one.values[key] for one in levels]
                triples = tuple(extrapolate(h[k : k + 3], f[k : k + 3]) for k in range(len(h) - 2))
                shown = tuple((told(axis, getattr(one.run, axis)), v) for one, v in zip(levels, f, strict=True))
                found.append(Refined(axis, words, name, shown, triples))
    return found


def scatter(ran: Sequence[Ran], axes: Sequence[str]) -> list[tuple[str, str, int, float, float, float]]:
    """Family, quantity, runs, mean, standard deviation and range over where particles lie in their cells at first."""
    found = []
    for family in families(ran, "offset") if "offset" in axes else ():
        words = shared(family[0].run, [axis for axis in axes if axis != "offset"])
        for key, name in QUANTITIES.items() if len(family) > 2 else ():
            values = np.array([one.values[key] for one in family])
            found.append((words, name, len(values), float(values.mean()), float(values.std(ddof=1)),
                          float(np.ptp(values))))  # fmt: skip
    return found


def lead(study: ColumnStudy, ran: Sequence[Ran], said: Sequence[Claim], done: int) -> str:
    """What came out, in words."""
    words = [f"{len(ran)} of {len(study.runs)} runs came to their end."]
    if done - len(ran):
        words.append(f"{done - len(ran)} could not go on; the table says where and why.")
    if done < len(study.runs):
        words.append(f"{len(study.runs) - done} are still to be done: the same command goes on.")
    if said:
        found = [claim.reproduced for claim in said]
        open_ = f", {found.count(None)} cannot be told" if None in found else ""
        words.append(f"Sentences of the paper: {found.count(True)} reproduced, {found.count(False)} not{open_}.")
    shrunk = [one for one in ran if one.values["area"] < SHRUNK]
    if shrunk:
        words.append(f"The heap of {len(shrunk)} of them has less than {100 * SHRUNK:.0f} % of the column's area: "
                     "particles are closer together than the volumes they keep allow.")  # fmt: skip
    if len(ran) == 1:
        values = ran[0].values
        front, height = (values[name] for name in ("front_99", "height"))
        words.append(f"The front comes to {front:.3f} m, and the height at the wall is {height:.3f} m.")
    return " ".join([*words, UNCERTAIN])


def parameters(study: ColumnStudy, first: ColumnResult | None) -> dict[str, str]:
    """What all runs share."""
    from dataclasses import asdict

    run = asdict(study.runs[0])
    found = {key: told(key, value) if key in ("damping",) else str(value) for key, value in run.items()
             if key not in study.axes and key != "case"}  # fmt: skip
    laws = first.parameters if first and "law" not in study.axes else {}
    return found | {f"law: {key}": str(value) for key, value in laws.items()}
