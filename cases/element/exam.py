"""`verify material`: element tests of one material as an Examination, with errors and orders in the strain step."""

from dataclasses import asdict, dataclass
from enum import StrEnum
from math import log2
from typing import Any

import numpy as np

from mpm_verify.cases.element.checks import law_checks
from mpm_verify.cases.element.curves import columns, start
from mpm_verify.cases.element.drawn import drawn
from mpm_verify.cases.element.element import Element
from mpm_verify.cases.element.exact import Columns, exact
from mpm_verify.cases.element.paths import ElementTest, Followed, Stopped, follow
from mpm_verify.cases.harness.checks import Check, Examination, Remark
from mpm_verify.cases.harness.environment import environment
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.material.drucker_prager import DruckerPrager
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb
from mpm_verify.solver.material.ubcsand import Ubcsand, out_of_range

DOUBLED, FINE = (1, 2, 4, 8, 16), 64  # steps of the study, and of what stands for the truth where nothing is known
ROUND_OFF = 1e-9  # relative errors below it have no order


class ElementRemark(StrEnum):
    """What came out, what one should know of each test, and what parameters do."""

    TESTS = "element.tests"
    UNJUDGED = "element.unjudged"  # nothing is known of the path
    EXACT = "element.exact"  # tests without an error in any number of steps
    ORDERS = "element.orders"
    FIRST_ORDER = "element.first_order"  # is expected of a return along the stress at the end of a step
    FAILED = "element.failed"
    AGAINST = "element.against"  # what errors are against: a source
    AGAINST_OWN = "element.against_own"  # the test's own curve with more steps
    ROUND_OFF = "element.round_off"
    NO_ORDER = "element.no_order"
    ORDER = "element.order"
    ZZ_WITHIN = "element.zz_within"  # the range of the principal stresses in the plane, in all steps
    ZZ_OUTSIDE = "element.zz_outside"
    UNDEFORMED = "element.undeformed"
    OR_MORE = "element.or_more"
    NO_EFFECT = "element.no_effect"
    NO_EFFECT_PRIMARY = "element.no_effect_primary"  # in primary loading
    AFTER_REVERSAL = "element.after_reversal"
    CORRELATION = "element.correlation"
    OUR_READING = "element.our_reading"


@dataclass(frozen=True)
class ElementStudy:
    """One test: its curve, the exact one and its source, the errors at each number of steps, and the last order."""

    test: ElementTest
    curve: Columns
    failed: Stopped | None
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


def study(law: Any, test: ElementTest, stress: float, steps: int) -> ElementStudy:
    """The test with once, twice, ... sixteen times the steps."""
    element, begin = Element(law), start(law, test, stress)
    counts = tuple(n * test.steps(steps) for n in DOUBLED)
    runs = [follow(element, test, n, begin) for n in counts]
    known = exact(law, test, stress)
    truth, source = known or (None, "")
    if truth is None and not any(run.failed for run in runs):
        finest = follow(element, test, FINE * counts[0], begin)
        truth_end = None if finest.failed else columns(test, finest)
    else:
        truth_end = truth
    errors = tuple(distance(test, run, truth_end) for run in runs)
    return ElementStudy(test, columns(test, runs[-1]), first_failure(runs), truth, source, counts, errors)


def first_failure(runs: list[Followed]) -> Stopped | None:
    """Why the finest run of those that ended early did."""
    return next((run.failed for run in reversed(runs) if run.failed), None)


def distance(test: ElementTest, run: Followed, truth: Columns | None) -> float:
    """Error at the end of the path: of s and t over the largest stress, of the volume over the largest strain."""
    if run.failed or truth is None:
        return float("nan")
    mine = columns(test, run)
    size = max(float(np.abs([truth["s"], truth["t"]]).max()), 1e-300)
    stress = max(abs(mine[name][-1] - truth[name][-1]) for name in ("s", "t")) / size
    length = max(float(np.abs(run.strain).max()), 1e-300)
    return float(max(stress, abs(mine["ev"][-1] - truth["ev"][-1]) / length))


