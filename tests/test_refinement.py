"""Refinements that differ in one more axis: each is collected, judged and labelled apart from the others."""

import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import fixtures_study as fixtures
import pandas as pd
import pytest

from mpm_verify.cases.harness.axes import particle_axes, position_axes, time_axes
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.refinement import collect, complete, refines
from mpm_verify.cases.harness.runner import InProcess, run_study
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study, head
from mpm_verify.cases.harness.verdicts import findings, refinement
from mpm_verify.cases.judging.order import Expectation, Outcome
from mpm_verify.cases.mms.run import NORMS, QUANTITIES, Result, Run
from mpm_verify.reports.export.document import document, schema
from mpm_verify.reports.frames import Record
from mpm_verify.reports.pages.mms import page
from mpm_verify.verify.terminal.table import sentence

AXES: list[tuple[str, tuple[Any, ...], tuple[float, ...]]] = [  # an axis, two of its values, the order of each
    ("transfer", ("flip", "apic"), (2.0, 1.0)),
    ("layout", ("uniform", "graded"), (2.0, 1.5)),
    ("stress", ("usl", "musl"), (2.0, 0.5)),
    ("material", ("neo_hookean", "linear_elastic"), (2.0, 1.0)),
    ("staggered", (True, False), (2.0, 1.0)),
    ("force", (False, True), (2.0, 1.5)),
]
CELLS = (8, 16, 32, 64)
every_axis = pytest.mark.parametrize(("axis", "two", "orders"), AXES, ids=[name for name, _, _ in AXES])


def swept(axis: str, two: tuple[Any, ...], cells: tuple[int, ...] = CELLS, **more: Any) -> Study[Run]:
    """A study of two values of an axis, with 4 particles per cell."""
    return fixtures.built(cells=cells, ppc=(4,), **{axis: two}, **more)


def known(study: Study[Run], axis: str, two: tuple[Any, ...], orders: tuple[float, ...]) -> dict[str, Result]:
    """Results with the order of the value that each run has, from the same error on 8 cells."""
    found = {}
    for run in study.runs:
        order = orders[two.index(getattr(run, axis))]
        rms = 3e-3 * (8 / run.cells) ** order * (1.001 if run.courant < 0.4 else 1.0)
        errors = {q: dict.fromkeys(NORMS, rms) for q in QUANTITIES}
        usual = fixtures._result(replace(run, solution="axis_aligned", material="neo_hookean"))
        found[run.digest] = replace(usual, run=run, digest=run.digest, errors=errors)
    return found


# ---- collected apart


@every_axis
def test_two_values_are_two_refinements(axis: str, two: tuple[Any, ...], orders: tuple[float, ...]) -> None:
    study = swept(axis, two)
    series = collect(study.runs)
    assert [getattr(s.first, axis) for s in series] == list(two)
    for s in series:
        assert [run.cells for run in s.runs] == list(CELLS)
        assert {head(run) for run in (*s.runs, *s.times)} == {s.head}
        assert dict(s.head)[axis] == getattr(s.first, axis)
    assert len({s.head for s in series}) == 2
    assert {name for name, _ in series[0].head} == {f.name for f in fields(Run)} - {"cells", "courant", "offset"}


@every_axis
def test_plans_are_of_their_own_refinement(axis: str, two: tuple[Any, ...], orders: tuple[float, ...]) -> None:
    study = swept(axis, two)
    assert len(study.plans) == 2 * len(QUANTITIES) * len(NORMS)
    for plan in study.plans:
        runs = refinement(plan, study.runs)
        assert [run.cells for run in runs] == list(CELLS)
        assert {getattr(run, axis) for run in runs} == {getattr(plan.run, axis)}


def test_half_the_time_step_runs_only_where_an_order_is_judged() -> None:
    """Nothing is registered of another transfer or layout."""
    for axis, two in (("transfer", ("flip", "apic")), ("layout", ("uniform", "graded"))):
        study = swept(axis, two)
        halved = [run for run in study.runs if run.courant == 0.2]
        assert [(run.cells, getattr(run, axis)) for run in halved] == [(64, two[0])]
        assert {getattr(plan.run, axis) for plan in study.plans if plan.judged} == {two[0]}
        assert [s.halved is not None for s in collect(study.runs)] == [True, False]


