"""Negative controls: the study's own results, spoilt, are refused; each way of loosening the judge is seen by one."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import fixtures_study
import numpy as np
import pytest

from mpm_verify.cases.harness import analysis, refinement
from mpm_verify.cases.harness.analysis import Analysis, analyse
from mpm_verify.cases.harness.controls import PART, Control, ControlCode, controls
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.harness.verdicts import findings
from mpm_verify.cases.judging import evidence, fit, order, quantity
from mpm_verify.cases.judging.records import Expectation, Outcome, Reason, ReasonCode
from mpm_verify.reports.frames import Record, read
from mpm_verify.reports.sentences import controls as words
from mpm_verify.reports.sentences.headline import badge, headline

CODE = ControlCode


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fixtures_study.make(tmp_path_factory.mktemp("controls") / "study", largest=0)


@pytest.fixture
def record(folder: Path) -> Iterator[Record]:
    with fixtures_study.sources():
        whole = read(folder)
        judged = tuple(plan for plan in whole.study.plans if plan.judged)  # the others take time and decide nothing
        yield replace(whole, study=replace(whole.study, plans=judged))


def tried(record: Record, **changes: Any) -> dict[ControlCode, Control]:
    """Controls of the study, with other values in the expectations of an order."""
    plans = tuple(
        replace(plan, expectation=replace(plan.expectation, **changes))
        if plan.expectation and plan.expectation.order is not None else plan
        for plan in record.study.plans
    )  # fmt: skip
    study = replace(record.study, plans=plans)
    return {one.code: one for one in analyse(study, record.results, record.store).controls}


def missed(record: Record, **changes: Any) -> set[ControlCode]:
    return {code for code, one in tried(record, **changes).items() if not one.refused}


def test_a_sound_judge_refuses_every_control(record: Record) -> None:
    found = tried(record)
    assert list(found) == list(ControlCode)
    assert all(one.refused for one in found.values())
    assert {code: len(one.tried) for code, one in found.items()} == dict.fromkeys(ControlCode, 2) | {CODE.RECORDED: 1}
    assert {plan.run.method for plan in found[CODE.CONVERGENCE].tried} == {"mpm"}
    assert {plan.run.method for plan in found[CODE.LEAK].tried} == {"cpdi"}
    assert words.sentence(record.analysis.controls).endswith("spoilt: refused 9 of 9.")


def test_the_study_itself_is_left_as_it_is(record: Record) -> None:
    before = {digest: repr(result) for digest, result in record.results.items()}
    assert record.analysis.outcome is Outcome.PASS
    assert {digest: repr(result) for digest, result in record.results.items()} == before
    plain = [f.verdict for f in findings(record.study, record.results)]
    assert [f.verdict for f in record.analysis.findings] == plain


# ---- what loosens a judge


def setter(module: Any, name: str, value: Any) -> Callable[[pytest.MonkeyPatch], None]:
    return lambda patch: patch.setattr(module, name, value)


def fewer_levels(patch: pytest.MonkeyPatch) -> None:
    for module in (order, evidence, quantity, fit):
        patch.setattr(module, "LEVELS", 3)


def dropped_levels(patch: pytest.MonkeyPatch) -> None:
    """Levels without an error are dropped, as if nobody had asked for them."""
    whole = order._judge
    patch.setattr(
        order,
        "_judge",
        lambda q, confidence: whole(replace(q, levels=[e for e in q.levels if not e.ended]), confidence),
    )


def always_diverges(patch: pytest.MonkeyPatch) -> None:
    seen = (Outcome.PASS, Reason(ReasonCode.DIVERGES))
    patch.setattr(order, "_non_convergence", lambda q, confidence: seen)


def wide_band(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(quantity.Quantity, "band", property(lambda q: ((q.expectation.order or 0) - 0.5, 1e9)))


def anything_mixed(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(order, "NO_PASS", 1.0)
    patch.setattr(order, "MOST", 1.0)


def rough(patch: pytest.MonkeyPatch) -> None:
    anything_mixed(patch)
    patch.setattr(fit.Fit, "scatters", False)


def any_exit_code(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(analysis, "EXIT", dict.fromkeys(Outcome, 0))


def inconclusive_is_fine(patch: pytest.MonkeyPatch) -> None:
    patch.setitem(analysis.EXIT, Outcome.INCONCLUSIVE, 0)


def halved_with_itself(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(refinement.Series, "halved", property(lambda series: series.runs[-1]))


LOOSE: dict[str, tuple[Callable[[pytest.MonkeyPatch], None], set[ControlCode]]] = {
    "contamination": (anything_mixed, {CODE.LEAK}),
    "contamination and scatter": (rough, {CODE.LEAK, CODE.FLOOR}),
    "band": (wide_band, {CODE.BAND}),
    "levels": (fewer_levels, {CODE.FEW_LEVELS}),
    "dropped levels": (dropped_levels, {CODE.LEVEL_MISSING}),
    "time step": (setter(order, "COUPLED", 9.0), {CODE.TIME_STEP}),
    "half the time step with itself": (halved_with_itself, {CODE.TIME_STEP}),
    "non-convergence": (always_diverges, {CODE.CONVERGENCE}),
    "exit code of INCONCLUSIVE": (inconclusive_is_fine, set(CODE) - {CODE.RECORDED, CODE.CONVERGENCE}),
    "every exit code": (any_exit_code, set(CODE)),
}


@pytest.mark.parametrize("name", LOOSE)
def test_a_loosened_judge_is_seen(name: str, record: Record, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without it sound results pass as before: the verdicts of the study itself do not tell."""
    loosen, seen = LOOSE[name]
    loosen(monkeypatch)
    assert analyse(record.study, record.results, record.store).outcome is Outcome.PASS
    assert missed(record) >= seen
    assert missed(record) != set()


