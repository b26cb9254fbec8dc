"""Known answers of the order rule and of checks: sequences of known truth, and what each gate has to say of them."""

from collections.abc import Callable, Sequence
from math import nan

import numpy as np

from mpm_verify.cases.harness.analysis import EXIT
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.judging.fit import Slope, asymptotic_window, local_orders
from mpm_verify.cases.judging.order import Expectation, Level, Outcome, Quantity, Verdict, judge, judge_family
from mpm_verify.cases.judging.records import ReasonCode, Recorded
from mpm_verify.solver.failure import Failure, FailureKind

PASS, FAIL, OPEN = Outcome.PASS, Outcome.FAIL, Outcome.INCONCLUSIVE
CELLS = (8, 12, 16, 24, 32)
LONG = (8, 16, 32, 64, 128)
Answer = tuple[str, str]
Errors = Callable[[float], float]


def ruled(
    error: Errors, cells: Sequence[int] = CELLS, half: float | None = 1.01, floor: float = 0.0, **more: object
) -> Verdict:
    """Verdict on errors that follow a function of h; `half` times the finest is the error with half the time step."""
    levels = [Level(1 / n, (error(1 / n),)) for n in cells]
    halved = None if half is None else half * levels[-1].errors[0]
    return judge(levels, Expectation(2.0, **more), floor=floor, dt_halved=halved)  # type: ignore[arg-type]


def quadratic(h: float) -> float:
    """Error of clean second order."""
    return 3 * h**2


def ended(kind: FailureKind) -> Verdict:
    """Verdict where the finest run has failed."""
    levels = [Level(1 / n, (quadratic(1 / n),)) for n in CELLS[:-1]] + [Level(1 / 32, (), Failure(kind, 3))]
    return judge(levels, Expectation(2.0), floor=0.0, dt_halved=quadratic(1 / 32))


def stepwise(*orders: float) -> Verdict:
    """Verdict on errors with these local orders from level to level, each of half the cells."""
    errors = np.cumprod([1.0, *(2.0**-order for order in orders)])
    levels = [Level(2.0 ** -(3 + k), (float(error),)) for k, error in enumerate(errors)]
    return judge(levels, Expectation(2.0), floor=0.0, dt_halved=1.001 * float(errors[-1]))


def near(value: float) -> tuple[Recorded, ...]:
    """Recorded error of the finest cells."""
    return (Recorded(1 / 32, value, value),)


def verdicts() -> list[tuple[str, bool]]:
    """Whether each sequence gets the outcome that its truth deserves."""
    e = quadratic(1 / 32)
    return [
        ("second order passes", ruled(quadratic).outcome is PASS),
        ("second order over five doublings passes", ruled(quadratic, LONG).outcome is PASS),
        ("second order has order 2", abs((ruled(quadratic).observed or 0) - 2) < 1e-9),
        ("order 1 fails", ruled(lambda h: h).outcome is FAIL),
        ("order 1.5 fails", ruled(lambda h: h**1.5).outcome is FAIL),
        ("order 1.7 is no pass", ruled(lambda h: h**1.7, LONG).outcome is not PASS),
        ("order 2.6 is open", ruled(lambda h: h**2.6).reason.code is ReasonCode.ORDER_ABOVE),
        (
            "a falling order is no pass",
            ruled(lambda h: h ** (2 - 0.06 * np.log2(1 / (8 * h))), LONG).outcome is not PASS,
        ),
        ("a last order below the band is no pass", stepwise(2, 2, 2, 2, 1.85, 1.70).outcome is not PASS),
        ("a last order above the band is no pass", stepwise(2, 2, 2, 2.1, 2.26, 2.45).outcome is not PASS),
        ("only the last order is above the band", stepwise(2.19, 2.2, 2.19, 2.4).outcome is OPEN),
        ("a leak is no pass", ruled(lambda h: h**2 + 0.02 * h, LONG).outcome is not PASS),
        ("a floor is no pass", ruled(lambda h: h**2 + 5e-5, LONG).outcome is not PASS),
        ("a leak of most of the error fails", ruled(lambda h: h**2 + 0.4 * h, LONG).outcome is FAIL),
        ("a fifth of a lower order is no pass", ruled(lambda h: h**2 + 0.25 * h / 32).outcome is not PASS),
        ("a larger fraction of it names it", ruled(lambda h: h**2 + 0.3 * h / 128, LONG).outcome is not PASS),
        ("two levels are too few", ruled(quadratic, (8, 16)).reason.code is ReasonCode.TOO_FEW_LEVELS),
        ("three levels are too few", ruled(quadratic, (8, 16, 32)).reason.code is ReasonCode.TOO_FEW_LEVELS),
        ("no half time step is open", ruled(quadratic, half=None).reason.code is ReasonCode.TIME_STEP_UNKNOWN),
        ("half the time step, a half more", ruled(quadratic, half=1.5).reason.code is ReasonCode.TIME_STEP_COUPLED),
        ("half the time step, a fifth less", ruled(quadratic, half=0.8).reason.code is ReasonCode.TIME_STEP_COUPLED),
        ("near round-off", ruled(quadratic, floor=e / 50).reason.code is ReasonCode.NEAR_ROUND_OFF),
        ("clear of round-off", ruled(quadratic, floor=e / 200).outcome is PASS),
        ("a rise is no pass", ruled(lambda h: quadratic(max(h, 1 / 24))).outcome is not PASS),
        ("a rise is told", stepwise(2, -0.5, 2, 2).reason.code is ReasonCode.ERROR_RISES),
        ("an inverted particle fails", ended(FailureKind.INVERTED).outcome is FAIL),
        ("a missing level is open", ended(FailureKind.NOT_RUN).reason.code is ReasonCode.LEVEL_MISSING),
        ("the recorded error passes", ruled(quadratic, recorded=near(e), within=0.01).outcome is PASS),
        ("2 % above the recorded error", ruled(quadratic, recorded=near(e / 1.02), within=0.01).outcome is FAIL),
        ("2 % below the recorded error", ruled(quadratic, recorded=near(e / 0.98), within=0.01).outcome is FAIL),
        (
            "four times what was recorded elsewhere",
            ruled(quadratic, recorded=(Recorded(1 / 20, quadratic(1 / 20) / 4, quadratic(1 / 20) / 4),)).outcome
            is FAIL,
        ),
    ]


