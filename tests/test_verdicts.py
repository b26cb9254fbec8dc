"""From Results to verdicts and an exit code; what the MMS study declares to judge before it runs."""

import sys
from collections.abc import Iterator
from dataclasses import replace

import fixtures_study as fixtures
import pytest

from mpm_verify.cases.harness.analysis import Analysis
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.study import QuantityPlan, Study
from mpm_verify.cases.harness.verdicts import Finding, findings, refinement
from mpm_verify.cases.judging.order import Expectation, Outcome, Verdict
from mpm_verify.cases.judging.records import Action, Ended, Reason, ReasonCode, Wanted
from mpm_verify.cases.mms import deviations
from mpm_verify.cases.mms.expectations import expected, later_with_9, registered, registry
from mpm_verify.cases.mms.recorded import recorded
from mpm_verify.cases.mms.run import QUANTITIES, Result, Run
from mpm_verify.reports.sentences import verdicts
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.solver.plugins import SOLUTIONS, TRANSFERS, available, canonical

PASS, FAIL, INCONCLUSIVE, ERROR = Outcome
CELLS = (8, 16, 32, 64, 128)
LEVELS = tuple(Run("cpdi", "axis_aligned", "neo_hookean", cells, 4, 0.4) for cells in CELLS)
HALVED = replace(LEVELS[-1], courant=0.2)
JUDGED = QuantityPlan(LEVELS[0], "u", "rms", True, Expectation(2.0))
SHOWN = replace(JUDGED, judged=False, expectation=None)


@pytest.fixture(autouse=True)
def sources() -> Iterator[None]:
    with fixtures.sources():
        yield


def finding(outcome: Outcome, declared: QuantityPlan = JUDGED) -> Finding:
    return Finding(declared, Verdict(outcome, 2.0, None, None, Reason(ReasonCode.AS_EXPECTED)), (), None)


def exit_code(found: list[Finding]) -> int:
    return Analysis(tuple(found)).exit_code


def made(runs: tuple[Run, ...]) -> dict[str, Result]:
    return {run.digest: fixtures._result(run) for run in runs}


def study(runs: tuple[Run, ...], *declared: QuantityPlan) -> Study:
    return Study("mms", "title", "verify mms", runs, declared, case="mms")


def lost(result: Result) -> Result:
    return replace(result, status="failed", errors={}, floor={}, failure=Failure(FailureKind.INVERTED, 21, 35, (2, 2)))


# ---- exit code


@pytest.mark.parametrize(
    ("outcomes", "code"),
    [
        ([PASS], 0),
        ([FAIL], 1),
        ([ERROR], 4),
        ([INCONCLUSIVE], 3),
        ([PASS, PASS], 0),
        ([PASS, INCONCLUSIVE], 3),
        ([PASS, ERROR], 4),
        ([INCONCLUSIVE, ERROR], 4),
        ([ERROR, FAIL], 1),
        ([PASS, INCONCLUSIVE, ERROR, FAIL], 1),
        ([], 3),
    ],
)
def test_exit_code(outcomes: list[Outcome], code: int) -> None:
    assert exit_code([finding(outcome) for outcome in outcomes]) == code
    assert exit_code([finding(outcome) for outcome in reversed(outcomes)]) == code


@pytest.mark.parametrize("outcome", list(Outcome))
def test_what_is_only_shown_decides_nothing(outcome: Outcome) -> None:
    assert exit_code([finding(outcome, SHOWN)]) == 3
    assert exit_code([finding(outcome, SHOWN), finding(PASS)]) == 0


@pytest.mark.parametrize("outcome", list(Outcome))
def test_what_can_refute_counts_where_it_fails_alone(outcome: Outcome) -> None:
    refutes = replace(SHOWN, refutes=True)
    assert exit_code([finding(outcome, refutes), finding(PASS)]) == (1 if outcome is FAIL else 0)
    assert exit_code([finding(outcome, refutes)]) == (1 if outcome is FAIL else 3)


# ---- which runs belong to a quantity


def test_refinement_is_coarse_to_fine_and_leaves_the_halved_run_out() -> None:
    assert refinement(JUDGED, [HALVED, *reversed(LEVELS)]) == list(LEVELS)


@pytest.mark.parametrize("change", [{"method": "mpm"}, {"solution": "affine"}, {"ppc": 9}])
def test_other_runs_do_not_belong(change: dict[str, object]) -> None:
    others = [replace(run, **change) for run in (*LEVELS, HALVED)]
    assert refinement(JUDGED, [*others, *LEVELS]) == list(LEVELS)
    assert refinement(JUDGED, others) == []