def test_a_loosened_magnitude_is_seen(record: Record) -> None:
    assert missed(record, within=0.5) == {CODE.RECORDED}


def test_what_is_not_refused_is_told(record: Record, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(order, "COUPLED", 9.0)
    told = words.sentence(record.analysis.controls)
    assert "refused 8 of 9; NOT refused: another error with half the time step" in told
    (loose,) = [one for one in record.analysis.controls if not one.refused]
    assert {plan.run.ppc for plan in loose.passed} == {4, 9}


# ---- what is applicable


def without_halved(study: Study[Any]) -> Study[Any]:
    return replace(study, runs=tuple(run for run in study.runs if run.courant == 0.4))


def test_nothing_is_controlled_where_nothing_passes(record: Record) -> None:
    found = analyse(without_halved(record.study), record.results, record.store)
    assert {f.verdict.outcome for f in found.findings if f.plan.judged} == {Outcome.INCONCLUSIVE, Outcome.PASS}
    assert [one.code for one in found.controls] == [CODE.CONVERGENCE]
    plans = tuple(plan for plan in record.study.plans if plan.run.method == "cpdi")
    alone = analyse(replace(without_halved(record.study), plans=plans), record.results, record.store)
    assert alone.controls == ()
    assert words.sentence(alone.controls) == ""


def test_no_half_time_step_and_no_recorded_error_are_not_applicable(
    record: Record, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fixtures_study.Run, "tied", True)
    found = tried(record, recorded=())
    assert set(CODE) - found.keys() == {CODE.TIME_STEP, CODE.RECORDED}
    assert words.count(list(found.values())) == "refused 7 of 7"


def test_first_order_has_no_leak_of_its_own(record: Record) -> None:
    """An order less is the floor there. Errors of first order, so that the study passes."""
    results = {
        digest: replace(
            result, errors={q: dict.fromkeys(norms, 1 / result.run.cells) for q, norms in result.errors.items()}
        )
        for digest, result in record.results.items()
    }
    plans = tuple(
        replace(plan, expectation=Expectation(1.0)) for plan in record.study.plans if plan.run.method == "cpdi"
    )
    study = replace(record.study, plans=plans)
    found = {one.code: one for one in controls(study, results, findings(study, results), passed)}
    assert set(found) == {CODE.FLOOR, CODE.BAND, CODE.NORM, CODE.FEW_LEVELS, CODE.LEVEL_MISSING, CODE.TIME_STEP}
    assert all(one.refused for one in found.values())


def passed(finding: Any) -> bool:
    return Analysis((finding,)).exit_code == 0


def test_what_is_added_is_a_part_of_the_finest_error(record: Record, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the leak: 30 % of the finest error then, twice as much at twice the cell size."""
    seen: list[Any] = []
    real = findings

    def watched(study: Any, results: Any) -> Any:
        seen.append((study, results))
        return real(study, results)

    monkeypatch.setattr("mpm_verify.cases.harness.controls.findings", watched)
    controls(record.study, record.results, record.findings, passed)
    study, results = seen[0]
    runs = [run for run in study.runs if (run.method, run.ppc, run.courant) == ("cpdi", 4, 0.4)]
    added = [results[run.digest].errors["u"]["rms"] - record.results[run.digest].errors["u"]["rms"] for run in runs]
    assert np.array(added) * [run.cells for run in runs] == pytest.approx(added[-1] * runs[-1].cells)
    assert added[-1] / results[runs[-1].digest].errors["u"]["rms"] == pytest.approx(PART)


# ---- badges and headline


def test_the_headline_states_the_finding(record: Record) -> None:
    assert headline(record) == "CPDI converges at order 2.01 to 2.04; MPM diverges."
    said = {badge(f) for f in record.findings if f.counts}
    assert said == {"PASS", "diverges, as registered"}


def changed(record: Record, outcome: Outcome, which: Callable[[Any], bool]) -> str:
    """Headline where judged findings have another outcome."""
    found = tuple(
        replace(f, verdict=replace(f.verdict, outcome=outcome)) if f.plan.judged and which(f.plan) else f
        for f in record.findings
    )
    vars(record)["analysis"] = Analysis(found)
    return headline(record)


@pytest.mark.parametrize(
    ("outcome", "which", "said"),
    [
        (Outcome.FAIL, "mpm", "MPM converges, which was not expected; CPDI converges at order 2.01 to 2.04."),
        (Outcome.FAIL, "cpdi", "CPDI does not converge as expected; MPM diverges."),
        (Outcome.INCONCLUSIVE, "mpm cpdi", "CPDI and MPM are not decided."),
        (Outcome.ERROR, "mpm", "MPM has nothing to judge; CPDI converges at order 2.01 to 2.04."),
    ],
)
def test_headlines_of_other_outcomes(outcome: Outcome, which: str, said: str, record: Record) -> None:
    assert changed(record, outcome, lambda plan: plan.run.method in which.split()) == said


def test_a_method_that_does_both_is_told_apart(record: Record) -> None:
    said = changed(record, Outcome.INCONCLUSIVE, lambda plan: (plan.run.method, plan.run.ppc) == ("cpdi", 9))
    assert said == "CPDI with 9 per cell is not decided; CPDI with 4 per cell converges at order 2.01; MPM diverges."
