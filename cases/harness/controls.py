"""Negative controls of a study: its own results, spoilt in known ways, which the judge has to refuse.

What loosens a judge is invisible where all that it sees is sound. So each verdict that passes is asked for again from
runs to exit code, with errors, runs or time step altered; recorded errors are left out, which would hide the rest, but
for the control of them. A control that passes all the same says that a judge is too loose, or that the scatter of the
study hides so much.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from math import isclose
from typing import Any

from mpm_verify.cases.harness.axes import level
from mpm_verify.cases.harness.refinement import usual_offset
from mpm_verify.cases.harness.study import Head, QuantityPlan, ResultRecord, Study, head
from mpm_verify.cases.harness.verdicts import Finding, findings
from mpm_verify.cases.judging.records import Expectation, Outcome

PART = 0.3  # of the finest error: what is added to it
WIDE = 1.0  # the band reaches so much further down
OFF, NARROW = 0.1, 0.02  # order that is added, and half the band that it has to be seen in
NORM = 0.5  # order that a norm adds which divides by the number of steps and not by its root
SCALE, SCALE_THEIRS = 1.05, 1.25  # times the recorded error, of our solver and of somebody else's
FEW = 3  # levels
Results = Mapping[str, ResultRecord[Any]]
Altered = tuple[Study[Any], Results]


class ControlCode(StrEnum):
    """Way of spoiling a study; the words are in reports/sentences/controls.py."""

    LEAK = "leak"  # an error of one order less is added
    FLOOR = "floor"  # a constant error is added
    BAND = "band"  # the order is a little higher, and the band narrower
    NORM = "norm"  # the errors are in another norm, whose order is higher
    RECORDED = "recorded"  # all errors are too large
    FEW_LEVELS = "few_levels"  # the finest three levels alone
    LEVEL_MISSING = "level_missing"  # the finest level but one is not there
    TIME_STEP = "time_step"  # the run with half the time step has the errors of the next coarser level
    CONVERGENCE = "convergence"  # of a registered non-convergence: clean second order


@dataclass(frozen=True)
class Control:
    """Control, with the plans that it was tried on, and those that passed all the same."""

    code: ControlCode
    tried: tuple[QuantityPlan[Any], ...]
    passed: tuple[QuantityPlan[Any], ...] = ()

    @property
    def refused(self) -> bool:
        """Whether nothing passed."""
        return not self.passed


def controls(study: Study[Any], results: Results, found: Sequence[Finding], passes: Callable[[Finding], bool]
             ) -> tuple[Control, ...]:  # fmt: skip
    """Controls of the judged findings that pass.

    Parameters
    ----------
    study, results
        What was run, and its Results by digest.
    found
        Findings of the study.
    passes
        Whether a study with that finding alone ends with exit code 0.

    Returns
    -------
    tuple of Control
        In the order of ControlCode; those that nothing can be tried on are left out.
    """
    kept = tuple(f.plan for f in found if f.plan.judged and f.verdict.outcome is Outcome.PASS)
    runs: dict[Head, list[Any]] = {plan.head: [] for plan in kept}
    for run in study.runs if kept else ():
        runs.get(head(run), []).append(run)
    tried = (_tried(code, spoil, study, results, kept, runs, passes) for code, spoil in SPOILT.items())
    return tuple(control for control in tried if control.tried)


def _tried(
    code: ControlCode,
    spoil: "Spoil",
    study: Study[Any],
    results: Results,
    kept: Sequence[QuantityPlan[Any]],
    runs: Mapping[Head, list[Any]],
    passes: Callable[[Finding], bool],
) -> Control:
    """Spoil every plan that can be, and judge the study again."""
    tried = []
    judged = [plan for plan in study.plans if plan.judged]
    plans = [_held_to(plan, code) for plan in judged]
    held = [
        (quantity, norm) for result in results.values() for quantity, norms in result.errors.items() for norm in norms
    ]
    names = tuple(dict.fromkeys([*held, *((plan.quantity, plan.norm) for plan in study.plans)]))
    altered: Altered = (replace(study, plans=tuple(plans)), results)
    for plan in kept if held else []:  # where every run failed nothing says which errors a run has
        if spoilt := spoil(_Spoilable(plan, runs[plan.head], *altered, names)):
            altered = spoilt
            tried.append(plan)
    if not tried:
        return Control(code, ())
    found = {_key(f.plan): f for f in findings(*altered)}
    return Control(code, tuple(tried), tuple(plan for plan in tried if passes(found[_key(plan)])))


def _held_to(plan: QuantityPlan[Any], code: ControlCode) -> QuantityPlan[Any]:
    """Plan with what of its expectation has to see the control."""
    e = plan.expectation
    if e is None or code is ControlCode.RECORDED:
        return plan
    if code in (ControlCode.LEAK, ControlCode.FLOOR):
        e = replace(e, below=e.below + WIDE)
    if code is ControlCode.BAND:
        e = replace(e, below=NARROW, above=NARROW)
    return replace(plan, expectation=replace(e, recorded=()))


def _key(plan: QuantityPlan[Any]) -> tuple[Head, str, str]:
    """Name of a plan."""
    return plan.head, plan.quantity, plan.norm


@dataclass(frozen=True)
class _Spoilable:
    """Refinement of one plan in a study that may be spoilt.

    `runs` are all of it, replicates and smaller time steps too; `names` are quantity and norm of all errors of a run.
    """

    plan: QuantityPlan[Any]
    runs: Sequence[Any]
    study: Study[Any]
    results: Results
    names: tuple[tuple[str, str], ...]

    @property
    def expectation(self) -> Expectation:
        """Expectation: plans that pass have one."""
        assert self.plan.expectation is not None
        return self.plan.expectation

    @cached_property
    def levels(self) -> list[Any]:
        """Runs at the usual positions with the largest time step, coarse to fine."""
        courant, at = max(run.courant for run in self.runs), usual_offset(self.runs)
        usual = [run for run in self.runs if run.courant == courant and run.offset == at]
        return sorted(usual, key=lambda run: float(run.cells))

    def error(self, run: Any) -> float | None:
        """Error of a run, None if it has none."""
        errors, *_ = level([run], self.results, self.plan.quantity, self.plan.norm)
        return errors[0] if errors else None

    def with_errors(self, error: Callable[[Any, float], float]) -> Altered:
        """Study whose errors of this plan are others: functions of the run and of the error that it has."""
        changed = {run.digest: self._with(self.results[run.digest], error(run, e))
                   for run in self.runs if (e := self.error(run)) is not None}  # fmt: skip
        return self.study, {**self.results, **changed}

    def _with(self, result: ResultRecord[Any], error: float) -> ResultRecord[Any]:
        errors: dict[str, dict[str, float]] = {}
        for quantity, norm in self.names:  # a run that failed has none
            errors.setdefault(quantity, {})[norm] = result.errors.get(quantity, {}).get(norm, error)
        errors[self.plan.quantity][self.plan.norm] = error
        return replace(result, status="finished", failure=None, errors=errors)

    def added(self, order: float) -> Altered | None:
        """Add an error of some order to that of each run, PART of the finest error then."""
        finest = self.levels[-1]
        most = PART / (1 - PART) * (self.error(finest) or 0.0)
        return self.with_errors(lambda run, e: e + most * float(finest.cells / run.cells) ** order)

    def steeper(self, order: float) -> Altered:
        """Errors whose order is higher by so much; that on the finest cells is as it was."""
        finest = self.levels[-1]
        return self.with_errors(lambda run, e: e * float(finest.cells / run.cells) ** order)

    def without(self, cells: set[float]) -> Altered:
        """Study without the levels of these cells."""
        gone = {id(run) for run in self.runs if run.cells in cells}
        return replace(self.study, runs=tuple(run for run in self.study.runs if id(run) not in gone)), self.results


Spoil = Callable[[_Spoilable], Altered | None]


def _of_order(spoil: Spoil) -> Spoil:
    """Control of what is expected to converge."""
    return lambda s: None if s.expectation.order is None else spoil(s)


def _leak(s: _Spoilable) -> Altered | None:
    order = s.expectation.order or 0.0
    return s.added(order - 1) if order > 1 else None


def _recorded(s: _Spoilable) -> Altered | None:
    recorded = s.expectation.recorded
    there = any(isclose(1 / run.cells, one.h, rel_tol=1e-6) for run in s.levels for one in recorded)
    factor = SCALE if there and not s.expectation.finest else SCALE_THEIRS
    return s.with_errors(lambda run, e: factor * e) if recorded else None


def _few(s: _Spoilable) -> Altered | None:
    return s.without({run.cells for run in s.levels[:-FEW]})


def _missing(s: _Spoilable) -> Altered | None:
    cells = s.levels[-2].cells
    gone = {run.digest for run in s.runs if run.cells == cells}
    return s.study, {digest: result for digest, result in s.results.items() if digest not in gone}


def _time_step(s: _Spoilable) -> Altered | None:
    coarser, finest = s.levels[-2:]
    half = next((run for run in s.runs if run.cells == finest.cells and run.offset == finest.offset
                 and isclose(run.courant, finest.courant / 2)), None)  # fmt: skip
    other = s.error(coarser)
    if half is None or finest.tied or other is None:
        return None
    return s.with_errors(lambda run, e: other if run == half else e)


def _convergence(s: _Spoilable) -> Altered | None:
    if s.expectation.order is not None:
        return None
    first = s.levels[0]
    start = s.error(first) or 1.0
    clean = {run.digest: s._with(s.results[run.digest], start * float(first.cells / run.cells) ** 2)
             for run in s.runs if run.digest in s.results}  # fmt: skip
    return s.study, {**s.results, **clean}


SPOILT: dict[ControlCode, Spoil] = {
    ControlCode.LEAK: _of_order(_leak),
    ControlCode.FLOOR: _of_order(lambda s: s.added(0.0)),
    ControlCode.BAND: _of_order(lambda s: s.steeper(OFF)),
    ControlCode.NORM: _of_order(lambda s: s.steeper(NORM)),
    ControlCode.RECORDED: _of_order(_recorded),
    ControlCode.FEW_LEVELS: _of_order(_few),
    ControlCode.LEVEL_MISSING: _of_order(_missing),
    ControlCode.TIME_STEP: _of_order(_time_step),
    ControlCode.CONVERGENCE: _convergence,
}
