"""`verify material`: element tests of one law as an Examination, with errors and orders in the strain step."""

from dataclasses import dataclass
from math import log2
from typing import Any

import numpy as np

from cases.checks import Check, Curves, Examination
from cases.element import Element
from cases.element_paths import ElementTest, Followed, follow
from cases.environment import environment
from cases.material_checks import law_checks
from cases.material_curves import columns, start
from cases.material_exact import Columns, exact
from solver._jit import use_threads
from solver.material.ubcsand import Ubcsand

DOUBLED, FINE = (1, 2, 4, 8, 16), 64  # steps of the study, and of what stands for the truth where nothing is known
ROUND_OFF = 1e-9  # relative errors below it have no order
DRAWN = 400  # points of a curve that are kept


@dataclass(frozen=True)
class Studied:
    """One test: its curve, the exact one or the finest, the errors at each number of steps, and the last order."""

    test: ElementTest
    curve: Columns
    failed: str
    truth: Columns | None
    source: str
    steps: tuple[int, ...]
    errors: tuple[float, ...]

    @property
    def order(self) -> float:
        """Between the two finest; NaN where the error is round-off, or a run has failed.

        Against the test's own curve the two before: one with a quarter of its steps shares too much of its error.
        """
        few, many = self.errors[-2:] if self.truth is not None else self.errors[-3:-1]
        return log2(few / many) if many > ROUND_OFF and few > 0 else float("nan")


def study(law: Any, test: ElementTest, stress: float, steps: int) -> Studied:
    """The test with once, twice, ... sixteen times the steps."""
    element, begin = Element(law), start(law, test, stress)
    counts = tuple(n * test.steps(steps) for n in DOUBLED)
    runs = [follow(element, test, n, begin) for n in counts]
    known = exact(law, test, stress)
    truth, source = known or (None, f"its own curve with {FINE} times the steps")
    if truth is None and not any(run.failed for run in runs):
        finest = follow(element, test, FINE * counts[0], begin)
        truth_end = None if finest.failed else columns(test, finest)
    else:
        truth_end = truth
    errors = tuple(distance(test, run, truth_end) for run in runs)
    return Studied(test, columns(test, runs[-1]), first_failure(runs), truth, source, counts, errors)


def first_failure(runs: list[Followed]) -> str:
    """Why a run ended early, of the finest that did."""
    return next((run.failed for run in reversed(runs) if run.failed), "")


def distance(test: ElementTest, run: Followed, truth: Columns | None) -> float:
    """Error at the end of the path: of s and t over the largest stress, of the volume over the largest strain."""
    if run.failed or truth is None:
        return float("nan")
    mine = columns(test, run)
    size = max(float(np.abs([truth["s"], truth["t"]]).max()), 1e-300)
    stress = max(abs(mine[name][-1] - truth[name][-1]) for name in ("s", "t")) / size
    length = max(float(np.abs(run.strain).max()), 1e-300)
    return float(max(stress, abs(mine["ev"][-1] - truth["ev"][-1]) / length))


def checks(law: Any, studied: Studied) -> list[Check]:
    """Each test ends, is as close to the exact curve as its order says, and of the order that the law has."""
    group, found = studied.test.title, []
    if studied.failed:
        return [Check(group, f"ends early: {studied.failed}", float("nan"), 0.0, "absolute", "every step is solved")]
    finest = studied.errors[-1]
    if studied.truth is not None:
        allowed = 1e-9 if not isinstance(law, Ubcsand) else 1e-3
        found.append(Check(group, "error at the end, finest", finest, allowed, "at most", studied.source))
    if isinstance(law, Ubcsand) and not studied.test.cyclic and finest > ROUND_OFF:
        found.append(Check(group, "order in the strain step", studied.order, 1.9, "at least", "midpoint scheme"))
    return found


def examine(
    specification: str, law: Any, tests: list[ElementTest], stress: float, steps: int, command: str
) -> Examination:
    """All tests of one law; the law's own tables and closed forms are checked whatever tests are chosen."""
    use_threads(1)  # four rows at a time
    studies = [study(law, test, stress, steps) for test in tests]
    found = [check for one in studies for check in checks(law, one)]
    found += law_checks(law)
    missed = sum(check.outcome != "PASS" for check in found)
    lead = f"{len(studies)} element tests, {len(found)} checks" + (
        f"; {missed} did not pass." if missed else ", all pass."
    )
    if not found:
        lead += " Nothing is known of this path, so nothing is judged."
    return Examination(
        f"material-{specification}", f"Element tests of {specification}", command, lead, tuple(found),
        parameters(law, stress, steps), {one.test.title: words(one) for one in studies}, environment(), curves(studies),
    )  # fmt: skip


def words(one: Studied) -> tuple[str, ...]:
    """What the errors are held against, and what came out."""
    end = f"It ends early: {one.failed}." if one.failed else ""
    if one.errors[-1] <= ROUND_OFF:
        order = "The error is round-off at any number of steps: each step is exact here, and there is no order."
    elif np.isnan(one.order):
        order = "There is no order to see."
    else:
        order = f"The order between the two finest is {one.order:.2f}."
    return tuple(filter(None, [end, f"Errors are against: {one.source}. {order}"]))


def curves(studies: list[Studied]) -> Curves:
    """`test/NAME` and `exact/NAME` columns, `errors/NAME`: steps, error; `kind/NAME`: what its axes are."""
    kept: Curves = {}
    for one in studies:
        every = max(1, len(one.curve["s"]) // DRAWN)
        kept[f"test/{one.test.name}"] = {name: values[::every] for name, values in one.curve.items()}
        if one.truth is not None:
            kept[f"exact/{one.test.name}"] = one.truth
        kept[f"errors/{one.test.name}"] = {"steps": np.array(one.steps, float), "error": np.array(one.errors)}
        kept[f"kind/{one.test.name}"] = {"shear": np.array([float(one.test.shear)])}
    return kept


def parameters(law: Any, stress: float, steps: int) -> dict[str, str]:
    """Of the law, and of the tests."""
    from dataclasses import asdict

    own = {key: value if isinstance(value, str) else f"{value:.10g}" for key, value in asdict(law).items()}
    confined = "the law starts undeformed" if hasattr(law, "energy") else f"{stress:g}"
    return own | {"confining stress": confined, "steps of the coarsest run": f"{steps} or a few more"}
