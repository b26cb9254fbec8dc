"""Worker of a Dask cluster: what its numbers hang on, one run, and the files that it writes for another machine."""

import pickle
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from hashlib import sha256
from pathlib import Path
from typing import Any

from mpm_verify.cases.harness.checkpoint import Checkpoint, News, Note
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.environment import numerics
from mpm_verify.cases.harness.runner import Run, RunnerError, Ticker, checkpoint_of, computed
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.solver.plugins import is_file, split
from mpm_verify.solver.source_hash import package_hash

PACE = 1.0  # s between two fractions that a worker tells
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
