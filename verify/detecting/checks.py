"""Checks that a campaign asks: studies of the cases, the exactness battery, and known answers of what judges.

Each gives an outcome and a code for the first thing that is wrong. Of a study only the runs that what was planted can
change are run: a run is named by what computes it, and the Results of the sound package are there.
"""

import shutil
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from mpm_verify.cases.exact import battery, body
from mpm_verify.cases.harness.analysis import Analysis, analyse
from mpm_verify.cases.harness.build import Asked, make, union
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.runner import check_result
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.solver.plugins import PROBLEMS, create
from mpm_verify.verify.detecting import known, rule, stored

PASS, FAIL = str(Outcome.PASS), str(Outcome.FAIL)
Answer = tuple[str, str]
SOILS = ("mohr_coulomb", "drucker_prager", "ubcsand", "hypoelastic", "linear_elastic")
MODELS = ("neo_hookean", "hencky_rate", "mohr_coulomb")
RATE_FORM = ("mohr_coulomb", "drucker_prager", "ubcsand")
FRICTIONLESS = (
    "mohr_coulomb:phi=0,c=1000",
    "mohr_coulomb:phi=0,c=1000,sigma_t=1e5",
    "drucker_prager:phi=0,c=1000",
    "drucker_prager:phi=0,c=1000,cone=compression",
)
DILATANT = ("drucker_prager:psi=20",)
VARIANTS = (
    "mohr_coulomb:c=1000,sigma_t=500",
    "mohr_coulomb:c=1000,sigma_t=1e6",
    "mohr_coulomb:void=1",
)  # cut-off, apex, void
OTHERS = ("hencky", "drucker_prager", "ubcsand", "hypoelastic", "linear_elastic", *VARIANTS)
OF_MODEL = ("step", "stress", "history", "plastic", "hardening", "smoothing", "state")  # groups of exact tests
PATHS = ("oedometric", "biaxial", "shear_volume", "properties")
TRIAXIAL = ("triaxial_compression", "triaxial_extension")  # of soils in rate form
COARSE: Mapping[str, tuple[tuple[int, ...], tuple[int, ...]]] = {  # cells and particles per cell, by problem
    "cell_crossing": ((20,), (1, 4)),
    "sliding_block": ((4,), (4,)),
    "colliding_bars": ((8, 16, 32), (4,)),
    "self_weight": ((8, 12, 16), (4,)),
    "rolling_cylinder": ((16,), (4,)),
    "rankine": ((2,), (4,)),
    "footing:transits=100": ((3, 5, 7), (4,)),
}  # fast ones first
SMALL: Mapping[str, tuple[Any, ...]] = {
    "cells": (3,),
    "ppc": (4,),
    "aspect": (2.0,),
    "channel": (6.0,),
    "duration": (0.3,),
}


@dataclass(frozen=True)
class Subject:
    """Subject of the checks: a method, the folder with Results of the sound package, one for new ones, and which."""

    method: str
    sound: Path
    work: Path
    keep: bool


def study(subject: Subject, name: str, *asked: Asked, finish: int | None = None) -> tuple[Any, Any, Analysis]:
    """Study with its Results and what is judged; runs that the sound package has too are not run again."""
    made = union(asked, "", finish=finish)
    folder = (subject.sound if subject.keep else subject.work) / name
    store, results, case = Store(folder, made.case), {}, case_named(made.case)
    store.create(made)
    for run in made.runs:
        taken(subject.sound / name / "runs", store.runs, run.digest)
        found = store.get(run.digest)
        if found is None:
            found, arrays = case.execute(run)
            check_result(case, run, found, arrays)
            store.put(found, arrays)
        results[run.digest] = found
    return made, results, analyse(made, results, store)


def taken(sound: Path, runs: Path, digest: str) -> None:
    """Take a Result of the sound package, if it has that run."""
    for suffix in (".npz", ".json"):
        file = sound / f"{digest}{suffix}"
        if sound != runs and file.is_file():
            shutil.copy(file, runs / file.name)


def judged(subject: Subject, name: str, *asked: Asked, finish: int | None = None) -> Answer:
    """Outcome of a study, and the first thing in it that is as bad."""
    _, results, found = study(subject, name, *asked, finish=finish)
    ended = next((str(result.failure.kind) for result in results.values() if result.failure), "")
    for f in found.findings:
        if f.counts and f.verdict.outcome is found.outcome is not Outcome.PASS:
            return str(found.outcome), f"{f.plan.quantity}: {f.verdict.reason.code}{ended and f', {ended}'}"
    for check in found.checks:
        if check.outcome is found.outcome is not Outcome.PASS:
            return str(found.outcome), check.name
    return str(found.outcome), ""


def manufactured(solution: str) -> Callable[[Subject], Answer]:
    """Quick study of a manufactured solution: orders and recorded errors of u, v, F and sigma."""
    return lambda s: judged(s, solution, Asked("mms", {"method": (s.method,), "solution": (solution,)}, 1, True))


