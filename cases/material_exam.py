"""`verify material`: element tests of one law as an Examination, with errors and orders in the strain step."""

from dataclasses import dataclass
from math import cos, log2, radians, sin
from typing import Any

import numpy as np

from cases import ubcsand_exact as ubc
from cases.checks import Check, Curves, Examination
from cases.element import Element
from cases.element_paths import ElementTest, Followed, follow
from cases.environment import environment
from cases.material_checks import law_checks
from cases.material_curves import columns, start
from cases.material_exact import Columns, exact
from solver._jit import use_threads
from solver.material.mohr_coulomb import MohrCoulomb
from solver.material.ubcsand import Ubcsand

DOUBLED, FINE = (1, 2, 4, 8, 16), 64  # steps of the study, and of what stands for the truth where nothing is known
ROUND_OFF = 1e-9  # relative errors below it have no order
MARKED = 5e3  # Pa, the confining stress of the reference tables
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
        """Between the two finest that are above round-off; NaN where there are none.

        Against the test's own curve the last is left out: a quarter of that curve's steps shares too much of its error.
        """
        seen = [error for error in (self.errors if self.truth else self.errors[:-1]) if error > ROUND_OFF]
        return log2(seen[-2] / seen[-1]) if len(seen) > 1 else float("nan")


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
    if isinstance(law, Ubcsand) and not studied.test.cyclic:
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
    return Examination(
        f"material-{specification}", f"Element tests of {specification}", command, lead(studies, found), tuple(found),
        parameters(law, stress, steps), {one.test.title: words(one) for one in studies}, environment(),
        curves(studies) | strength(law) | marks(law, studies, stress),
    )  # fmt: skip


def lead(studies: list[Studied], found: list[Check]) -> str:
    """What came out, in words: how many checks, which orders, what is exact."""
    missed = sum(check.outcome != "PASS" for check in found)
    told = [f"{len(studies)} element tests, {len(found)} checks: {f'{missed} did not pass' if missed else 'all pass'}."]
    flat = sum(max(one.errors) <= ROUND_OFF for one in studies)
    orders = [one.order for one in studies if one.order == one.order]
    if flat:
        told.append(f"{flat} are exact in any number of steps.")
    if orders:
        told.append(f"Errors in the strain step fall with orders from {min(orders):.2f} to {max(orders):.2f}.")
    if not found:
        told = [f"{len(studies)} element tests. Nothing is known of this path, so nothing is judged.", *told[1:]]
    return " ".join(told)


def words(one: Studied) -> tuple[str, ...]:
    """What the errors are held against, and what came out."""
    end = f"It ends early: {one.failed}." if one.failed else ""
    if max(one.errors) <= ROUND_OFF:
        order = "The error is round-off at any number of steps: each step is exact here, and there is no order."
    elif np.isnan(one.order):
        order = "There is no order to see."
    else:
        order = f"The order is {one.order:.2f}."
    return tuple(filter(None, [end, f"Errors are against: {one.source}. {order}"]))


def curves(studies: list[Studied]) -> Curves:
    """`test/NAME` and `exact/NAME` columns, `errors/NAME`: steps, error; `kind/NAME`: what its axes are."""
    kept: Curves = {}
    for one in studies:
        every = max(1, len(one.curve["s"]) // DRAWN)
        kept[f"test/{one.test.name}"] = {name: values[::every] for name, values in one.curve.items()}
        if one.truth is not None:
            kept[f"exact/{one.test.name}"] = one.truth
        errors = {"steps": np.array(one.steps, float), "error": np.array(one.errors)}
        kept[f"errors/{one.test.name}"] = errors | {"order": np.array([one.order])}
        kept[f"kind/{one.test.name}"] = {"shear": np.array([float(one.test.shear)])}
    return kept


def strength(law: Any) -> Curves:
    """The line t = a + b s that a soil cannot pass in the plane, where the law has one."""
    if isinstance(law, Ubcsand):
        return {"strength": {"a": np.array([law.shift * law.eta_f]), "b": np.array([law.eta_f])}}
    if isinstance(law, MohrCoulomb):
        b = sin(radians(law.phi))
        return {"strength": {"a": np.array([law.c * cos(radians(law.phi))]), "b": np.array([b])}}
    return {}


def marks(law: Any, studies: list[Studied], stress: float) -> Curves:
    """Points of the reference tables on the curves of the law that they are for."""
    if law != Ubcsand() or stress != MARKED:
        return {}
    table = [
        (slip + ubc.elastic_shear(law, s, eta), eta * s, ev)
        for s, eta, slip, ev, _ in ubc.CONSTANT_S
        if s == MARKED and eta
    ]
    found = {"constant_s": table, "biaxial": [((g), (s1 - MARKED) / 2, ev) for _, s1, g, ev, *_ in ubc.BIAXIAL]}
    return {
        f"marks/{name}": dict(zip(("gamma", "t", "ev"), np.array(rows).T, strict=True))
        for name, rows in found.items()
        if name in {one.test.name for one in studies}
    }


def parameters(law: Any, stress: float, steps: int) -> dict[str, str]:
    """Of the law, and of the tests."""
    from dataclasses import asdict

    own = {key: value if isinstance(value, str) else f"{value:.10g}" for key, value in asdict(law).items()}
    confined = "the law starts undeformed" if hasattr(law, "energy") else f"{stress:g}"
    return own | {"confining stress": confined, "steps of the coarsest run": f"{steps} or a few more"}
