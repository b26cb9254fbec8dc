"""The axes beside the cells: which runs they ask for, what is made of their errors, and how the page shows them."""

import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from math import log
from pathlib import Path

import fixtures_study as fixtures
import numpy as np
import pandas as pd
import pytest
from jsonschema import Draft202012Validator

from mpm_verify.cases.harness.axes import UNDONE, cell_crossings, level, middle, particle_axes, position_axes, time_axes
from mpm_verify.cases.harness.build import Asked, named
from mpm_verify.cases.harness.refinement import MOST, collect, offsets
from mpm_verify.cases.harness.runner import InProcess, pending, run_study
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.harness.verdicts import findings, refinement
from mpm_verify.cases.judging.order import Expectation, Outcome
from mpm_verify.cases.judging.records import Ended
from mpm_verify.cases.mms.run import NORMS, QUANTITIES, Result, Run
from mpm_verify.reports import words
from mpm_verify.reports.export.document import schema
from mpm_verify.reports.figures.style import look
from mpm_verify.reports.frames import Record
from mpm_verify.reports.pages.mms import page
from mpm_verify.reports.sentences import verdicts
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.verify.main import main

BASE = Run("cpdi", "axis_aligned", "neo_hookean", 8, 4, 0.4)
Errors = Callable[[Run], float]


@pytest.fixture(autouse=True)
def sources() -> Iterator[None]:
    with fixtures.sources():
        yield


def results(runs: tuple[Run, ...], error: Errors) -> dict[str, Result]:
    """Results whose errors of every quantity are a function of the run."""
    return {run.digest: result(run, error(run)) for run in runs}


def result(run: Run, error: float) -> Result:
    usual = fixtures._result(replace(BASE, courant=run.courant))
    passed = usual.particles * run.cells // 4
    return replace(usual, run=run, digest=run.digest, errors=same(error), crossings=passed)


def same(error: float) -> dict[str, dict[str, float]]:
    return {quantity: dict.fromkeys(NORMS, error) for quantity in QUANTITIES}


def lost(run: Run, step: int) -> Result:
    return replace(result(run, 1.0), status="failed", errors={}, failure=Failure(FailureKind.INVERTED, step))


# ---- the runs of the study


def test_the_first_place_is_the_usual_one_and_the_others_cover_the_cell() -> None:
    places = np.array(offsets(MOST))
    assert places.shape == (MOST, 2)
    assert tuple(places[0]) == (0.0, 0.0)
    assert np.abs(places).max() < 0.5
    assert len({tuple(place) for place in places}) == MOST
    assert np.abs(places.mean(axis=0)).max() < 0.02
    counts = np.histogram2d(*places.T, bins=4, range=[(-0.5, 0.5)] * 2)[0]
    assert counts.min() >= 2  # random places leave one of sixteen parts below two in a third of draws


@pytest.mark.parametrize("few", [1, 2, 5, 16])
def test_more_replicates_keep_the_places_of_fewer(few: int) -> None:
    assert offsets(MOST)[:few] == offsets(few) == offsets(few)


def test_runs_of_each_axis() -> None:
    study = fixtures.built(3, cells=(8, 16), ppc=(4, 9), courant=(0.4, 0.2, 0.1))
    assert len(set(study.runs)) == len(study.runs) == 4 + 4 + 4 * 2  # the run with half the time step is of both
    assert {(r.cells, r.offset) for r in study.runs if r.courant < 0.4} == {(16, (0.0, 0.0))}
    assert sorted(r.courant for r in study.runs if r.cells == 16 and r.ppc == 9 and r.offset == (0, 0)) == [
        0.1,
        0.2,
        0.4,
    ]
    for cells in (8, 16):
        for ppc in (4, 9):
            places = [r.offset for r in study.runs if (r.cells, r.ppc, r.courant) == (cells, ppc, 0.4)]
            assert sorted(places) == sorted(offsets(3))


def test_series_keep_the_axes_apart() -> None:
    study = fixtures.built(3, method=("cpdi", "mpm"), cells=(8, 16), ppc=(4, 9), courant=(0.4, 0.2, 0.1))
    series = collect(tuple(reversed(study.runs)))
    assert [(s.first.method, s.first.ppc) for s in series] == [(m, p) for m in ("mpm", "cpdi") for p in (4, 9)]
    for s in series:
        assert [(r.cells, r.courant, r.offset) for r in s.runs] == [(8, 0.4, (0, 0)), (16, 0.4, (0, 0))]
        assert [len(runs) for runs in s.replicates] == [3, 3]
        assert all(runs[0] == run for runs, run in zip(s.replicates, s.runs, strict=True))
        assert [(r.cells, r.courant) for r in s.times] == [(16, 0.4), (16, 0.2), (16, 0.1)]
        assert s.halved == s.times[1]
    declared = fixtures.plan("mpm", "axis_aligned", 9, "u", "rms", False, None)
    assert refinement(declared, study.runs) == list(series[1].runs)