def first(asked: Iterable[Callable[[], Answer]]) -> Answer:
    """First answer that is a FAIL, without asking further; else the first that is no PASS."""
    found = (PASS, "")
    for ask in asked:
        answer = ask()
        if answer[0] == FAIL:
            return answer
        found = answer if found[0] == PASS else found
    return found


def exact(subject: Subject) -> Answer:
    """Exactness battery of the method: all of it with three models, and what hangs on the model with the others."""

    def whole(model: str) -> Answer:
        return judged(subject, "exact", Asked("exact", {"method": (subject.method,), "material": (model,)}))

    def part(model: str) -> Answer:
        tested = (one for group in OF_MODEL for one in battery.tested(group, body.Subject(subject.method, model)))
        wrong = next((one.test for one in tested if not one.passed), "")
        return (FAIL, f"{wrong}: {model}") if wrong else (PASS, "")

    return first([*(partial(whole, model) for model in MODELS), *(partial(part, model) for model in OTHERS)])


def material(subject: Subject) -> Answer:
    """Element tests of every constitutive model, along the paths that tell most in least time."""
    models = ("neo_hookean", *SOILS, *FRICTIONLESS, *DILATANT)
    for model in models:
        tests = PATHS + TRIAXIAL * (model.partition(":")[0] in RATE_FORM)
        asked = Asked("element", {"material": (model,), "test": tests, "steps": (50,)})
        outcome, evidence = judged(subject, f"element_{model}", asked)
        if outcome != PASS and not (outcome == str(Outcome.INCONCLUSIVE) and not evidence):  # nothing to judge
            return outcome, f"{model}: {evidence}"
    return PASS, ""


def objectivity(subject: Subject) -> Answer:
    """Rates and negative controls along prescribed motions."""
    case = case_named("objectivity")
    run = make(case, {"part": "kinematic"})
    store = Store((subject.sound if subject.keep else subject.work) / "objectivity", case.name)
    store.runs.mkdir(parents=True, exist_ok=True)
    taken(subject.sound / "objectivity" / "runs", store.runs, run.digest)
    result = store.get(run.digest)
    if result is None:
        result, arrays = case.execute(run)
        store.put(result, arrays)
    wrong = [check for check in result.checks if check.outcome is not Outcome.PASS]
    return (str(wrong[0].outcome), wrong[0].name) if wrong else (PASS, "")


def column(name: str, **more: tuple[Any, ...]) -> Callable[[Subject], Answer]:
    """Invariants of a small column for the method."""

    def ask(subject: Subject) -> Answer:
        limits = {"limit": (0.5,)} if subject.method.startswith("cpdi") else {}
        return judged(
            subject, name, Asked("column", {"method": (subject.method,), **SMALL, **limits, **more}), finish=0
        )

    return ask


def wave(subject: Subject) -> Answer:
    """Frequency of a bar against its closed form."""
    return judged(subject, "wave_bar", Asked("wave_bar", {"method": (subject.method,)}, 1, True))


def benchmark(subject: Subject) -> Answer:
    """Numbers of problems with a known answer on coarse grids; orders are not asked."""

    def ask(problem: str) -> Answer:
        cells, ppc = COARSE[problem]
        smoothing = create(PROBLEMS, problem).smoothings[:1]
        axes = {"problem": (problem,), "method": (subject.method,), "cells": cells, "ppc": ppc, "smoothing": smoothing}
        _, _, found = study(subject, "benchmark", Asked("benchmark", axes))
        return first(partial(answer, check) for check in found.checks)

    def answer(check: Check) -> Answer:
        return str(check.outcome), "" if check.outcome is Outcome.PASS else f"{check.group}: {check.name}"

    return first(partial(ask, problem) for problem in COARSE if may(problem, subject.method))


def may(problem: str, method: str) -> bool:
    """Whether something is known of a problem with a method on its coarse grids."""
    case, (*_, finest) = case_named("benchmark"), COARSE[problem][0]
    smoothing = create(PROBLEMS, problem).smoothings[0]
    run = make(case, {"problem": problem, "method": method, "cells": finest, "smoothing": smoothing})
    try:
        case.check([run])
    except ValueError:
        return False
    return any(held.least <= finest for held in run.stated.held(run))  # type: ignore[attr-defined]


CHECKS: Mapping[str, Callable[[Subject], Answer]] = {
    "axis_aligned": manufactured("axis_aligned"),
    "clamped_shear": manufactured("clamped_shear"),
    "exact": exact,
    "derivation": lambda s: known.derivation(),
    "material": material,
    "objectivity": objectivity,
    "wave_bar": wave,
    "benchmark": benchmark,
    "column": column("column", damping=(0.05,)),
    "smoothing": column("smoothing", smoothing=("full",), damping=(0.05,), damping_kind=("objective",)),
    "norms": lambda s: known.norms(),
    "rule": lambda s: rule.ask(),
    "store": lambda s: stored.store(s.work),
    "numbers": lambda s: stored.numbers(s.work),
}
QUICK = ("axis_aligned", "clamped_shear", "exact")