def checks(law: Any, studied: ElementStudy) -> list[Check]:
    """Each test ends, is as close to the exact curve as its order says, and of the order that the law has."""
    group, found = studied.test.title, []
    if studied.failed:
        at = f"step {studied.failed.step} of {studied.failed.steps}"
        return [Check(group, f"early end, at {at}", float("nan"), 0.0, "absolute", "all steps solved")]
    finest = studied.errors[-1]
    if studied.truth is not None:
        second = 1e-6 * (1600 / studied.steps[-1]) ** 2  # what order 2 makes of 1e-6 in 1600 steps
        allowed = max(second, ROUND_OFF) if isinstance(law, Ubcsand) else ROUND_OFF
        found.append(Check(group, "error at the end, finest", finest, allowed, "at most", studied.source))
    if isinstance(law, Ubcsand) and not studied.test.cyclic and not len(studied.test.points):
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
        f"material-{specification}", f"Element tests of {specification}", command,
        tuple(lead(law, studies, found) + [remark for one in studies for remark in notes(law, one)]),
        tuple(found), parameters(law, stress, steps), origins(law), environment(), drawn(law, studies, stress),
    )  # fmt: skip


def lead(law: Any, studies: list[ElementStudy], found: list[Check]) -> list[Remark]:
    """What came out: how many checks, which orders, what is exact."""
    missed = sum(check.outcome != "PASS" for check in found)
    counts = {"tests": len(studies), "checks": len(found), "missed": missed}
    told = [Remark(ElementRemark.TESTS if found else ElementRemark.UNJUDGED, counts)]
    flat = sum(max(one.errors) <= ROUND_OFF for one in studies)
    orders = [one.order for one in studies if one.order == one.order]
    if flat:
        told.append(Remark(ElementRemark.EXACT, {"tests": flat}))
    if orders:
        told.append(Remark(ElementRemark.ORDERS, {"least": min(orders), "most": max(orders)}))
        if isinstance(law, MohrCoulomb | DruckerPrager):
            told.append(Remark(ElementRemark.FIRST_ORDER))
    return told


def notes(law: Any, one: ElementStudy) -> list[Remark]:
    """What the errors are held against, what came out, and how much of the path is the plane's alone to judge."""
    group, stopped = one.test.title, one.failed
    found = []
    if stopped:
        where = {"left": stopped.left, "step": stopped.step, "steps": stopped.steps}
        found.append(Remark(ElementRemark.FAILED, {"cause": stopped.cause, **where}, group))
    if one.source:
        found.append(Remark(ElementRemark.AGAINST, {"source": one.source}, group))
    else:
        found.append(Remark(ElementRemark.AGAINST_OWN, {"times": FINE}, group))
    if max(one.errors) <= ROUND_OFF:
        found.append(Remark(ElementRemark.ROUND_OFF, {"largest": max(one.errors)}, group))
    elif np.isnan(one.order):
        found.append(Remark(ElementRemark.NO_ORDER, {}, group))
    else:
        found.append(Remark(ElementRemark.ORDER, {"order": one.order}, group))
    outside = beyond(law, one)
    if outside is not None:
        code = ElementRemark.ZZ_OUTSIDE if outside else ElementRemark.ZZ_WITHIN
        found.append(Remark(code, {"fraction": outside}, group))
    return found


def beyond(law: Any, one: ElementStudy) -> float | None:
    """Fraction of the finest run's steps in which zz leaves the plane's range; None of a material that sees zz."""
    if not isinstance(law, Ubcsand) or len(one.curve["s"]) < 2:
        return None
    sigma = np.column_stack([-one.curve["sx"], -one.curve["sy"], -one.curve["sz"], one.curve["tau"]])
    return float(np.mean(out_of_range(sigma[1:])))


def parameters(law: Any, stress: float, steps: int) -> dict[str, float | str]:
    """Parameters of the material and of the tests."""
    own: dict[str, float | str] = dict(asdict(law))
    return own | {"confining stress": 0.0 if hasattr(law, "energy") else stress, "steps of the coarsest run": steps}


def origins(law: Any) -> dict[str, str]:
    """Codes for where a value comes from, and whether it has an effect."""
    found: dict[str, str] = {"steps of the coarsest run": ElementRemark.OR_MORE}
    if hasattr(law, "energy"):
        found["confining stress"] = ElementRemark.UNDEFORMED
    if isinstance(law, Ubcsand):
        idle = ElementRemark.NO_EFFECT if law.reversal else ElementRemark.NO_EFFECT_PRIMARY
        found |= {f"hfac{n}": idle for n in range(1, 7)}
        found |= {"Rf": ElementRemark.CORRELATION, "reversal": ElementRemark.OUR_READING}
        if law.reversal:
            found |= dict.fromkeys(("hfac1", "hfac2"), str(ElementRemark.AFTER_REVERSAL))
    return found
