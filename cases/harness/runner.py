"""Runner: takes each run that the store does not hold yet, on any executor; a failed run is a Result like any other."""

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import fields
from math import inf
from multiprocessing.queues import SimpleQueue as Queue
from os import _exit  # before a user's file is executed, see solver/own_file.py
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from mpm_verify.cases.harness.checkpoint import Checkpoint, News
from mpm_verify.cases.harness.contract import Case, case_named
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.solver.failure import FailureKind
from mpm_verify.solver.own_file import OwnFileError, blamed, said, shortened
from mpm_verify.solver.plugins import absolute, is_file, split

T = TypeVar("T")
Run = Any  # of any case: digest, case, cost; Results and Studies likewise
Result = Any
Study = Any


class RunnerError(Exception):
    """Error outside the runs that stops them, in one line. `defect` says that the reason is in this program."""

    def __init__(self, message: str, defect: bool = False) -> None:
        super().__init__(message)
        self.defect = defect


def cost(run: Run) -> float:
    """Particle updates, up to a factor: what a run takes grows with it."""
    return float(run.cost)


def pending(study: Study, store: Store) -> list[Run]:
    """The runs still to be done, the longest first, so that none is left alone at the end."""
    once = {run.digest: run for run in study.runs}
    return sorted((run for digest, run in once.items() if to_be_done(run, store.get(digest))), key=cost, reverse=True)


def to_be_done(run: Run, result: Result) -> bool:
    """Whether a run has no Result yet, or a failed one that counts for nothing."""
    died = result is not None and result.failure is not None and result.failure.kind is FailureKind.WORKER_DIED
    return result is None or (run.again and result.status == "failed") or died


def perform(run: Run, digest: str, folder: Path, threads: int, every: float = inf) -> Result:
    """Run one run in this process and store its Result, with a checkpoint `every` so many seconds.

    Raises as `computed`.
    """
    store, checkpoint = Store(folder, run.case), checkpoint_of(folder, digest, every)
    result, files = computed(run, digest, store, threads, checkpoint)
    store.put_files(digest, files)
    checkpoint.remove()
    return result


def checkpoint_of(folder: Path, digest: str, every: float) -> Checkpoint:
    """Checkpoint of a run in a study's folder; its notes are told as the progress of the run is."""
    path = Store(folder).runs / f"{digest}.checkpoint"
    return Checkpoint(path, digest, every, lambda note: Ticker.tell((digest, note)))


def computed(
    run: Run, digest: str, store: Store, threads: int, checkpoint: Checkpoint
) -> tuple[Result, dict[str, bytes]]:
    """Run one run in this process: its Result, and the files that store it; not enough memory is no Result.

    Raises RunnerError where a user's file does not return what it did when the run was named `digest`, before or after.
    """
    from mpm_verify.solver._jit import use_threads

    use_threads(threads)
    if run.digest != digest:
        raise another(run)
    try:
        result, arrays = case_named(run.case).execute(run, Ticker(digest), checkpoint)
        check_result(case_named(run.case), run, result, arrays)
        if result.digest != digest:
            raise another(run)
        files = store.files(result, arrays)
    except (RunnerError, StoreError, MemoryError):
        raise
    except (Exception, SystemExit) as error:
        line = blame(run, error)
        if not line:
            raise
        raise OwnFileError(line) from error
    return result, files


def blame(run: Run, error: BaseException) -> str:
    """Line that an error of a run has, where a user's file raised it or the run has one; empty for one of ours alone.

    The traceback is asked, which does not go from one process to another.
    """
    if line := blamed(error):
        return line
    if is_file(run.case):
        return f"{run.case}: {error if isinstance(error, ValueError) else said(error)}"
    named = [getattr(run, item.name) for item in fields(run) if item.metadata.get("plugins")]
    files = ", ".join(absolute(split(one)[0]) for one in named if is_file(one))
    return f"{files}: what it gives cannot be worked with, {said(error)}" if files else ""


def check_result(case: Case, run: Run, result: Result, arrays: Any) -> None:
    """Raise ValueError, in one line, for what is no Result of this run, or does not hold what is judged."""
    if not isinstance(result, case.module.Result) or not isinstance(arrays, dict):
        raise ValueError(f"execute must return (Result, arrays), not {shortened((result, arrays))}")
    if result.run != run:
        raise ValueError(f"execute returns the Result of another run, {shortened(result.run)}; write run=run")
    if result.status == "failed":
        if result.failure is None:
            raise ValueError("execute returns a Result that failed and has no failure; write failure=Failure(...)")
        return
    for quantity, norm in case.measures(run):
        if run.again and quantity not in result.errors:  # what somebody else's solver does not write
            continue
        if norm not in result.errors.get(quantity, {}):
            held = shortened(result.errors)
            raise ValueError(f"execute returns a Result without errors[{quantity!r}][{norm!r}]; it has {held}")


def another(run: Run) -> RunnerError:
    """Error of a run that is not stored, as what computes it has changed."""
    return RunnerError(
        f"what computes {run} is not what it was when the study began: a file was changed, or returns something else "
        "each time it is read; make it return the same and start again; stored runs are kept"
    )


