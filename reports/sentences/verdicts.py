"""Verdicts in words: what was expected, what decided, and the run that would decide."""

from collections.abc import Callable, Sequence
from math import log2

from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.records import Action, Ended, Expectation, Outcome, Reason, ReasonCode, Wanted
from mpm_verify.reports import words
from mpm_verify.reports.sentences import failures
from mpm_verify.solver.failure import FailureKind

SMALL = 0.01  # fraction of the finest error that is not worth a word
ALIKE = 0.06  # distance from the ratio of errors that a cause has


def registered(e: Expectation | None) -> str:
    """Expectation with its band, `2.00 (1.80 to 2.30)`; `diverges`, `stalls`, `all runs fail: det F ≤ 0`; or a dash."""
    if e is None:
        return words.DASH
    if e.order is not None:
        return f"{words.order(e.order)} ({words.order(e.order - e.below)} to {words.order(e.order + e.above)})"
    return f"all runs fail: {failures.kind(e.failed)}" if e.failed else e.kind


def expected(e: Expectation) -> str:
    """Phrase on what the run was to show: `order 2`, `a stall`, `no convergence`."""
    if e.order is not None:
        return f"order {e.order:g}"
    return "a stall" if e.stall is not None else "no convergence"


def beside(found: Sequence[Finding]) -> str:
    """Sentence on what can refute, such as `v and F in rms can refute, and do not: 2 of 2 as registered.`."""
    can = [f for f in found if f.plan.refutes]
    if any(f.counts for f in can) or all(level.ended for f in can for level in f.levels):
        return ""
    names = list(dict.fromkeys(f.plan.quantity for f in can))
    listed = " and ".join([*([", ".join(names[:-1])] if names[1:] else []), names[-1]])
    passed = sum(f.verdict.outcome is Outcome.PASS for f in can)
    rest = ", the others undecided" if passed < len(can) else ""
    return f"{listed} in rms can refute, and do not: {passed} of {len(can)} as registered{rest}."


def reason(r: Reason, courants: tuple[float, ...] = ()) -> str:
    """Reason of a verdict, and after a colon the run that would decide where nothing does."""
    asked = advice(r.wanted, courants) if r.wanted else ""
    return f"{said(r)}: {asked}" if asked else said(r)


def said(r: Reason) -> str:
    """Phrase on what decided."""
    return SAID[r.code](r)


def shown(r: Reason) -> str:
    """Phrase on an error of which nothing is registered: what it did, and no word on what it should."""
    if r.code in (ReasonCode.CONVERGES, ReasonCode.NEITHER):
        alone = r.numbers["h_0"] == r.numbers["h_1"]
        return f"nothing is registered of it: {'one level finished' if alone else f'the error went {_path(r)}'}"
    if r.code in (ReasonCode.DIVERGES, ReasonCode.STALLS):
        return f"nothing is registered of it: {', and '.join(_seen(r))}"
    return said(r).replace("does not converge, as expected: ", "nothing is registered of it: ")


def advice(wanted: Wanted, courants: tuple[float, ...] = ()) -> str:
    """Option that asks for the run that would decide; `courants` are those of the study."""
    option = options(wanted, courants)
    if option:
        return f"run with {' '.join(option)}"
    if wanted.action is Action.FINISH:
        return "that run has to finish"
    if wanted.action is Action.HALVE_ALL:
        return "run all levels with half the time step"
    if wanted.action is Action.HALVE_FINEST:
        return f"run h={words.size(wanted.h)} with half the time step"
    return f"run h={words.size(wanted.h)}" + (
        " instead of the finest" if wanted.action is Action.REPLACE_FINEST else ""
    )