def test_whole_study_passes() -> None:
    runs = (*LEVELS, HALVED)
    (found,) = findings(study(runs, JUDGED), made(runs))
    assert found.verdict.outcome is PASS
    assert [level.h for level in found.levels] == [1 / run.cells for run in LEVELS]
    assert found.finest is not None
    assert found.finest.run == LEVELS[-1]  # not the one with half the time step


def test_without_the_halved_run_there_is_no_verdict() -> None:
    (found,) = findings(study(LEVELS, JUDGED), made(LEVELS))
    assert found.verdict.outcome is INCONCLUSIVE
    assert found.verdict.reason.code is ReasonCode.TIME_STEP_UNKNOWN
    assert found.verdict.reason.wanted == Wanted(Action.HALVE_FINEST, 1 / 128, CELLS)


def test_halved_run_of_another_level_or_method_does_not_count() -> None:
    strangers = (replace(LEVELS[1], courant=0.2), replace(HALVED, ppc=9))
    runs = (*LEVELS, *strangers)
    (found,) = findings(study(runs, JUDGED), made(runs))
    assert found.verdict.reason.code is ReasonCode.TIME_STEP_UNKNOWN
    assert found.verdict.reason.wanted == Wanted(Action.HALVE_FINEST, 1 / 128, CELLS)


def test_coupled_error_is_found_by_the_halved_run() -> None:
    runs = (*LEVELS, HALVED)
    results = made(runs)
    half = results[HALVED.digest]
    errors = {**half.errors, "u": {**half.errors["u"], "rms": 0.5 * half.errors["u"]["rms"]}}
    (found,) = findings(study(runs, JUDGED), {**results, HALVED.digest: replace(half, errors=errors)})
    assert found.verdict.outcome is INCONCLUSIVE
    assert found.verdict.reason.code is ReasonCode.TIME_STEP_COUPLED
    assert found.verdict.reason.wanted == Wanted(Action.HALVE_ALL, 1 / 128, CELLS)


def test_failed_halved_run_shows_nothing() -> None:
    runs = (*LEVELS, HALVED)
    results = made(runs)
    (found,) = findings(study(runs, JUDGED), {**results, HALVED.digest: lost(results[HALVED.digest])})
    assert found.verdict.outcome is INCONCLUSIVE
    assert found.verdict.reason.code is ReasonCode.TIME_STEP_UNKNOWN
    assert found.verdict.reason.wanted == Wanted(Action.HALVE_FINEST, 1 / 128, CELLS)


def test_failed_level_is_named_with_its_reason() -> None:
    runs = (*LEVELS, HALVED)
    results = made(runs)
    failed = {**results, LEVELS[3].digest: lost(results[LEVELS[3].digest])}
    (found,) = findings(study(runs, JUDGED), failed)
    assert found.verdict.outcome is FAIL
    reason = found.verdict.reason
    assert reason.code is ReasonCode.RUN_ENDED
    assert reason.failed == (Ended(1 / 64, Failure(FailureKind.INVERTED, 21, 35, (2, 2))),)
    assert verdicts.said(reason) == "the run at h=1/64 ended with det F ≤ 0 at step 21, particle 35 in cell (2, 2)"


def test_all_levels_failed_is_an_error() -> None:
    end = Failure(FailureKind.UNSTABLE_STEP, 0)
    results = {digest: replace(lost(result), failure=end) for digest, result in made(LEVELS).items()}
    (found,) = findings(study(LEVELS, JUDGED), results)
    assert found.verdict.outcome is ERROR
    assert exit_code([found]) == 4


def test_incomplete_store() -> None:
    runs = (*LEVELS, HALVED)
    (found,) = findings(study(runs, JUDGED), made(LEVELS[:3]))
    assert found.verdict.outcome is INCONCLUSIVE
    assert found.verdict.reason.code is ReasonCode.LEVEL_MISSING
    assert found.verdict.reason.failed[0].failure.kind is FailureKind.NOT_RUN
    assert "not run yet" in verdicts.said(found.verdict.reason)
    assert found.finest is None


@pytest.mark.parametrize("declared", [JUDGED, SHOWN])
def test_empty_store_is_no_crash(declared: QuantityPlan) -> None:
    (found,) = findings(study(LEVELS, declared), {})
    assert found.verdict.outcome is ERROR
    assert found.finest is None


def test_expected_non_convergence_is_met_by_failed_runs() -> None:
    runs = tuple(replace(run, method="mpm") for run in LEVELS)
    declared = replace(JUDGED, run=runs[0], expectation=Expectation(None, source="literature"))
    (found,) = findings(study(runs, declared), made(runs))
    assert found.verdict.outcome is PASS
    assert found.verdict.reason.code is ReasonCode.DIVERGES
    assert [end.failure.kind for end in found.verdict.reason.failed] == [FailureKind.INVERTED]