def test_an_offset_survives_the_store(tmp_path: Path) -> None:
    study = fixtures.built(4, cells=(8,), ppc=(4,))
    Store(tmp_path).create(study)
    assert Store(tmp_path).study().runs == study.runs
    assert [r.digest for r in Store(tmp_path).study().runs] == [r.digest for r in study.runs]


@pytest.mark.parametrize("asked", [Asked("mms", {"courant": (0.4, 0.2)}), Asked("mms", {}, 2)])
def test_another_axis_is_another_folder(asked: Asked) -> None:
    assert named(asked) != named(Asked("mms", {}))


# ---- what is made of the errors


def test_time_axis_of_an_error_of_space_and_one_of_time() -> None:
    runs = tuple(replace(BASE, courant=c) for c in (0.1, 0.4, 0.2, 0.05))
    (axis,) = time_axes(runs, results(runs, lambda run: 1e-3 + 0.1 * run.courant**2))
    assert axis.courants == (0.4, 0.2, 0.1, 0.05)
    assert axis.fractions[0] == pytest.approx((0.016 - 0.00025) / 0.017)
    assert axis.fractions[-1] == 0
    assert all(a > b for a, b in zip(axis.fractions, axis.fractions[1:], strict=False))
    assert axis.orders[0] == pytest.approx(log(0.017 / 0.005) / log(2))
    (pure,) = time_axes(runs, results(runs, lambda run: 0.1 * run.courant**2))
    assert pure.orders == pytest.approx([2, 2, 2])
    (flat,) = time_axes(runs, results(runs, lambda run: 1e-3))
    assert (flat.orders, flat.fractions) == ((0, 0, 0), (0, 0, 0, 0))


def test_time_axis_is_of_the_finest_cells_and_of_finished_runs() -> None:
    runs = (BASE, replace(BASE, cells=16), replace(BASE, cells=16, courant=0.2), replace(BASE, cells=16, courant=0.1))
    known = results(runs, lambda run: run.courant)
    known[runs[3].digest] = lost(runs[3], 5)
    (axis,) = time_axes(runs, known)
    assert (axis.run.cells, axis.courants) == (16, (0.4, 0.2))
    del known[runs[2].digest]
    assert time_axes(runs, known) == []


@pytest.mark.parametrize("order", [0.0, 1.0, 2.0])
def test_particle_axis(order: float) -> None:
    runs = tuple(replace(BASE, cells=cells, ppc=ppc) for ppc in (9, 1, 4, 25) for cells in (16, 8))
    axes = particle_axes(runs, results(runs, lambda run: run.cells**-2.0 * run.ppc ** (-order / 2)))
    assert [(a.run.cells, a.ppc) for a in axes] == [(8, (1, 4, 9, 25)), (16, (1, 4, 9, 25))]
    for a in axes:
        assert a.orders == pytest.approx([order] * 3)


def test_an_error_of_zero_has_no_order() -> None:
    runs = tuple(replace(BASE, ppc=ppc, courant=c) for ppc, c in ((1, 0.4), (4, 0.4), (4, 0.2)))
    known = results(runs, lambda run: 0.0)
    assert particle_axes(runs, known)[0].orders == (None,)
    assert (time_axes(runs, known)[0].orders, time_axes(runs, known)[0].fractions) == ((None,), (0.0, 0.0))


SCATTER = (1.0, 0.97, 1.03, 1.01)


def scattered(cells: tuple[int, ...] = (8, 16, 32, 64)) -> tuple[tuple[Run, ...], dict[str, Result]]:
    """Second order at four places; each level scatters alike, so all of them have the same order."""
    places = offsets(4)
    runs = tuple(replace(BASE, cells=n, offset=place) for n in cells for place in places)
    return runs, results(runs, lambda run: run.cells**-2.0 * SCATTER[places.index(run.offset)])


def test_position_axis() -> None:
    runs, known = scattered()
    (axis,) = position_axes(runs, known)
    assert axis.errors[0] == pytest.approx([s / 64 for s in SCATTER])
    assert axis.ends[1] == pytest.approx((0.97 / 256, 1.005 / 256, 1.03 / 256))
    assert axis.alone.slope is not None
    assert axis.together.slope is not None
    assert axis.alone.slope.value == pytest.approx(axis.together.slope.value) == pytest.approx(2)
    assert axis.alone.slope.interval(0.95) == pytest.approx((2, 2))  # one place has no scatter to tell of
    low, high = axis.together.slope.interval(0.95)
    assert 0.01 < high - low < 0.1