def options(wanted: Wanted, courants: tuple[float, ...] = ()) -> tuple[str, ...]:
    """Option of `verify mms` and its value; nothing where no option asks for that run.

    `courants`: those of the study, the largest, with which its levels are run, first.
    """
    if wanted.action in (Action.ADD_LEVEL, Action.REPLACE_FINEST) and wanted.cells:
        return "--cells", ",".join(map(str, wanted.cells))
    if wanted.action is Action.HALVE_ALL and courants:
        return "--courant", f"{courants[0] / 2:g}"
    if wanted.action is Action.HALVE_FINEST and courants:
        return "--courant", ",".join(f"{c:g}" for c in sorted({*courants, courants[0] / 2}, reverse=True))
    return ()


def ended(end: Ended) -> str:
    """Reason why a level has no error."""
    return failures.failure(end.failure) + failures.replicate(end.replicate)


def _as_expected(r: Reason) -> str:
    parts = [*([_order(r)] if "order" in r.numbers else []), _most(r)]
    return "; ".join(parts + ([_magnitude(r)] if "ratio" in r.numbers else []))


def _all_failed(r: Reason) -> str:
    last = r.failed[-1]
    return (
        f"does not converge, as expected: all {len(r.failed)} runs ended, "
        f"the last at h={words.size(last.h)} with {ended(last)}"
    )


def _diverges(r: Reason) -> str:
    return f"does not converge, as expected: {', and '.join(_seen(r))}"


def _stalls(r: Reason) -> str:
    return f"stalls, as expected: {', and '.join(_seen(r))}"


def _seen(r: Reason) -> list[str]:
    """Growth, finer runs that failed, and a fall of the order."""
    seen = [f"the error grew {_path(r)}"] if "error_0" in r.numbers else []
    if r.failed:
        more = f" and {len(r.failed) - 1} finer as well" if r.failed[1:] else ""
        seen.append(f"the run at h={words.size(r.failed[0].h)} ended with {ended(r.failed[0])}{more}")
    if "order_best" in r.numbers:
        best, last = (words.order(_number(r, name)) for name in ("order_best", "order_last"))
        seen.append(f"the order fell from {best} to {last} at h={_h(r, 'h_last')}")
    return seen


def _nothing_finished(r: Reason) -> str:
    told = [ended(end) for end in r.failed]
    if r.failed and all(end.failure.kind is FailureKind.ERROR_NOT_FINITE for end in r.failed):
        return (
            f"no level finished, as none of the {len(r.failed)} errors is a number: look for the first step with a NaN "
            "in the fields, on the coarsest cells first, or for an exact solution that divides by zero"
        )
    if len(told) > 1 and len(set(told)) == 1:
        return f"no level finished (all {len(told)}: {told[0]})"
    ends = "; ".join(f"h={words.size(end.h)}: {one}" for end, one in zip(r.failed, told, strict=True))
    return f"no level finished ({ends or 'there is none'})"


def _level_missing(r: Reason) -> str:
    return f"there is no error at h={words.size(r.failed[0].h)} ({ended(r.failed[0])})"


def _near_round_off(r: Reason) -> str:
    if "zeros" in r.numbers and r.numbers["error"]:
        largest, floor = (words.short(_number(r, name)) for name in ("error", "floor"))
        return (
            f"every error is at round-off, at most {largest} with a floor of {floor}, so there is nothing to judge: "
            "take a problem that the method does not solve exactly"
        )
    if "zeros" in r.numbers:
        return (
            "every error is 0, so there is no order: write more digits, compare with the exact solution and not with "
            "the answer itself, or take a problem that the method does not solve exactly"
        )
    if not r.numbers["error"]:
        return "an error of 0 has no order"
    error, floor = (words.short(_number(r, name)) for name in ("error", "floor"))
    return f"an error of {error} is not clear of the round-off floor {floor}"


def _not_settled(r: Reason) -> str:
    orders = r.numbers["orders"]
    assert isinstance(orders, tuple)
    fit = f"; in the best fit there is {_other(r)}" if "floor" in r.numbers else ""
    return f"the local orders {' '.join(words.order(p) for p in orders)} have not settled{fit}"