def test_each_refinement_has_its_own_finest_cells_and_axes() -> None:
    coarse = fixtures.built(3, cells=(8, 16), ppc=(1,), courant=(0.4, 0.1), transfer=("apic",)).runs
    fine = fixtures.built(cells=(8, 16, 32), ppc=(1,), courant=(0.4, 0.1)).runs
    flip, apic = collect((*fine, *coarse))
    assert [(run.cells, run.courant) for run in flip.times] == [(32, 0.4), (32, 0.1)]
    assert [(run.cells, run.courant) for run in apic.times] == [(16, 0.4), (16, 0.1)]
    assert [len(runs) for runs in flip.replicates] == [1, 1, 1]
    assert [len(runs) for runs in apic.replicates] == [3, 3]


def test_what_a_study_needs_is_added_once() -> None:
    runs = swept("transfer", ("flip", "apic"), (8, 16)).runs[:4]
    assert {run.courant for run in runs} == {0.4}
    plans = [fixtures.plan("cpdi", "axis_aligned", 4, q, "rms", True, Expectation(2.0)) for q in ("u", "v")]
    every = complete(runs, plans, (0.2, 0.1, 0.2), 2)
    assert every[:4] == runs
    more = [(run.transfer, run.cells, run.courant) for run in every[4:] if run.offset == (0, 0)]
    assert sorted(more) == [("apic", 16, 0.1), ("apic", 16, 0.2), ("flip", 16, 0.1), ("flip", 16, 0.2)]
    assert len(every) == len(set(every)) == 4 + 4 + 4
    assert complete(runs, plans[:0], (), 1) == runs


def test_which_cases_refine() -> None:
    from mpm_verify.cases.harness.contract import case_named
    from mpm_verify.solver.plugins import CASES, available

    found = {name for name in available(CASES) if refines(case_named(name).Run)}
    assert found == {"mms", "column", "wave_bar", "any_code", "benchmark"}


# ---- judged apart


@every_axis
def test_each_is_judged_by_its_own_levels(axis: str, two: tuple[Any, ...], orders: tuple[float, ...]) -> None:
    """One converges as expected and the other does not: neither hides the other."""
    study = swept(axis, two)
    plans = [
        replace(plan, judged=True, expectation=Expectation(2.0))
        for plan in study.plans
        if (plan.quantity, plan.norm) == ("u", "rms")
    ]
    study = replace(study, runs=complete(study.runs, plans, (), 1), plans=tuple(plans))
    results = known(study, axis, two, orders)
    found = {getattr(f.plan.run, axis): f for f in findings(study, results)}
    for value, order in zip(two, orders, strict=True):
        assert found[value].verdict.local_orders == pytest.approx([order] * 3)
        assert [level.errors for level in found[value].levels] == [
            pytest.approx((3e-3 * (8 / n) ** order,)) for n in CELLS
        ]
        assert {getattr(r.run, axis) for r in found[value].results if r} == {value}
    assert [str(found[value].verdict.outcome) for value in two] == ["PASS", "FAIL"]
    lone = next(r for r in study.runs if getattr(r, axis) == two[1] and r.cells == 32)
    del results[lone.digest]
    again = {getattr(f.plan.run, axis): f.verdict.outcome for f in findings(study, results)}
    assert again[two[0]] is Outcome.PASS  # a run that is missing is missed by its own refinement alone
    assert again[two[1]] is not Outcome.PASS


@every_axis
def test_the_other_axes_are_of_one_refinement(axis: str, two: tuple[Any, ...], orders: tuple[float, ...]) -> None:
    study = fixtures.built(2, cells=(8, 16), ppc=(1, 4), courant=(0.4, 0.2), **{axis: two})
    results = known(study, axis, two, orders)
    runs = study.runs
    times = [(getattr(a.run, axis), a.run.ppc) for a in time_axes(runs, results)]
    assert times == [(value, ppc) for ppc in (1, 4) for value in two]
    assert {(getattr(a.run, axis), a.run.cells) for a in particle_axes(runs, results)} == {
        (value, cells) for value in two for cells in (8, 16)
    }
    assert all(a.ppc == (1, 4) for a in particle_axes(runs, results))
    assert {getattr(a.run, axis) for a in position_axes(runs, results)} == set(two)


# ---- labelled apart