def test_replicates_are_one_level_of_the_verdict() -> None:
    runs, known = scattered()
    half = replace(BASE, cells=64, courant=0.2)
    known[half.digest] = result(half, 64**-2.0)
    declared = fixtures.plan("cpdi", "axis_aligned", 4, "u", "rms", True, Expectation(2.0))
    (found,) = findings(Study("t", "t", "c", (*runs, half), (declared,), case="mms"), known)
    assert [len(each.errors) for each in found.levels] == [4] * 4
    assert found.levels[0].errors[0] == 1 / 64  # the usual place first: the run with half the time step is there too
    assert found.verdict.outcome is Outcome.PASS
    assert found.verdict.interval is not None
    assert found.verdict.interval[1] > 2.005
    assert middle(found.levels[0].errors) == pytest.approx(np.prod(SCATTER) ** 0.25 / 64)


def test_a_level_without_one_of_its_replicates() -> None:
    runs, known = scattered((8,))

    def ended(results: dict[str, Result]) -> str:
        """Why the level has no error, in words."""
        _, failure, replicate = level(runs, results, "u", "rms")
        assert failure is not None
        return verdicts.ended(Ended(1 / 8, failure, replicate))

    errors, *why = level(runs, known, "u", "rms")
    assert (len(errors), why) == (4, [None, 0])
    early = {**known, runs[1].digest: lost(runs[1], 0)}
    assert level(runs, early, "u", "rms") == (errors[:1] + errors[2:], None, 0)  # its domains do not fit: left out
    late = {**known, runs[1].digest: lost(runs[1], 7)}
    assert level(runs, late, "u", "rms") == ((), Failure(FailureKind.INVERTED, 7), 1)
    assert ended(late) == "det F ≤ 0 at step 7, replicate 2"
    usual = {**known, runs[0].digest: lost(runs[0], 0)}
    assert level(runs, usual, "u", "rms") == ((), Failure(FailureKind.INVERTED, 0), 0)
    assert ended(usual) == "det F ≤ 0 at step 0"
    missing = {digest: r for digest, r in known.items() if digest != runs[3].digest}
    assert level(runs, missing, "u", "rms") == ((), UNDONE, 3)
    assert ended(missing) == "not run yet, replicate 4"


def test_crossings_are_per_particle() -> None:
    assert cell_crossings(None) is None
    assert cell_crossings(replace(result(BASE, 1.0), crossings=640, particles=256)) == 2.5


# ---- real runs


def test_positions_scatter_and_stay_second_order(tmp_path: Path) -> None:
    """Other places give other errors, by some percent; a second call runs only the places that are new."""
    study = fixtures.built(3, cells=(8, 16), ppc=(4,))
    store = Store(tmp_path)
    store.create(study)
    known = run_study(study, store, InProcess(), 1)
    (axis,) = position_axes(study.runs, known)
    for low, _, high in axis.ends:
        assert 1.002 < high / low < 1.2
    coarse, fine = (middle(errors) for errors in axis.errors)
    assert 1.8 < log(coarse / fine) / log(2) < 2.2
    more = fixtures.built(4, cells=(8, 16), ppc=(4,))
    assert [run.offset for run in pending(more, store)] == [offsets(4)[3]] * 2


