"""`verify material`: element tests of one law as an Examination, with errors and orders in the strain step."""

from dataclasses import asdict
from typing import Any

import numpy as np

from mpm_verify.cases.element.checks import law_checks
from mpm_verify.cases.element.drawn import drawn
from mpm_verify.cases.element.paths import ElementTest
from mpm_verify.cases.element.study import ROUND_OFF, ElementStudy, study
from mpm_verify.cases.harness.checks import Check, Examination
from mpm_verify.cases.harness.environment import environment
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.material.ubcsand import Ubcsand, out_of_range

FIRST = (
    "First order is expected of this law: it returns along the stress at the end of a step, and costs an order where "
    "the direction of the stress turns."
)


def checks(law: Any, studied: ElementStudy) -> list[Check]:
    """Each test ends, is as close to the exact curve as its order says, and of the order that the law has."""
    group, found = studied.test.title, []
    if studied.failed:
        return [Check(group, f"ends early: {studied.failed}", float("nan"), 0.0, "absolute", "every step is solved")]
    finest = studied.errors[-1]
    if studied.truth is not None:
        second = 1e-6 * (1600 / studied.steps[-1]) ** 2  # what order 2 makes of 1e-6 in 1600 steps
        allowed = max(second, ROUND_OFF) if law.order == 2 else ROUND_OFF
        found.append(Check(group, "error at the end, finest", finest, allowed, "at most", studied.source))
    if law.order == 2 and not studied.test.cyclic and not len(studied.test.points):
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
        f"material-{specification}", f"Element tests of {specification}", command, lead(law, studies, found),
        tuple(found), parameters(law, stress, steps), {one.test.title: words(law, one) for one in studies},
        environment(), drawn(law, studies, stress),
    )  # fmt: skip


def lead(law: Any, studies: list[ElementStudy], found: list[Check]) -> str:
    """What came out, in words: how many checks, which orders, what is exact."""
    missed = sum(check.outcome != "PASS" for check in found)
    told = [f"{len(studies)} element tests, {len(found)} checks: {f'{missed} did not pass' if missed else 'all pass'}."]
    flat = sum(max(one.errors) <= ROUND_OFF for one in studies)
    orders = [one.order for one in studies if one.order == one.order]
    if flat:
        told.append(f"{flat} {'is' if flat == 1 else 'are'} exact in any number of steps.")
    if orders:
        told.append(f"Errors in the strain step fall with orders from {min(orders):.2f} to {max(orders):.2f}.")
        if law.order == 1:
            told.append(FIRST)
    if not found:
        told = [f"{len(studies)} element tests. Nothing is known of this path, so nothing is judged.", *told[1:]]
    return " ".join(told)


def words(law: Any, one: ElementStudy) -> tuple[str, ...]:
    """What the errors are held against, what came out, and how much of the path is the plane's alone to judge."""
    end = f"It ends early: {one.failed}." if one.failed else ""
    if max(one.errors) <= ROUND_OFF:
        order = "The error is round-off at any number of steps: each step is exact here, and there is no order."
    elif np.isnan(one.order):
        order = "There is no order to see."
    else:
        order = f"The order is {one.order:.2f}."
    return tuple(filter(None, [end, f"Errors are against: {one.source}. {order}", beyond(law, one)]))


def beyond(law: Any, one: ElementStudy) -> str:
    """In which share of the finest run's steps zz leaves the plane's range, of a law that yields in the plane alone."""
    if law.name not in PLANE_ALONE or len(one.curve["s"]) < 2:
        return ""
    sigma = np.column_stack([-one.curve["sx"], -one.curve["sy"], -one.curve["sz"], one.curve["tau"]])
    share = 100 * float(np.mean(PLANE_ALONE[law.name](sigma[1:])))
    if share == 0:
        return "zz is within the range of the principal stresses in the plane in all steps."
    return (
        f"zz is outside the range of the principal stresses in the plane in {share:.3g} % of the steps: there the "
        "largest shear is on other planes, which this law does not look at."
    )


def parameters(law: Any, stress: float, steps: int) -> dict[str, str]:
    """Of the law, with what one should know of them, and of the tests."""
    own = {key: value if isinstance(value, str) else f"{value:.10g}" for key, value in asdict(law).items()}
    told = REMARKS[law.name](law) if law.name in REMARKS else {}
    own |= {key: f"{own[key]} ({remark})" for key, remark in told.items()}
    confined = "the law starts undeformed" if law.energy is not None else f"{stress:g}"
    return own | {"confining stress": confined, "steps of the coarsest run": f"{steps} or a few more"}


def remarks(law: Ubcsand) -> dict[str, str]:
    """What a value does not say: where it comes from, and whether it has an effect."""
    factors = {f"hfac{n}": "no effect" if law.reversal else "no effect in primary loading" for n in range(1, 7)}
    if law.reversal:
        factors |= dict.fromkeys(("hfac1", "hfac2"), "in the stiffness after a reversal")
    return factors | {
        "Rf": "not in the paper's Table 2; the default is the correlation 1.1 N^-0.15 at N = 10.7",
        "reversal": "1 is our reading of the cyclic law, whose rules are not public; 0 is primary loading alone",
    }


# By the name of the material: what its parameters' values do not say, and the stresses that it does not judge.
REMARKS = {"ubcsand": remarks}
PLANE_ALONE = {"ubcsand": out_of_range}
