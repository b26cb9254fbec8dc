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

from mpm_verify.cases.element.axes import PLANE_TESTS, TRIAXIAL_TESTS
from mpm_verify.cases.element.begin import begin
from mpm_verify.cases.element.element import SPACE
from mpm_verify.cases.element.exam import examination
from mpm_verify.cases.element.execute import test_of
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.cases.element.resolved import check_digits, check_stress
from mpm_verify.cases.element.run import AXES, CONFINED, PATH, PROPERTIES, ElementResult, ElementRun
from mpm_verify.cases.element.space import takes
from mpm_verify.cases.element.study import ElementStudy
from mpm_verify.cases.harness.build import Asked
from mpm_verify.cases.harness.checks import Check, Examination, gathered
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.cases.harness.study import Study
from mpm_verify.solver.plugins import MATERIALS, create, label
from mpm_verify.solver.plugins import canonical as canonical_name

__all__ = ["AXES", "Result", "Run", "canonical", "check", "examine", "parts", "title"]

COMMAND = "material {run.material}"

Run, Result = ElementRun, ElementResult
Key = tuple[str, float, str, int]  # material, stress, start and steps


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
        if run.test != PROPERTIES:
            check_test(run, test_of(run))
        if run.stress != CONFINED and create(MATERIALS, run.material).energy is not None:
            raise ValueError(
                f"stress = {run.stress:g}: a material with a stress from F starts undeformed; leave stress out"
            )


def check_test(run: ElementRun, test: ElementTest) -> None:
    """Raise ValueError for a test that the material cannot be put through, or a start that it cannot have."""
    material = create(MATERIALS, run.material)
    what = run.path or run.test
    out = test.size == SPACE or (test.motion and (test.points[:, 3] != 1).any())
    if out and not takes(material):
        why = "keeps a void strain" if getattr(material, "void", 0) else "is in plane strain"
        raise ValueError(f"{what} strains zz, and {run.material} {why} here; choose a test or path without")
    if test.motion and out and material.rate == "truesdell":
        raise ValueError(f"{what} strains zz, which rate=truesdell does not carry here; choose another rate")
    if run.start != "isotropic" and material.energy is not None:
        raise ValueError(f"start = {run.start}: a material with a stress from F starts undeformed; leave start out")
    if run.start != "isotropic" or test.mixed:
        begin(material, test, run.stress, run.start)
    check_digits(material, test)
    if run.start != "none" and not run.path:
        check_stress(material, test, run.stress, run.steps)


def parts(asked: Asked) -> list[Asked]:
    """One for each material where tests are not asked for: those that can be strained out of the plane do it too."""
    if "test" in asked.values or "path" in asked.values:
        return [asked]
    found = []
    for name in asked.values.get("material", (ElementRun.material,)):
        tests = (*PLANE_TESTS, *(TRIAXIAL_TESTS if takes(create(MATERIALS, name)) else ()), PROPERTIES)
        found.append(replace(asked, values={**asked.values, "material": (name,), "test": tests}))
    return found


def examine(study: Study[ElementRun], results: Mapping[str, ElementResult], store: Store) -> ElementAnalysis:
    """Judge what is stored, one material, stress and number of steps after the other."""
    groups: dict[Key, list[ElementResult]] = {}
    for run in study.runs:
        if run.digest in results:
            groups.setdefault((run.material, run.stress, run.start, run.steps), []).append(results[run.digest])
    return ElementAnalysis({named(key, list(groups)): _one(study, mine, store) for key, mine in groups.items()})


def named(key: Key, among: Sequence[Key]) -> str:
    """Material, stress, start and steps of one among several, as far as they tell it apart: `ubcsand, 20 steps`."""
    material, stress, start, steps = key
    materials, stresses, starts, counts = (len(set(values)) for values in zip(*among, strict=True))
    distinct = len({label(one) for one, *_ in among}) == materials  # not of two files of one name
    words = [label(material) if distinct else material] * (materials > 1)
    words += [f"{stress:g} Pa"] * (stresses > 1) + [f"start {start}"] * (starts > 1) + [f"{steps} steps"] * (counts > 1)
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
