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
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, fields
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from mpm_verify.cases.harness.checkpoint import Checkpoint, News, Note, NoteCode
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.environment import numerics
from mpm_verify.cases.harness.runner import Hands, Result, Run, RunnerError, Ticker, checkpoint_of, computed
from mpm_verify.cases.harness.scheduler import TIMEOUT, check_reachable, scheduler, unreachable
from mpm_verify.cases.harness.store import Disk, Store, StoreError
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.solver.plugins import is_file, split
from mpm_verify.solver.source_hash import package_hash

PACE = 1.0  # s between two fractions that a worker tells
SEEN = 10.0  # s until a file that a worker wrote is seen here
OTHER = {"sources": "sources of mpm_verify", "python": "Python", "numpy": "NumPy", "scipy": "SciPy", "numba": "Numba"}


@dataclass(frozen=True)
class Terms:
    """Terms of a study that its workers work on.

    Parameters
    ----------
    folder
        Folder of the study, absolute.
    study
        Hash of its study.json: a worker that sees the same file sees the same folder.
    threads, every
        Threads of a run, and seconds between its checkpoints.
    topic
        Name under which workers tell their progress.
    facts
        What each of them must have.
    """

    folder: Path
    study: str
    threads: int
    every: float
    topic: str
    facts: dict[str, str]


def facts() -> dict[str, str]:
    """Facts that the numbers of this process hang on: sources, versions, processor."""
    return {"sources": package_hash(), **numerics()}


def at_work(dask_worker: Any) -> dict[str, str]:
    """Facts of a worker, with the number of its threads."""
    return {**facts(), "threads": str(dask_worker.state.nthreads)}


def differs(worker: str, there: dict[str, str], here: dict[str, str]) -> str:
    """Line on what a worker has that is not as it is here; empty where nothing is. Processors are another matter."""
    for name, value in here.items():
        if name != "processor" and there.get(name) != value:
            if name == "sources":
                return f"the worker {worker} has other sources of mpm_verify than this machine; install the same there"
            has, what = there.get(name), OTHER.get(name, name)
            return f"the worker {worker} has {what} {has}, and this machine {value}; install the same there"
    return ""


# ---- on a worker


def work(packed: bytes, case: str, digest: str, terms: Terms) -> tuple[dict[str, bytes], str]:
    """Run one run on a worker: the files that store it, and the processor. Raises RunnerError as `computed`."""
    from distributed import get_worker

    worker = get_worker()
    if line := differs(worker.address, facts(), terms.facts):
        raise RunnerError(line)
    run = unpacked(packed, case, worker.address)
    store, before = Store(terms.folder, case), Ticker.tell
    sees = seen(store) == terms.study
    checkpoint = checkpoint_of(terms.folder, digest, terms.every) if sees else Checkpoint()
    try:
        Ticker.tell = staticmethod(teller(worker, terms.topic))
        _, files = computed(run, digest, store, terms.threads, checkpoint)
    finally:
        Ticker.tell = staticmethod(before)
    return files, numerics()["processor"]


def unpacked(packed: bytes, case: str, worker: str) -> Run:
    """Run that was sent. Raises RunnerError where a user's file is not there."""
    if is_file(case) and not Path(case).is_file():
        raise RunnerError(absent(worker, case))
    case_named(case)  # the records of a user's case are defined in its file
    run = pickle.loads(packed)
    named = [split(getattr(run, item.name))[0] for item in fields(run) if item.metadata.get("plugins")]
    for file in named:
        if is_file(file) and not Path(file).is_file():
            raise RunnerError(absent(worker, file))
    return run


def absent(worker: str, file: str) -> str:
    """Line on a user's file that a worker has not."""
    return f"the worker {worker} has no file {file}; files of yours must be on the workers, under the same path"


def seen(store: Store) -> str:
    """Hash of study.json; empty where there is none."""
    try:
        return sha256((store.folder / "study.json").read_bytes()).hexdigest()
    except OSError:
        return ""


def teller(worker: Any, topic: str) -> Callable[[News], None]:
    """Function that sends news to the client, and raises RunnerError once nobody waits for the run."""
    key, last = worker.get_current_task(), [0.0]

    def tell(news: News) -> None:
        task = worker.state.tasks.get(key)
        if task is None or task.state != "executing":
            raise RunnerError("stopped")
        digest, told = news
        now = time.monotonic()
        if isinstance(told, Note):
            worker.log_event(topic, [digest, {**asdict(told), "code": told.code.value}])
        elif now - last[0] > PACE:
            last[0] = now
            worker.log_event(topic, [digest, told])

    return tell


def write(path: str, data: bytes) -> str:
    """Write a file of a store on a worker; returns why it cannot."""
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        Store.write(Path(path), data)
    except (OSError, StoreError) as error:
        return str(error)
    return ""


# ---- here


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