def test_findings_keep_the_order_of_the_declarations() -> None:
    declared = (SHOWN, JUDGED, replace(SHOWN, norm="max"))
    found = findings(study((*LEVELS, HALVED), *declared), made((*LEVELS, HALVED)))
    assert [f.plan for f in found] == list(declared)


# ---- what the MMS study declares


def built(command: str = "verify mms", name: str = "mms", **changes: object) -> Study:
    """Of cpdi on 8 to 64 cells unless another is asked for; a value or a tuple of them by the name of an axis."""
    values = {"cells": (8, 16, 32, 64), **changes}
    listed = {key: value if isinstance(value, tuple) else (value,) for key, value in values.items()}
    return build(Asked("mms", listed), command, name)


REGISTERED = sorted(
    {(e.method, e.solution) for e in registry() if e.solution in available(SOLUTIONS) and e.method in deviations.SHOWN}
)


@pytest.mark.parametrize(("method", "solution"), REGISTERED)
def test_judged_is_u_in_rms_with_4_and_9_per_cell(method: str, solution: str) -> None:
    declared = built(method=(method,), solution=solution).plans
    judged = {(d.quantity, d.norm, d.run.ppc) for d in declared if d.judged}
    counts = (4,) if later_with_9(method, solution, registered(solution, method, "u")) else (4, 9)
    assert judged == {("u", "rms", ppc) for ppc in counts}
    assert len(declared) == 3 * 4 * 4  # each of 3 particle counts, 4 quantities and 4 norms is at least shown
    assert all(d.expectation is not None for d in declared if d.judged)
    known = {(d.quantity, d.run.ppc) for d in declared if d.expectation}  # the others are shown beside it
    assert known == {(quantity, ppc) for quantity in QUANTITIES for ppc in counts}


@pytest.mark.parametrize("quantity", ["u", "v", "F", "sigma"])
@pytest.mark.parametrize(("factor", "code"), [(1.0, 0), (1.02, 1), (0.98, 1), (1.0001, 0)])
def test_every_recorded_error_decides(quantity: str, factor: float, code: int) -> None:
    """Recorded errors of CPDI as the errors of a study: one of them 2 % off is a FAIL, of v, F and sigma too."""
    plan = built(ppc=4, cells=(8, 12, 16, 24, 32))
    known = {q: {round(1 / one.h): one.low for one in recorded("axis_aligned", "cpdi", 4, q)} for q in QUANTITIES}
    results, (usual,) = {}, made(LEVELS[:1]).values()
    for run in plan.runs:
        at = {q: known[q][run.cells] * (factor if q == quantity and run.cells == 16 else 1.0) for q in QUANTITIES}
        errors = {q: dict.fromkeys(usual.errors[q], at[q]) for q in QUANTITIES}
        results[run.digest] = replace(usual, run=run, digest=run.digest, errors=errors)
    found = findings(plan, results)
    assert exit_code(found) == code
    wrong = [(f.plan.quantity, f.verdict.reason.code) for f in found if f.counts and f.verdict.outcome is FAIL]
    assert wrong == ([(quantity, ReasonCode.MAGNITUDE)] if code else [])


def test_recorded_errors_of_another_solver_count_on_its_finest_cells() -> None:
    ours, theirs = ({q: expected("mpm", "clamped_shear:G=1e-06", "neo_hookean", 4, q, "rms", theirs=their)
                     for q in QUANTITIES} for their in (False, True))  # fmt: skip
    for q in QUANTITIES:
        one, other = ours[q], theirs[q]
        assert one is not None
        assert other is not None
        assert (one.within, one.finest, other.within, other.finest) == (0.01, False, 0.1, True)
        assert all(known.low == known.high for known in one.recorded)
        assert any(known.low < known.high for known in other.recorded)  # of one order of the step or the other
    assert expected("mpm", "clamped_shear:G=1e-06", "neo_hookean", 4, "u", "rms", usual=False).recorded == ()


def test_an_order_that_is_given_is_of_u_and_the_others_have_to_converge() -> None:
    asked = {
        "cells": (8, 16, 32, 64),
        "ppc": (4,),
        "solver": (f"{sys.executable} {{case}} {{out}}",),
        "solver_version": ("1",),
    }
    plans = build(Asked("mms", {**asked, "order": (2.0,)}), "verify mms", "mms").plans
    assert [(p.quantity, p.expectation.order) for p in plans if p.judged] == [("u", 2.0)]
    assert [(p.quantity, p.expectation.order) for p in plans if p.refutes] == [("v", 1.0), ("F", 1.0), ("sigma", 1.0)]