def _order(r: Reason) -> str:
    order, start, end, last, low, high = (
        words.order(_number(r, name)) for name in ("order", "start", "end", "last", "band_low", "band_high")
    )
    interval = f"{100 * _number(r, 'confidence'):.3g} % interval {start} to {end}"
    window = f" from h={_h(r, 'from')} on" if "from" in r.numbers else ""
    return f"order {order}{window} ({interval}, last pair {last}) against {low} to {high}"


def _contaminated(r: Reason) -> str:
    if "least" not in r.numbers:
        return f"the expected order is the smaller part: {_other(r)}, together at most {_percent(r, 'most', 1)}"
    below, least = f"the order falls below the band, as there is {_other(r)}", _percent(r, "least")
    if r.numbers.get("power") == 2:
        return f"{below}, adding in the square; without that it would be smaller by {least} or more{_coupled_too(r)}"
    return f"{below}; at least {least} of that error are not of the expected order{_coupled_too(r)}"


def _other(r: Reason) -> str:
    """Parts of the best fit that are not of the expected order, the larger first; one below 1 % is left out."""
    lower, floor = _number(r, "lower"), _number(r, "floor")
    size = words.short(floor * _number(r, "error"))
    parts = [(floor, f"a floor of {size}"), (lower, "a part of lower order")]
    kept = [(part, name) for part, name in sorted(parts, reverse=True) if part >= SMALL]
    return " and ".join(f"{name}, {words.percent(part, 0)} of the finest error" for part, name in kept)


def _parts(r: Reason) -> str:
    lower, floor, most = _percent(r, "lower"), _percent(r, "floor"), _percent(r, "most", 1)
    return f"lower order {lower}, floor {floor} of the finest error, at most {most}"


def _most(r: Reason) -> str:
    return f"contamination at most {_percent(r, 'most', 1)}, {_percent(r, 'squared')} where it adds in the square"


def _run_ended(r: Reason) -> str:
    more = f", and {len(r.failed) - 1} more" if r.failed[1:] else ""
    return f"the run at h={words.size(r.failed[0].h)} ended with {ended(r.failed[0])}{more}"


def _falls_short(r: Reason) -> str:
    first, last, low = (words.order(_number(r, name)) for name in ("first", "last", "band_low"))
    flat = f"; it falls to a floor of {words.short(_number(r, 'flat'))}" if "flat" in r.numbers else ""
    return (
        f"the error does not fall as it should: the last two local orders are {first} and {last}, against {low}{flat}"
        f"{_coupled_too(r)}"
    )


def _far_off(r: Reason) -> str:
    return f"{_magnitude(r)}, carried over from h={_h(r, 'recorded_h')}"


def _coupled(r: Reason) -> str:
    return f"coupled: {_changes(_number(r, 'change'))}"


def _coupled_too(r: Reason) -> str:
    """Change of a refuted error with half the time step; empty where that is small."""
    return f"; {_changes(_number(r, 'change'))}" if "change" in r.numbers else ""


def _changes(change: float) -> str:
    """Change of the finest error with half the time step: its direction, its order, and what that points to."""
    if change >= 0:
        return (
            f"half the time step raises the finest error by {words.percent(change, 0)}: something is lost in each step"
        )
    order = words.order(-log2(1 + change)) if change > -1 else "∞"
    told = f"half the time step lowers the finest error by {words.percent(-change, 0)}, order {order} in it"
    return f"{told}: {_points_to(1 + change)}"


def _points_to(ratio: float) -> str:
    """Cause of a change of the error with the time step, by its ratio; of another, how large a known part would be."""
    known = {
        0.25: "all of it is of second order",
        0.5: "all of it is of first order, as of a start, a load or a stress at another time level",
        0.71: "as of a norm over all steps that is divided by their number, not by its root",
    }
    near = min(known, key=lambda one: abs(one - ratio))
    if abs(near - ratio) < ALIKE:
        return known[near]
    if ratio < min(known):
        return "it is of a higher order than the step has"
    first, second = (words.percent((1 - ratio) / (1 - left), 0) for left in (0.5, 0.25))
    linear = (
        f"{first} of it, if of first order, as of a start, a load or a stress at another time level, or "
        if ratio > 0.5
        else ""
    )
    return f"{linear}{second} if of second" if linear else f"{second} of it, if of second order"


