"""Dask cluster that is there: its workers do the runs, and what comes back is stored by whoever can write.

The executor is Dask's own (`Client.get_executor`), so it schedules, and does a run elsewhere whose worker died; a run
whose workers keep dying is a failed Result. A worker says what its numbers hang on, and one that has other sources or
versions than this machine, or another processor than the others, is not given a run. `distributed` is imported where it
is used.
"""

import logging
import pickle
import secrets
import time
from collections import deque
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from mpm_verify.cases.harness.checkpoint import News, Note, NoteCode
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.environment import numerics
from mpm_verify.cases.harness.runner import Hands, Result, Run, RunnerError
from mpm_verify.cases.harness.scheduler import TIMEOUT, check_reachable, scheduler, unreachable
from mpm_verify.cases.harness.store import Disk, Store, StoreError
from mpm_verify.cases.harness.worker import Terms, at_work, differs, facts, seen, work, write
from mpm_verify.solver.failure import Failure, FailureKind

SEEN = 10.0  # s until a file that a worker wrote is seen here


class Cluster(Hands):
    """Workers of a Dask scheduler, for the runs of one study.

    Parameters
    ----------
    client
        Client of distributed.
    """

    def __init__(self, client: Any) -> None:
        self.client, self.executor = client, client.get_executor(pure=False)
        self.topic, self.news = f"mpm-verify-{secrets.token_hex(4)}", deque[News]()
        self.facts, self.processor = facts(), ""
        self.disk = Through(self)
        client.subscribe_topic(self.topic, self.hear)

    def check(self) -> int:
        """Check what the workers have that are there now, and count them. Raises ValueError with one line."""
        found = self.client.run(at_work, on_error="return")
        for worker, there in found.items():
            if isinstance(there, BaseException):
                raise ValueError(
                    f"the worker {worker} cannot be asked for its sources: {there}; install mpm_verify there, as here"
                )
            if line := differs(worker, there, self.facts):
                raise ValueError(line)
            if there["threads"] != "1":
                raise ValueError(
                    f"the worker {worker} has {there['threads']} threads and would do as many runs in one process; "
                    "start workers with --nthreads 1, and more of them"
                )
            self.check_processor(there["processor"])
        return len(found)

    def check_processor(self, processor: str) -> None:
        """Raise ValueError for another processor than that of the workers so far."""
        self.processor = self.processor or processor
        if processor != self.processor:
            raise ValueError(
                f"workers have the processors {self.processor} and {processor}, which give other bits; ask for one kind"
            )

    def hear(self, event: tuple[float, Any]) -> None:
        """Hear what a worker tells; called by the client's own thread."""
        digest, told = event[1]
        if isinstance(told, dict):
            told = Note(**{**told, "code": NoteCode(told["code"])})
        self.news.append((digest, told))

    def heard(self) -> list[News]:
        """News since this was last called."""
        return [self.news.popleft() for _ in range(len(self.news))]

    def give(self, executor: Executor, run: Run, store: Store, threads: int, every: float) -> "Future[Any]":
        """Send a run to the workers."""
        terms = Terms(store.folder.absolute(), seen(store), threads, every, self.topic, self.facts)
        return executor.submit(work, pickle.dumps(run), store.case, run.digest, terms)

    def take(self, run: Run, store: Store, future: "Future[Any]") -> Result:
        """Store what comes back. Raises RunnerError where the scheduler is gone, or a worker is another machine."""
        from distributed import KilledWorker

        try:
            files, processor = future.result()
        except CancelledError as error:
            raise RunnerError(
                "the Dask scheduler does not answer any more; stored runs are kept, and the same command goes on"
            ) from error
        except KilledWorker as error:
            failure = Failure(FailureKind.WORKER_DIED, step=-1, numbers={"times": error.allowed_failures + 1.0})
            result = case_named(run.case).module.Result(
                run=run, digest=run.digest, status="failed", failure=failure, environment=numerics()
            )
            store.put_files(run.digest, store.files(result, {}))
            return result  # its checkpoint stays: the same command goes on from there
        try:
            self.check_processor(processor)
        except ValueError as error:
            raise RunnerError(f"{error}; stored runs are kept") from error
        store.put_files(run.digest, files)
        with suppress(OSError):
            (store.runs / f"{run.digest}.checkpoint").unlink(missing_ok=True)
        return store.get(run.digest)

    def close(self) -> None:
        """Cancel what is not done: workers stop at their next step."""
        self.executor.shutdown(wait=False)
        self.client.close(timeout=TIMEOUT)


class Through(Disk):
    """Writes by this process, or by a worker that can, where this one cannot."""

    def __init__(self, cluster: Cluster) -> None:
        self.cluster = cluster

    def make(self, folder: Path) -> None:
        """Make a folder."""
        try:
            super().make(folder)
        except StoreError as error:
            self.ask(folder.absolute() / ".written-by-a-worker", b"", error)

    def write(self, path: Path, data: bytes) -> None:
        """Write a file atomically."""
        try:
            super().write(path, data)
        except StoreError as error:
            self.ask(path.absolute(), data, error)

    def ask(self, path: Path, data: bytes, here: StoreError) -> None:
        """Ask one worker after the other, until a file is seen here. Raises the error of this process if none is."""
        for worker in list(self.cluster.client.nthreads()):
            told = self.cluster.client.run(write, str(path), data, workers=[worker], on_error="return")
            if told.get(worker) == "" and appears(path, data):
                return
        raise here


def appears(path: Path, data: bytes) -> bool:
    """Whether a file has these contents here, after a while: a network folder shows late what others wrote."""
    until = time.monotonic() + SEEN
    while True:
        with suppress(OSError):
            if path.read_bytes() == data:
                return True
        if time.monotonic() > until:
            return False
        time.sleep(0.2)


@contextmanager
def quiet() -> Iterator[None]:
    """Silence of the loggers of distributed: what matters is told in one line."""
    loggers = [logging.getLogger(name) for name in logging.root.manager.loggerDict if name.startswith("distributed")]
    levels = [logger.level for logger in loggers]
    try:
        for logger in loggers:
            logger.setLevel(logging.CRITICAL + 1)
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


@contextmanager
def connected(address: str) -> Iterator[Cluster]:
    """Cluster of a scheduler's address or file, until the end of a study. Raises ValueError with one line."""
    if find_spec("distributed") is None:
        raise ValueError("--dask needs the package distributed; install it: pip install distributed")
    check_reachable(address)
    import warnings

    import dask
    from distributed import Client

    with dask.config.set({"distributed.comm.timeouts.connect": f"{TIMEOUT:g}s"}), quiet():
        given = scheduler(address)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of versions, which are checked
                client = Client(given, timeout=TIMEOUT, set_as_default=False)
        except Exception as error:  # whatever an answer in another protocol is taken for
            raise unreachable(address) from error
        cluster = Cluster(client)
        try:
            yield cluster
        finally:
            cluster.close()