def test_the_command(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    arguments = ["--cells", "8,16", "--ppc", "1,4", "--courant", "0.4,0.2,0.1", "--replicates", "2"]
    monkeypatch.setattr(sys, "argv", ["verify", "mms", *arguments, "--jobs", "1", "--out", "study", "--json", "--page"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 3
    document = json.loads(capsys.readouterr().out)
    Draft202012Validator(schema("mms")).validate(document)
    axes = document["axes"]
    assert [(a["ppc"], a["cells"], a["courants"]) for a in axes["time"]] == [(p, 16, [0.4, 0.2, 0.1]) for p in (1, 4)]
    assert [(a["cells"], a["ppc"]) for a in axes["particles"]] == [(8, [1, 4]), (16, [1, 4])]
    assert [[len(errors) for errors in a["errors"]] for a in axes["position"]] == [[2, 2], [2, 2]]
    assert all(len(v["crossings"]) == 2 for v in document["shown"] + document["verdicts"])
    assert {tuple(run["offset"]) for run in document["runs"]} == set(offsets(2))
    assert all(run["gap"] > 0 for run in document["runs"])
    text = (tmp_path / "study" / "report.html").read_text()
    assert all(f'<h2 id="{name}">' in text for name in ("time", "particles", "position"))
    figures = {file.name for file in (tmp_path / "study" / "figures").iterdir()}
    wanted = {
        f"{name}.{kind}" for name in ("time_step", "particles_cpdi", "position") for kind in ("svg", "pdf", "png")
    }
    assert wanted <= figures


# ---- the page


def test_an_axis_with_one_value_has_no_section(tmp_path: Path) -> None:
    runs = tuple(replace(BASE, cells=cells) for cells in (8, 16, 32))
    text = rendered(tmp_path, runs, lambda run: run.cells**-2.0)
    assert not any(f'<h2 id="{name}">' in text for name in ("time", "particles", "position"))
    names = {file.stem for folder in ("figures", "tables") for file in (tmp_path / folder).iterdir()}
    assert not {"time_step", "particles_cpdi", "position", "particles_per_cell", "stalls"} & names


def test_two_time_steps_are_a_table_without_a_figure(tmp_path: Path) -> None:
    runs = (BASE, replace(BASE, courant=0.2))
    text = rendered(tmp_path, runs, lambda run: 1e-3 * (1 + run.courant))
    assert '<h2 id="time">' in text
    assert "14.3 %" in text  # (1.4 - 1.2) / 1.4
    assert not (tmp_path / "figures" / "time_step.svg").exists()


def test_tables_hold_the_numbers_of_the_axes(tmp_path: Path) -> None:
    runs, _ = scattered((8, 16, 32))
    runs = (*runs, *(replace(BASE, cells=32, courant=c) for c in (0.2, 0.1)), replace(BASE, ppc=9))
    rendered(tmp_path, runs, lambda run: run.courant * SCATTER[offsets(4).index(run.offset)] / run.ppc / run.cells**2)
    tables = {
        name: pd.read_csv(tmp_path / "tables" / f"{name}.csv")
        for name in ("time_step", "particles_per_cell", "position")
    }
    times = tables["time_step"].query("quantity == 'u' and norm == 'rms'")
    assert list(times.courant) == [0.4, 0.2, 0.1]
    assert list(times.order)[1:] == pytest.approx([1, 1])
    assert list(times.fraction_of_time_step) == pytest.approx([0.75, 0.5, 0])
    counts = tables["particles_per_cell"].query("quantity == 'F' and norm == 'max'")
    assert list(counts.ppc) == [4, 9]
    assert list(counts.order_in_spacing)[1] == pytest.approx(2, abs=0.02)
    places = tables["position"].query("quantity == 'u' and norm == 'final'")
    assert list(places.largest / places.smallest) == pytest.approx([1.03 / 0.97] * 3)
    orders = pd.read_csv(tmp_path / "tables" / "orders.csv").query("quantity == 'u' and norm == 'rms'")
    assert list(orders.order) == pytest.approx([2, 2])
    assert list(orders.crossings_per_particle) == [4, 8]  # of the finer cells


def test_errors_of_the_page_are_those_that_are_judged(tmp_path: Path) -> None:
    """The mean over the places, not the usual place."""
    runs, _ = scattered((8, 16, 32))
    text = rendered(tmp_path, runs, lambda run: run.cells**-2.0 * (1.0 if run.offset == (0, 0) else 1.1))
    assert words.sci(1.1**0.75 / 64) in text
    assert "of the geometric mean over 4 runs" in text


@pytest.mark.slow
def test_seven_methods_stay_readable(tmp_path: Path) -> None:
    """Tables of many rows are folded, and every method has a look of its own."""
    names = ("mpm", "gimp", "cpgimp", "cpdi", "cpdi2", "bspline2", "bspline3")
    runs = tuple(replace(BASE, method=m, ppc=p, cells=n) for m in names for p in (4, 9) for n in (8, 16, 32))
    text = rendered(tmp_path, runs, lambda run: run.cells**-2.0)
    assert "Error of u in rms against the particles per cell: 42 rows" in text
    looks = {(look(names, m, p).colour, look(names, m, p).marker) for m in names for p in (4, 9)}
    assert len(looks) == 7
    assert len({look(names, "mpm", p).line for p in (1, 4, 9, 16)}) == 4


def rendered(folder: Path, runs: tuple[Run, ...], error: Errors) -> str:
    """The page of a study with these runs."""
    heads = dict.fromkeys((run.method, run.ppc) for run in runs)
    declared = tuple(fixtures.plan(m, "axis_aligned", p, "u", "rms", False, None) for m, p in heads)
    study = Study("t", "t", "verify mms", runs, declared, case="mms")
    store = Store(folder)
    store.create(study)
    known = results(runs, error)
    for each in known.values():
        store.put(each, {})
    record = Record(store, study, known, earlier=False)
    return page(record).read_text()