def _magnitude(r: Reason) -> str:
    return f"the error at h={_h(r, 'h')} is {words.order(_number(r, 'ratio'))} times the recorded one"


def _neither(r: Reason) -> str:
    stall = r.numbers.get("stall")
    wanted = "neither growth nor convergence" if stall is None else f"neither a stall below {stall:g} nor convergence"
    alone = r.numbers["h_0"] == r.numbers["h_1"]
    went = f"one level finished, h={_h(r, 'h_0')}" if alone else f"the error went {_path(r)}"
    return f"{wanted}: {went}"


def _path(r: Reason) -> str:
    ends = [f"{words.short(_number(r, f'error_{i}'))} at h={_h(r, f'h_{i}')}" for i in (0, 1)]
    return f"from {ends[0]} to {ends[1]}"


def _number(r: Reason, name: str) -> float:
    value = r.numbers[name]
    assert not isinstance(value, tuple)
    return value


def _h(r: Reason, name: str) -> str:
    return words.size(_number(r, name))


def _percent(r: Reason, name: str, digits: int = 0) -> str:
    return words.percent(_number(r, name), digits)


SAID: dict[ReasonCode, Callable[[Reason], str]] = {
    ReasonCode.AS_EXPECTED: _as_expected,
    ReasonCode.ALL_FAILED: _all_failed,
    ReasonCode.DIVERGES: _diverges,
    ReasonCode.STALLS: _stalls,
    ReasonCode.ORDER_BELOW: lambda r: f"{_order(r)}: below the band",
    ReasonCode.CONTAMINATED: _contaminated,
    ReasonCode.MAGNITUDE: _magnitude,
    ReasonCode.FAR_OFF: _far_off,
    ReasonCode.RUN_ENDED: _run_ended,
    ReasonCode.FALLS_SHORT: _falls_short,
    ReasonCode.NOTHING_MOVES: lambda r: "nothing moves: the error is u itself",
    ReasonCode.CONVERGES: lambda r: (
        f"a surprise: not expected to converge, the error fell {_path(r)}, order {words.order(_number(r, 'order'))}"
    ),
    ReasonCode.NOTHING_FINISHED: _nothing_finished,
    ReasonCode.TOO_FEW_LEVELS: lambda r: (
        f"with fewer than {_number(r, 'levels'):.0f} levels nothing shows that the order has settled"
    ),
    ReasonCode.LEVEL_MISSING: _level_missing,
    ReasonCode.NEAR_ROUND_OFF: _near_round_off,
    ReasonCode.TIME_STEP_UNKNOWN: lambda r: "nothing shows that the time step is small enough",
    ReasonCode.TIME_STEP_COUPLED: _coupled,
    ReasonCode.ERROR_RISES: lambda r: f"the error does not fall on the way to h={_h(r, 'h')}",
    ReasonCode.NOT_SETTLED: _not_settled,
    ReasonCode.ORDER_ABOVE: lambda r: (
        f"{_order(r)}: it reaches above the band, so expect more, or errors cancel, as a smaller motion shows"
    ),
    ReasonCode.ORDER_UNDECIDED: lambda r: f"{_order(r)}: undecided",
    ReasonCode.CONTAMINATION_OPEN: lambda r: f"contamination of {_percent(r, 'limit')} is not ruled out: {_parts(r)}",
    ReasonCode.ADDS_IN_SQUARE: lambda r: (
        f"{_percent(r, 'shown')} of the finest error are not of the expected order, and add in the square"
    ),
    ReasonCode.MAGNITUDE_CARRIED: lambda r: f"{_magnitude(r)}, carried over",
    ReasonCode.NEITHER: _neither,
}