@pytest.mark.parametrize("changes", [{"solution": "axis_aligned:A=0.01"}, {"material": "neo_hookean:nu=0.2"}])
def test_an_order_is_expected_whatever_the_parameters(changes: dict[str, str]) -> None:
    judged = [d.expectation for d in built(**changes).plans if d.judged]
    assert [(e.order, e.recorded) for e in judged if e] == [(2.0, ())] * 2  # recorded errors hold for defaults
    assert not any(d.judged for d in built(method=("mpm",), **changes).plans)  # small amplitudes do converge


def test_nothing_is_expected_of_linear_elasticity() -> None:
    study = built(material="linear_elastic")
    assert not any(d.judged for d in study.plans)
    assert {run.courant for run in study.runs} == {0.4}


@pytest.mark.parametrize(
    "changes", [{"transfer": "apic"}, {"transfer": "flip:fraction=0.95"}, {"stress": "musl"}, {"stress": "usf"}]
)
def test_nothing_is_expected_of_another_transfer_or_stress_order(changes: dict[str, str]) -> None:
    study = built(**changes)
    assert not any(d.judged for d in study.plans)
    assert {getattr(run, key) for run in study.runs for key in changes} == set(changes.values())


def test_a_transfer_has_one_name() -> None:
    assert built(transfer="flip:fraction=1").runs == built().runs
    assert any(d.judged for d in built(transfer="flip:fraction=1.0").plans)
    assert canonical(TRANSFERS, "fmpm:order=3.0") == "fmpm:order=3"
    assert canonical(TRANSFERS, "fmpm:order=2") == "fmpm"


def test_halved_runs_only_where_an_order_is_expected() -> None:
    study = built(method=("cpdi", "mpm"))
    halved = [(r.method, r.cells, r.ppc) for r in study.runs if r.courant == 0.2]
    assert halved == [("cpdi", 64, 4), ("cpdi", 64, 9)]
    assert {r.courant for r in study.runs} == {0.4, 0.2}


def test_runs_are_the_whole_sweep_once() -> None:
    study = built(cells=(16, 8, 16), ppc=(9, 1, 9), method=("mpm",))
    assert [(r.cells, r.ppc) for r in study.runs] == [(8, 1), (16, 1), (8, 9), (16, 9)]
    assert len({r.digest for r in study.runs}) == len(study.runs)


@pytest.mark.parametrize(
    ("specification", "name"),
    [
        ("axis_aligned", "axis_aligned"),
        ("axis_aligned:", "axis_aligned"),
        ("axis_aligned:phase=0", "axis_aligned"),
        ("axis_aligned:A=0.05,L=1,C=100,phase=0.0", "axis_aligned"),
        ("axis_aligned:phase=0.5,A=1e-2", "axis_aligned:A=0.01,phase=0.5"),
        ("axis_aligned:A=0.010,phase=.5", "axis_aligned:A=0.01,phase=0.5"),
    ],
)
def test_canonical(specification: str, name: str) -> None:
    assert canonical(SOLUTIONS, specification) == name
    assert built(solution=specification).runs == built(solution=name).runs


def test_canonical_keeps_every_digit() -> None:
    assert canonical(SOLUTIONS, "axis_aligned:A=0.0123456789") == "axis_aligned:A=0.0123456789"


def test_defaults_in_other_words_are_judged() -> None:
    assert any(d.judged for d in built(solution="axis_aligned:phase=0").plans)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"method": ("cpdi", "nope")}, "choose from"),
        ({"cells": (8, 1)}, "whole numbers from 2 to 4096"),
        ({"ppc": (2,)}, "choose from 1, 4, 9, 16"),
        ({"courant": 0.0}, "0.001 to 10"),
        ({"transfer": "flip:fraction=-0.1"}, "above 0 and up to 1"),
        ({"transfer": "nope"}, "choose from apic, flip, fmpm, pic"),
        ({"stress": "last"}, "choose from usl, musl, usf"),
        ({"solution": "nope"}, "choose from"),
        ({"material": "neo_hookean:nu=0.5"}, "between -1 and 0.5"),
    ],
)
def test_bad_sweep(changes: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        built(**changes)


@pytest.mark.parametrize("solution", ["axis_aligned", "clamped_shear"])
def test_title_and_command_tell_what_was_asked(solution: str) -> None:
    study = built("verify mms --quick", "name", solution=solution, method=("mpm", "cpdi"))
    assert study.title == f"MPM and CPDI against the manufactured solution {solution}"
    assert (study.command, study.name) == ("verify mms --quick", "name")
