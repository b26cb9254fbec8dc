"""`verify material`: element tests of one law as an Examination, with errors and orders in the strain step."""

from dataclasses import asdict, dataclass
from math import log2
from typing import Any

import numpy as np

from mpm_verify.cases.element.checks import law_checks
from mpm_verify.cases.element.curves import columns, start
from mpm_verify.cases.element.drawn import drawn
from mpm_verify.cases.element.element import Element
from mpm_verify.cases.element.exact import Columns, exact
from mpm_verify.cases.element.paths import ElementTest, Followed, follow
from mpm_verify.cases.harness.checks import Check, Examination
from mpm_verify.cases.harness.environment import environment
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.material.drucker_prager import DruckerPrager
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb
from mpm_verify.solver.material.ubcsand import Ubcsand, out_of_range
from mpm_verify.solver.plugins import split

DOUBLED, FINE = (1, 2, 4, 8, 16), 64  # steps of the study, and of what stands for the truth where nothing is known
ROUND_OFF = 1e-9  # relative errors below it have no order
FIRST = (
    "First order is expected of this law: it returns along the stress at the end of a step, and costs an order where "
    "the direction of the stress turns."
)


@dataclass(frozen=True)
class ElementStudy:
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


def study(law: Any, test: ElementTest, stress: float, steps: int) -> ElementStudy:
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
    return ElementStudy(test, columns(test, runs[-1]), first_failure(runs), truth, source, counts, errors)


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


def checks(law: Any, studied: ElementStudy) -> list[Check]:
    """Each test ends, is as close to the exact curve as its order says, and of the order that the law has."""
    group, found = studied.test.title, []
    if studied.failed:
        return [Check(group, f"ends early: {studied.failed}", float("nan"), 0.0, "absolute", "every step is solved")]
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
        f"material-{specification}", f"Element tests of {specification}", command, lead(law, studies, found),
        tuple(found), parameters(law, stress, steps), {one.test.title: words(law, one) for one in studies},
        environment(), drawn(law, studies, stress), remarks=(*rate_given(specification), *read(tests)),
    )  # fmt: skip


def rate_given(specification: str) -> tuple[str, ...]:
    """A line on an objective rate that is asked for, which no path of strains can tell from another."""
    given = next((item for item in split(specification)[1].split(",") if item.startswith("rate=")), "")
    if not given:
        return ()
    return (
        f"{given} changes nothing here: along a path of strains the law works in its own frame, and nothing turns; "
        "verify objectivity tells the rates apart.",
    )


def read(tests: list[ElementTest]) -> tuple[str, ...]:
    """Lines on what was read of a path's file, and what was not."""
    lines = []
    for source in (test.source for test in tests if test.source):
        used, zero, unused = (", ".join(names) for names in (source.used, source.zero, source.unused))
        largest = f"{source.largest:.3g} ({100 * source.largest:.3g} %)"
        lines.append(f"{used} are read of {source.name}; the largest strain is {largest}.")
        if zero:
            lines.append(f"{zero}: zero in every row, as in plane strain, which is what is computed.")
        if unused:
            lines.append(f"not used of {source.name}: {unused}.")
    return tuple(lines)


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
        if isinstance(law, MohrCoulomb | DruckerPrager):
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
    if not isinstance(law, Ubcsand) or len(one.curve["s"]) < 2:
        return ""
    sigma = np.column_stack([-one.curve["sx"], -one.curve["sy"], -one.curve["sz"], one.curve["tau"]])
    share = 100 * float(np.mean(out_of_range(sigma[1:])))
    if share == 0:
        return "zz is within the range of the principal stresses in the plane in all steps."
    return (
        f"zz is outside the range of the principal stresses in the plane in {share:.3g} % of the steps: there the "
        "largest shear is on other planes, which this law does not look at."
    )


def parameters(law: Any, stress: float, steps: int) -> dict[str, str]:
    """Of the law, with what one should know of them, and of the tests."""
    own = {key: value if isinstance(value, str) else f"{value:.10g}" for key, value in asdict(law).items()}
    told = remarks(law) if isinstance(law, Ubcsand) else {}
    own |= {key: f"{own[key]} ({remark})" for key, remark in told.items()}
    confined = "the law starts undeformed" if hasattr(law, "energy") else f"{stress:g}"
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