class Ticker:
    """Listener of a run that tells its progress, a few times a second at most, to `tell` of this process."""

    tell: ClassVar[Callable[[News], None]] = staticmethod(lambda news: None)
    PAUSE = 0.25  # seconds
    stopped: ClassVar[bool] = False  # by Ctrl-C, see interruptible

    def __init__(self, digest: str) -> None:
        self.digest, self.last = digest, time.monotonic()

    def __call__(self, fraction: float) -> None:
        """Tell that the run has done this fraction of its steps. Raises KeyboardInterrupt where Ctrl-C was pressed."""
        if Ticker.stopped:
            raise KeyboardInterrupt
        now = time.monotonic()
        if now - self.last > self.PAUSE:
            self.last = now
            type(self).tell((self.digest, fraction))


@contextmanager
def interruptible() -> Iterator[None]:
    """Let Ctrl-C end a run at its next step even where a library that is being imported takes the exception."""

    def stop(number: int, frame: object) -> None:
        Ticker.stopped = True
        raise KeyboardInterrupt

    Ticker.stopped = False
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        Ticker.stopped = False


class Hands:
    """Way of runs to an executor and of their Results back; processes of this machine store what they have done."""

    def give(self, executor: Executor, run: Run, store: Store, threads: int, every: float) -> "Future[Any]":
        """Submit a run."""
        return executor.submit(perform, run, run.digest, store.folder, threads, every)

    def take(self, run: Run, store: Store, future: "Future[Any]") -> Result:
        """Result of a run that has ended, which is stored. Raises what ended it."""
        return future.result()


def run_study(
    study: Study,
    store: Store,
    executor: Executor,
    threads: int,
    done: Callable[[Result], None] = lambda result: None,
    poll: Callable[[], None] = lambda: None,
    every: float = inf,
    hands: Hands | None = None,
) -> dict[str, Result]:
    """Results of the study by digest; those that are stored are read, the others run.

    `done` hears of each new Result, `poll` is called a few times a second; a run that can writes a checkpoint `every`
    so many seconds. Raises RunnerError where a worker dies, StoreError where a Result cannot be written; what is stored
    stays.
    """
    hands = hands or Hands()
    waiting = {hands.give(executor, run, store, threads, every): run for run in pending(study, store)}
    defects: list[tuple[Run, Exception]] = []
    try:
        while waiting:
            finished, _ = wait(waiting, timeout=Ticker.PAUSE, return_when=FIRST_COMPLETED)
            poll()
            for future in finished:
                run = waiting.pop(future)
                try:
                    done(hands.take(run, store, future))
                except (StoreError, RunnerError, BrokenProcessPool, MemoryError):
                    raise
                except Exception as error:  # a defect of ours in one run: the sweep goes on, and says so at its end
                    defects.append((run, error))
    except BrokenProcessPool as error:
        raise RunnerError(
            "a worker process died, perhaps for want of memory; try --jobs 1; stored runs are kept"
        ) from error
    except MemoryError as error:
        raise RunnerError("not enough memory; try --jobs 1 or fewer cells; stored runs are kept") from error
    if defects:
        defects.sort(key=lambda one: isinstance(one[1], OwnFileError))  # ours first
        (run, defect), more = defects[0], f", and in {len(defects) - 1} more" if defects[1:] else ""
        if isinstance(defect, OwnFileError):
            raise RunnerError(f"{defect}; this was the run {run}{more}; the other runs are stored") from defect
        raise RunnerError(f"a defect of verify in {run}{more}: {defect!r}; the other runs are stored", True) from defect
    return stored(study, store)


class InProcess(Executor):
    """Executor that runs what is submitted at once, in this process."""

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Run the function; the future is done."""
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


def stored(study: Study, store: Store) -> dict[str, Result]:
    """Results that the store holds for the study, by digest."""
    found = ((run.digest, store.get(run.digest)) for run in study.runs)
    return {digest: result for digest, result in found if result is not None}


@contextmanager
def process_pool(jobs: int, case: str) -> Iterator[tuple[ProcessPoolExecutor, Callable[[], list[News]]]]:
    """Worker processes that end with this one, and a function that gives their news since it was last called.

    Spawned: a fork of a process that has used OpenMP threads hangs.
    """
    context = multiprocessing.get_context("spawn")
    news: Queue[News] = context.SimpleQueue()

    def heard() -> list[News]:
        items = []
        while not news.empty():
            items.append(news.get())
        return items

    others = set(multiprocessing.active_children())
    executor = ProcessPoolExecutor(jobs, mp_context=context, initializer=begin, initargs=(os.getpid(), news, case))
    try:
        yield executor, heard
    except BaseException:  # Ctrl-C among them: nobody waits for runs whose Results nobody will take
        for worker in set(multiprocessing.active_children()) - others:
            worker.terminate()
        raise
    finally:
        executor.shutdown(cancel_futures=True)


def begin(parent: int, news: "Queue[News]", case: str) -> None:
    """Begin a worker: where to tell news, a watch over the parent, and the records that come from a file.

    A worker that outlived its parent would do a run that the parent's successor does too.
    """
    sys.stdout = sys.stderr  # what a user's file prints is no part of a document
    with suppress(OSError):
        os.dup2(2, 1)
    Ticker.tell = staticmethod(news.put)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C goes to the whole group; the parent ends its workers

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.2)
        _exit(1)

    threading.Thread(target=watch, daemon=True).start()
    case_named(case)
