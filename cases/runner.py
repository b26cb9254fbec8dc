"""Takes each run that the store does not hold yet, on any executor; what fails is a result and the sweep goes on."""

import multiprocessing
import os
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from importlib import import_module
from pathlib import Path

from cases.store import Store
from cases.study import Result, Run, Study


class RunnerError(Exception):
    """The runs cannot go on, for a reason outside them; one line."""


def cost(run: Run) -> float:
    """Particle updates, up to a factor: what a run takes grows with it."""
    return run.cells**3 * run.ppc / run.courant


def pending(study: Study, store: Store) -> list[Run]:
    """The runs still to be done, the longest first, so that none is left alone at the end."""
    return sorted((run for run in study.runs if store.get(run.digest) is None), key=cost, reverse=True)


def perform(run: Run, folder: Path, threads: int) -> Result:
    """One run, in whichever process this is, to its place in the store. Memory that does not suffice is not stored."""
    from solver._jit import use_threads

    use_threads(threads)
    result, arrays = import_module(f"cases.library.{run.case}").execute(run)
    Store(folder).put(result, arrays)
    stored: Result = result
    return stored


def run_study(
    study: Study, store: Store, executor: Executor, threads: int, done: Callable[[Result], None] = lambda result: None
) -> dict[str, Result]:
    """All Results of the study by digest; those that are stored are read, the others run. `done` hears of each new one.

    Raises RunnerError where a worker dies, StoreError where a Result cannot be written; what is stored stays.
    """
    futures: dict[Future[Result], Run] = {
        executor.submit(perform, run, store.folder, threads): run for run in pending(study, store)
    }
    try:
        for future in as_completed(futures):
            done(future.result())
    except BrokenProcessPool as error:
        raise RunnerError(
            "a worker process died, perhaps for want of memory; try --jobs 1; stored runs are kept"
        ) from error
    except MemoryError as error:
        raise RunnerError("not enough memory; try --jobs 1 or fewer cells; stored runs are kept") from error
    finally:
        for future in futures:
            future.cancel()
    return stored(study, store)


def stored(study: Study, store: Store) -> dict[str, Result]:
    """The Results that the store holds for the study."""
    found: Iterator[tuple[str, Result | None]] = ((run.digest, store.get(run.digest)) for run in study.runs)
    return {digest: result for digest, result in found if result is not None}


def process_pool(jobs: int) -> ProcessPoolExecutor:
    """Worker processes that end with this one. Spawned: a fork of a process that has used OpenMP threads hangs."""
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(jobs, mp_context=context, initializer=end_with_parent, initargs=(os.getpid(),))


def end_with_parent(parent: int) -> None:
    """Watch the parent process: a worker that outlives it would do a run that its successor does too."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.2)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
