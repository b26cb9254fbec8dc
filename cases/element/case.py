"""Element tests: one element of a constitutive model, driven without a grid through paths of strain and stress.

Each test is run with once to sixteen times the steps; errors and orders are those of its end. What is known of a model
beside curves (tables, limits, invariants) is a test of its own, `properties`.
The contract of a case is told in cases/harness/contract.py.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.cases.element.exam import examination
from mpm_verify.cases.element.execute import execute, test_of
from mpm_verify.cases.element.run import AXES, CONFINED, PROPERTIES, ElementResult, ElementRun
from mpm_verify.cases.element.study import ElementStudy
from mpm_verify.cases.harness.checks import Check, Examination
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.cases.harness.study import Study
from mpm_verify.solver.plugins import MATERIALS, create, label
from mpm_verify.solver.plugins import canonical as canonical_name

__all__ = ["AXES", "Result", "Run", "canonical", "check", "examine", "execute", "title"]

Run, Result = ElementRun, ElementResult


@dataclass(frozen=True)
class ElementAnalysis:
    """An Examination of each material, stress and number of steps, by what tells them apart."""

    examinations: Mapping[str, Examination]

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of all materials, named by what tells them apart where there are several."""
        return tuple(check for one in self.examinations.values() for check in one.checks)


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
    several = len(groups) > 1
    found = {}
    for (material, stress, steps), mine in groups.items():
        name = f"{label(material)}, {stress:g} Pa, {steps} steps" if several else label(material)
        found[name] = _one(study, mine, store, several * f"{name}: ")
    return ElementAnalysis(found)


def _one(study: Study[ElementRun], results: Sequence[ElementResult], store: Store, before: str) -> Examination:
    """Examination of results that have their material in common."""
    run = results[0].run
    tests = [one for result in results if result.run.test != PROPERTIES and (one := read(result, store))]
    known = tuple(check for result in results for check in result.checks)
    reads = [result.read for result in results if result.read]
    return examination(study, run, create(MATERIALS, run.material), tests, known, reads, results[0].environment, before)


def read(result: ElementResult, store: Store) -> ElementStudy | None:
    """Stored test; None where its curves cannot be read."""
    try:
        arrays = store.arrays(result.digest)
    except StoreError:
        return None
    curve, exact = (
        {name[len(kind) + 1 :]: np.asarray(values) for name, values in arrays.items() if name.startswith(f"{kind}/")}
        for kind in ("curve", "exact")
    )
    return ElementStudy(
        test_of(result.run), curve, result.stopped, exact or None, result.source, result.counts, result.step_errors
    )
