"""The runner: what is stored is not run again, on any executor, whatever becomes of a single run."""

import contextlib
import os
import signal
from collections.abc import Callable
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import fixtures_study as fixtures
import numpy as np
import pytest

from mpm_verify.cases.harness.runner import RunnerError, Ticker, cost, interruptible, pending, process_pool, run_study
from mpm_verify.cases.harness.store import Arrays, Store, StoreError
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.mms import execute as mms
from mpm_verify.cases.mms.run import Result, Run


class Serial(Executor):
    """The least that is an executor: each call is done at once, here."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except BaseException as error:  # as the executors of the standard library do
            future.set_exception(error)
        return future


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[Run]:
    """The runs that were executed, in order; known results take the place of the solver."""
    executed: list[Run] = []

    def execute(run: Run, tick: object) -> tuple[Result, Arrays]:
        executed.append(run)
        return fixtures._result(run), {}

    monkeypatch.setattr(mms, "execute", execute)
    return executed


def small(**changes: Any) -> Study:
    return fixtures.built(**{"cells": (8, 16, 32), "ppc": (1, 4)} | changes)


def opened(folder: Path, study: Study) -> Store:
    store = Store(folder)
    store.create(study)
    return store


# ---- what is run, and in which order


def test_what_is_stored_is_not_run_again(tmp_path: Path, calls: list[Run]) -> None:
    study = small()
    store = opened(tmp_path, study)
    first = run_study(study, store, Serial(), 1)
    assert sorted(run.digest for run in calls) == sorted(run.digest for run in study.runs)
    calls.clear()
    assert run_study(study, store, Serial(), 1) == first
    assert calls == []


def test_a_wider_study_runs_only_what_is_new(tmp_path: Path, calls: list[Run]) -> None:
    study = small(method=("mpm",))
    run_study(study, opened(tmp_path, study), Serial(), 1)
    calls.clear()
    wider = small(method=("mpm",), cells=(8, 16, 32, 64))
    results = run_study(wider, opened(tmp_path, wider), Serial(), 1)
    assert {run.cells for run in calls} == {64}
    assert results.keys() == {run.digest for run in wider.runs}


def test_results_of_other_sources_are_run_again(
    tmp_path: Path, calls: list[Run], monkeypatch: pytest.MonkeyPatch
) -> None:
    study = small()
    store = opened(tmp_path, study)
    run_study(study, store, Serial(), 1)
    monkeypatch.setattr("mpm_verify.cases.harness.identity.sources", lambda *_: "changed")
    assert len(pending(study, store)) == len(study.runs)


def test_failed_runs_are_results_and_not_run_again(tmp_path: Path, calls: list[Run]) -> None:
    study = small(method=("mpm",))
    store = opened(tmp_path, study)
    results = run_study(study, store, Serial(), 1)
    failed = [(r.run.cells, r.run.ppc) for r in results.values() if r.status == "failed"]
    assert failed == [(16, 1), (32, 1)]
    assert len(calls) == len(study.runs)  # the sweep went on
    assert pending(study, store) == []


def test_longest_first(tmp_path: Path, calls: list[Run]) -> None:
    study = small(cells=(8, 64, 16, 32))
    run_study(study, opened(tmp_path, study), Serial(), 1)
    costs = [cost(run) for run in calls]
    assert costs == sorted(costs, reverse=True)
    assert (calls[0].cells, calls[0].ppc, calls[0].courant) == (64, 4, 0.2)


@pytest.mark.parametrize(
    ("change", "factor"), [({"cells": 16}, 8), ({"ppc": 9}, 9 / 4), ({"courant": 0.2}, 2), ({"method": "mpm"}, 1)]
)
def test_cost_counts_particle_updates(change: dict[str, Any], factor: float) -> None:
    run = Run("cpdi", "axis_aligned", "neo_hookean", 8, 4, 0.4)
    assert cost(replace(run, **change)) == pytest.approx(factor * cost(run))


def test_done_hears_of_each_new_result_once(tmp_path: Path, calls: list[Run]) -> None:
    study = small()
    store = opened(tmp_path, study)
    store.put(fixtures._result(study.runs[0]), {})
    heard: list[Run] = []
    run_study(study, store, Serial(), 1, lambda result: heard.append(result.run))
    assert sorted(run.digest for run in heard) == sorted(run.digest for run in study.runs[1:])


# ---- how far a run is


def test_ticker_tells_at_most_a_few_times_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[tuple[str, float]] = []
    clock = iter(np.arange(0.0, 10.0, 0.125).tolist())
    monkeypatch.setattr(Ticker, "tell", staticmethod(told.append))
    monkeypatch.setattr("time.monotonic", lambda: next(clock))
    ticker = Ticker("name")
    for step in range(12):
        ticker((step + 1) / 12)
    assert told == [("name", 3 / 12), ("name", 6 / 12), ("name", 9 / 12), ("name", 1.0)]


def tick_once(digest: str) -> None:
    Ticker.tell((digest, 0.5))


def test_an_interrupt_that_was_swallowed_ends_the_run_all_the_same() -> None:
    before = signal.getsignal(signal.SIGINT)
    with interruptible():
        Ticker("run")(0.1)
        with contextlib.suppress(KeyboardInterrupt):  # as a library does that tries an import
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            Ticker("run")(0.2)
    Ticker("run")(0.3)
    assert signal.getsignal(signal.SIGINT) is before


def test_workers_tell_their_news() -> None:
    with process_pool(1, "mms") as (pool, heard):
        assert heard() == []
        pool.submit(tick_once, "name").result()
        assert heard() == [("name", 0.5)]
        assert heard() == []


def test_poll_is_called_while_runs_are_under_way(tmp_path: Path, calls: list[Run]) -> None:
    polls: list[int] = []
    study = small()
    run_study(study, opened(tmp_path, study), Serial(), 1, poll=lambda: polls.append(len(calls)))
    assert polls


# ---- on which executor


@pytest.mark.parametrize("executor", [Serial, lambda: ThreadPoolExecutor(1), lambda: ThreadPoolExecutor(4)])
def test_any_executor(tmp_path: Path, calls: list[Run], executor: Callable[[], Executor]) -> None:
    study = small(cells=(8, 16, 32, 64), method=("cpdi", "mpm"))
    with executor() as pool:
        results = run_study(study, opened(tmp_path, study), pool, 1)
    assert results == {run.digest: fixtures._result(run) for run in study.runs}


def test_two_processes_give_the_numbers_of_one(tmp_path: Path) -> None:
    study = fixtures.built(method=("cpdi", "mpm"), cells=(8, 16), ppc=(1, 4))
    alone = opened(tmp_path / "alone", study)
    here = run_study(study, alone, Serial(), 1)
    shared = opened(tmp_path / "shared", study)
    with process_pool(2, "mms") as (pool, _):
        there = run_study(study, shared, pool, 1)
    assert here.keys() == there.keys() == {run.digest for run in study.runs}
    assert any(result.status == "failed" for result in here.values())  # classical MPM with 1 per cell
    for digest, result in here.items():
        # the commit may be told differently: it is asked for once a process
        same = {"wall_s": 0.0, "cpu_s": 0.0, "peak_memory_mb": 0.0, "environment": {}}
        assert replace(result, **same) == replace(there[digest], **same)
        ours, theirs = alone.arrays(digest), shared.arrays(digest)
        assert ours.keys() == theirs.keys()
        for name in ours:
            np.testing.assert_array_equal(ours[name], theirs[name])


# ---- what can go wrong outside a run


def arm(deadly: int) -> None:
    """From now on this process dies, as for want of memory, in a run of so many cells; others are done."""

    def execute(run: Run, tick: object) -> tuple[Result, Arrays]:
        if run.cells == deadly:
            os._exit(9)
        return fixtures._result(run), {}

    mms.execute = execute


def test_dying_worker(tmp_path: Path) -> None:
    study = small(ppc=(1,))
    store = opened(tmp_path, study)
    with process_pool(1, "mms") as (pool, _):
        pool.submit(arm, 16).result()
        with pytest.raises(RunnerError, match=r"a worker process died.*try --jobs 1; stored runs are kept") as told:
            run_study(study, store, pool, 1)
    assert "\n" not in str(told.value)
    assert [run.cells for run in study.runs if store.get(run.digest)] == [32]  # the longest came first


@pytest.mark.parametrize("cells", [8, 16])
def test_not_enough_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cells: int) -> None:
    def execute(run: Run, tick: object) -> tuple[Result, Arrays]:
        if run.cells == cells:
            raise MemoryError
        return fixtures._result(run), {}

    monkeypatch.setattr(mms, "execute", execute)
    study = small(ppc=(1,))
    store = opened(tmp_path, study)
    with pytest.raises(RunnerError, match="not enough memory; try --jobs 1 or fewer cells") as told:
        run_study(study, store, Serial(), 1)
    assert "\n" not in str(told.value)
    assert [run.cells for run in study.runs if store.get(run.digest)] == [c for c in (8, 16, 32) if c != cells]


def test_store_that_cannot_be_written(tmp_path: Path, calls: list[Run]) -> None:
    study = small()
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="cannot write"):
        run_study(study, Store(tmp_path / "file"), Serial(), 1)


def test_broken_result_is_told_before_anything_runs(tmp_path: Path, calls: list[Run]) -> None:
    study = small()
    store = opened(tmp_path, study)
    (store.runs / f"{study.runs[0].digest}.json").write_text("{")
    with pytest.raises(StoreError, match="is broken"):
        run_study(study, store, Serial(), 1)
    assert calls == []