def confidence(verdict: Verdict) -> float:
    """Confidence of its interval, not a number where there is none."""
    found = verdict.reason.numbers.get("confidence", nan)
    return found if isinstance(found, float) else nan


def statistics() -> list[tuple[str, bool]]:
    """Whether orders, windows, intervals and the correction for several quantities are what tables say."""
    # five levels have two windows, and alpha / 4 for the longer one
    h, t3 = np.array([1 / 8, 1 / 16, 1 / 32]), 3.182446305284263  # Student, 3 degrees of freedom, 95 %
    low, high = Slope(2.0, 0.1, 3).interval(0.95)
    wrong, right = ([Level(1 / n, (quadratic(1 / n),)) for n in CELLS] for _ in range(2))
    known = Expectation(2.0, recorded=near(quadratic(1 / 32) / 1.5), within=0.01)
    items = [Quantity(wrong, known, 0.0, quadratic(1 / 32)), Quantity(right, Expectation(2.0), 0.0, quadratic(1 / 32))]
    second = confidence(judge_family(items)[1])
    both = [confidence(one) for one in judge_family([items[1], items[1]])]
    return [
        ("local orders", np.allclose(local_orders(h, 5 * h**1.5), 1.5, atol=1e-12)),
        ("interval of Student", abs(low - (2 - 0.1 * t3)) < 1e-9 and abs(high - (2 + 0.1 * t3)) < 1e-9),
        ("window of settled orders", asymptotic_window(np.array([1.0, 1.9, 2.85, 2.9])) == (1, 4)),
        ("no window where orders jump", asymptotic_window(np.array([2.0, 1.0, 1.9])) is None),
        ("one that fails leaves the confidence of the next", abs(second - (1 - 0.025 / 4)) < 1e-12),
        ("one that passes releases it", np.allclose(sorted(both), [1 - 0.05 / 4, 1 - 0.025 / 4], atol=1e-12)),
    ]


def checked() -> list[tuple[str, bool]]:
    """Whether checks and exit codes do what their names say."""

    def outcome(found: float, expected: float, way: str, within: float = 0.0) -> Outcome:
        return Check("g", "n", found, expected, way, "s", within).outcome  # type: ignore[arg-type]

    return [
        ("at most", outcome(1.0, 2.0, "at_most") is PASS and outcome(2.1, 2.0, "at_most") is FAIL),
        ("at least", outcome(2.0, 1.0, "at_least") is PASS and outcome(0.9, 1.0, "at_least") is FAIL),
        ("relative", outcome(101.0, 100.0, "relative", 0.02) is PASS and outcome(0.01, 0.02, "relative", 0.1) is FAIL),
        ("absolute", outcome(1.01, 1.0, "absolute", 0.02) is PASS and outcome(1.03, 1.0, "absolute", 0.02) is FAIL),
        ("not a number", outcome(nan, 1.0, "at_most") is Outcome.ERROR),
        (
            "exit codes",
            {str(key): code for key, code in EXIT.items()} == {"PASS": 0, "FAIL": 1, "INCONCLUSIVE": 3, "ERROR": 4},
        ),
    ]


def ask() -> Answer:
    """First known answer that is not given."""
    wrong = next((name for name, held in [*verdicts(), *statistics(), *checked()] if not held), "")
    return (str(FAIL), wrong) if wrong else (str(PASS), "")
