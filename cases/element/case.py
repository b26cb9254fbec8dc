"""Element tests: one element of a constitutive model, driven without a grid through paths of strain and stress.

Each test is run with once to sixteen times the steps; errors and orders are those of its end. What is known of a model
beside curves (tables, limits, invariants) is a test of its own, `properties`.
The contract of a case is told in cases/harness/contract.py.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.cases.element.exam import examination
from mpm_verify.cases.element.execute import test_of
from mpm_verify.cases.element.run import AXES, CONFINED, PATH, PROPERTIES, ElementResult, ElementRun
from mpm_verify.cases.element.study import ElementStudy
from mpm_verify.cases.harness.checks import Check, Examination, gathered
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.cases.harness.study import Study
from mpm_verify.solver.plugins import MATERIALS, create, label
from mpm_verify.solver.plugins import canonical as canonical_name

__all__ = ["AXES", "Result", "Run", "canonical", "check", "examine", "title"]

Run, Result = ElementRun, ElementResult


@dataclass(frozen=True)
class ElementAnalysis:
    """An Examination of each material, stress and number of steps, by what tells them apart."""

    examinations: Mapping[str, Examination]

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of all materials."""
        return gathered(self.examinations)


def title(runs: Sequence[ElementRun]) -> str:
    """Title, such as `Element tests of mohr_coulomb`."""
    return f"Element tests of {', '.join(dict.fromkeys(label(run.material) for run in runs))}"


def canonical(values: dict[str, Any]) -> dict[str, Any]:
    """Values with the material without parameters at their defaults; of a path the whole path of its file."""
    values["material"] = canonical_name(MATERIALS, values.get("material", ElementRun.material))
    if values.get("path"):
        values["path"] = str(Path(values["path"]).resolve())
    return values


def check(runs: Sequence[ElementRun]) -> None:
    """Raise ValueError with one line for a file that cannot be read, or a stress that the material cannot have."""
    for run in runs:
        if run.path:
            test_of(run)
        if run.stress != CONFINED and create(MATERIALS, run.material).energy is not None:
            raise ValueError(
                f"stress = {run.stress:g}: a material with a stress from F starts undeformed; leave stress out"
            )


def examine(study: Study[ElementRun], results: Mapping[str, ElementResult], store: Store) -> ElementAnalysis:
    """Judge what is stored, one material, stress and number of steps after the other."""
    groups: dict[tuple[str, float, int], list[ElementResult]] = {}
    for run in study.runs:
        if run.digest in results:
            groups.setdefault((run.material, run.stress, run.steps), []).append(results[run.digest])
    return ElementAnalysis({named(key, list(groups)): _one(study, mine, store) for key, mine in groups.items()})


def named(key: tuple[str, float, int], among: Sequence[tuple[str, float, int]]) -> str:
    """Material, stress and steps of one among several, as far as they tell it apart: `ubcsand, 20 steps`."""
    material, stress, steps = key
    materials, stresses, counts = (len(set(values)) for values in zip(*among, strict=True))
    distinct = len({label(one) for one, *_ in among}) == materials  # not of two files of one name
    words = [label(material) if distinct else material] * (materials > 1)
    words += [f"{stress:g} Pa"] * (stresses > 1) + [f"{steps} steps"] * (counts > 1)
    return ", ".join(words) or label(material)


def _one(study: Study[ElementRun], results: Sequence[ElementResult], store: Store) -> Examination:
    """Examination of results that have their material in common."""
    run, tests, unread = results[0].run, [], []
    for result in results:
        if result.run.test != PROPERTIES:
            tests.append(read(result, store))
            unread += [] if tests[-1].curve else [f"runs/{result.digest}.npz"]
    known = [check for result in results for check in result.checks]
    reads = [result.read for result in results if result.read]
    model = create(MATERIALS, run.material)
    return examination(study, run, model, told_apart(tests), known, reads, unread, results[0].environment)


def told_apart(tests: Sequence[ElementStudy]) -> list[ElementStudy]:
    """The tests; where there are several paths of files, with a number each."""
    paths = [one for one in tests if one.test.name == PATH]
    if len(paths) < 2:
        return list(tests)
    numbers = {id(one): number for number, one in enumerate(paths, 1)}
    return [
        replace(one, test=replace(one.test, name=f"{PATH}_{number}", title=f"{one.test.title} ({number})"))
        if (number := numbers.get(id(one)))
        else one
        for one in tests
    ]


def read(result: ElementResult, store: Store) -> ElementStudy:
    """Stored test; without its curves where they cannot be read, which decide nothing."""
    try:
        arrays = store.arrays(result.digest)
    except StoreError:
        arrays = {}
    curve, exact = (
        {name[len(kind) + 1 :]: np.asarray(values) for name, values in arrays.items() if name.startswith(f"{kind}/")}
        for kind in ("curve", "exact")
    )
    return ElementStudy(
        test_of(result.run), curve, result.stopped, exact or None, result.source, result.counts, result.step_errors
    )