def drawn(folder: Path, axis: str, two: tuple[Any, ...], orders: tuple[float, ...]) -> Record:
    """A record of a stored study."""
    with fixtures.sources():
        study = swept(axis, two, (8, 16, 32))
        store = Store(folder)
        store.create(study)
        results = known(study, axis, two, orders)
        for result in results.values():
            store.put(result, {})
        return Record(store, study, results, earlier=False)


@every_axis
def test_labels_tell_them_apart(axis: str, two: tuple[Any, ...], orders: tuple[float, ...], tmp_path: Path) -> None:
    record = drawn(tmp_path, axis, two, orders)
    assert record.varied == (axis,)
    labels = [record.label(s.first) for s in record.series]
    assert labels == [f"CPDI, 4 per cell, {axis} {value}" for value in two]
    assert [record.columns(s.first) for s in record.series] == [
        {"method": "cpdi", "solution": "axis_aligned", "ppc": 4, axis: value} for value in two
    ]
    with fixtures.sources():
        rows = json.loads(document(record, None, {}))["runs"]
        assert {row[axis] for row in rows} == set(two)
        told = [sentence(record, f).plain for f in record.findings if (f.plan.quantity, f.plan.norm) == ("u", "rms")]
    assert [str(value) in text for text, value in zip(told, two, strict=True)] == [True, True]


@pytest.mark.slow
@pytest.mark.parametrize(("axis", "two", "orders"), AXES[:2], ids=[name for name, _, _ in AXES[:2]])
def test_document_tables_and_page_name_both(
    axis: str, two: tuple[Any, ...], orders: tuple[float, ...], tmp_path: Path
) -> None:
    from jsonschema import Draft202012Validator

    record = drawn(tmp_path, axis, two, orders)
    with fixtures.sources():
        told = json.loads(document(record, None, {}))
        Draft202012Validator(schema("mms")).validate(told)
        rows = [row for row in told["verdicts"] + told["shown"] if (row["quantity"], row["norm"]) == ("u", "rms")]
        assert {row[axis]: [round(order, 6) for order in row["local_orders"]] for row in rows} == {
            value: [order] * 2 for value, order in zip(two, orders, strict=True)
        }
        text = page(record).read_text()
    assert all(f"{axis} {value}" in text for value in two)
    table = pd.read_csv(tmp_path / "tables" / "orders.csv").query("quantity == 'u' and norm == 'rms'")
    for value, order in zip(two, orders, strict=True):
        assert list(table[table[axis] == value].order) == pytest.approx([order] * 2)


def test_one_value_is_no_part_of_a_label(tmp_path: Path) -> None:
    record = drawn(tmp_path, "transfer", ("apic",), (1.0,))
    assert record.varied == ()
    assert [record.label(s.first) for s in record.series] == ["CPDI, 4 per cell"]


# ---- real runs


def test_flip_and_apic_run_side_by_side(tmp_path: Path) -> None:
    """Each with its own errors, those that it has when it runs alone; of FLIP they are the recorded ones."""
    study = swept("transfer", ("flip", "apic"), (8, 16))
    store = Store(tmp_path)
    store.create(study)
    results = run_study(study, store, InProcess(), 1)
    levels = {
        f.plan.run.transfer: [level.errors[0] for level in f.levels]
        for f in findings(store.study(), results)
        if (f.plan.quantity, f.plan.norm) == ("u", "rms")
    }
    assert levels["flip"] == pytest.approx(fixtures.U_RMS["cpdi", 4][:2], rel=1e-3)
    assert levels["apic"] == pytest.approx([1.218e-3, 1.939e-4], rel=1e-3)


def test_particles_that_all_lie_elsewhere_are_a_refinement() -> None:
    """Judged by its order: recorded errors are those of particles at their usual positions."""
    asked = Asked("mms", {"offset": ((0.3, 0.2),), "cells": (8, 12, 16, 24), "ppc": (4,)})
    study = build(asked, "verify", "t")
    (one,) = {plan.run.offset for plan in study.plans}
    assert one == (0.3, 0.2)
    (series,) = collect(study.runs)
    assert [run.cells for run in series.runs] == [8, 12, 16, 24]
    assert series.halved
    expected = next(plan.expectation for plan in study.plans if plan.judged)
    assert expected
    assert (expected.order, expected.recorded) == (2, ())
