"""A Dask cluster does the runs: the same bits, a worker that dies, and what is refused in one line."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import fixtures_study as fixtures
import pytest
from fixtures_command import Call, caller, one_line

import mpm_verify as mv
from mpm_verify.cases.harness import cluster, worker
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.checkpoint import Note, NoteCode
from mpm_verify.cases.harness.cluster import Cluster, Through, connected
from mpm_verify.cases.harness.runner import InProcess, RunnerError, Ticker, pending, run_study
from mpm_verify.cases.harness.scheduler import scheduler
from mpm_verify.cases.harness.store import Disk, Store, StoreError
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.harness.worker import differs, facts, teller
from mpm_verify.reports.sentences import failures

distributed = pytest.importorskip("distributed", reason="make installs it with requirements.lock")
pytestmark = [pytest.mark.filterwarnings("ignore")]  # of distributed's own sockets and loops
SAME: dict[str, Any] = {"wall_s": 0.0, "cpu_s": 0.0, "peak_memory_mb": 0.0, "environment": {}}
HERE = {"sources": "a", "python": "3.11.7", "numpy": "2.2", "scipy": "1.15", "numba": "0.61", "processor": "X"}
OWN = '''"""A run that ends its process, and others that do not."""

import os
from dataclasses import dataclass

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis


@dataclass(frozen=True)
class Run(RunRecord):
    number: int = axis(1, "Number of the run.")


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    run: Run


def title(runs):
    return "Runs"


def execute(run, tick):
    if run.number == 2:
        os.kill(os.getpid(), 9)
    return Result(run=run, digest=run.digest, status="finished", values={"number": run.number}), {}
'''


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def small() -> Study:
    return fixtures.built(method=("cpdi", "mpm"), cells=(4, 8), ppc=(1,))


def column(**changes: Any) -> Study:
    values = {"cells": [4], "ppc": [4], "duration": [0.1]} | changes
    return build(Asked("column", values), "verify column", "t")


def opened(folder: Path, study: Study, disk: Disk | None = None) -> Store:
    store = Store(folder, study.case, disk)
    store.create(study)
    return store


def by_cluster(
    away: Cluster, study: Study, folder: Path, every: float = 600.0
) -> tuple[Store, dict[str, Any], list[Any]]:
    """Store, Results and news of a study that the cluster has done."""
    store, news = opened(folder, study, away.disk), []
    done = run_study(study, store, away.executor, 1, poll=lambda: news.extend(away.heard()), every=every, hands=away)
    return store, done, news + away.heard()


def check_same(study: Study, store: Store, folder: Path) -> None:
    """What is stored has the bits of this process."""
    here = opened(folder, study)
    for digest, result in run_study(study, here, InProcess(), 1).items():
        assert replace(store.get(digest), **SAME, values={}) == replace(result, **SAME, values={})
        assert repr(store.get(digest).values) == repr(result.values)
        mine, theirs = here.arrays(digest), store.arrays(digest)
        assert {name: array.tobytes() for name, array in mine.items()} == {
            name: array.tobytes() for name, array in theirs.items()
        }


# ---- in this process


@pytest.fixture
def away(monkeypatch: pytest.MonkeyPatch) -> Iterator[Cluster]:
    """Cluster of one worker in this process."""
    monkeypatch.setattr(Ticker, "PAUSE", 0.0)
    monkeypatch.setattr(worker, "PACE", 0.0)
    local = distributed.LocalCluster(1, threads_per_worker=1, processes=False, dashboard_address=None)
    with local, connected(local.scheduler_address) as found:
        yield found


def test_a_study_by_a_cluster_has_the_same_bits(tmp_path: Path, away: Cluster) -> None:
    study = small()
    assert away.check() == 1
    store, done, news = by_cluster(away, study, tmp_path / "away")
    assert done.keys() == {run.digest for run in study.runs}
    assert {digest for digest, _ in news} <= done.keys()
    fractions = [told for _, told in news]
    assert fractions
    assert 0 < min(fractions) < max(fractions) <= 1
    assert pending(study, store) == []
    check_same(study, store, tmp_path / "here")


def test_a_worker_with_other_sources_is_not_given_a_run(tmp_path: Path, away: Cluster) -> None:
    """One that joins after the others were asked."""
    away.facts = {**away.facts, "sources": "another"}
    study = small()
    with pytest.raises(RunnerError, match=r"^the worker inproc.* has other sources of mpm_verify than this machine"):
        by_cluster(away, study, tmp_path)
    assert not list((tmp_path / "runs").glob("*.json"))


def test_a_result_of_another_processor_is_not_stored(tmp_path: Path, away: Cluster) -> None:
    away.check_processor("another")
    with pytest.raises(RunnerError, match=r"^workers have the processors another and .*, which give other bits"):
        by_cluster(away, small(), tmp_path)
    assert not list((tmp_path / "runs").glob("*.json"))


# ---- what is refused


@pytest.mark.parametrize("name", [name for name in HERE if name != "processor"])
def test_what_differs_is_told_in_one_line(name: str) -> None:
    assert differs("tcp://a", HERE, HERE) == ""
    line = differs("tcp://a", {**HERE, name: "another"}, HERE)
    assert line.startswith("the worker tcp://a has ")
    assert line.endswith("; install the same there")
    assert "\n" not in line


@pytest.mark.parametrize(
    ("there", "says"),
    [
        ({"a": {"threads": "4"}}, "the worker a has 4 threads .* --nthreads 1"),
        ({"a": {"numba": "0.1"}}, "the worker a has Numba 0.1, and this machine"),
        ({"a": {}, "b": {"processor": "another"}}, "workers have the processors .* and another"),
        ({"a": ImportError("No module named 'mpm_verify'")}, "cannot be asked for its sources: No module .*; install"),
    ],
)
def test_workers_that_are_refused(there: dict[str, Any], says: str) -> None:
    here = {**facts(), "threads": "1"}
    found = {name: one if isinstance(one, Exception) else {**here, **one} for name, one in there.items()}
    with pytest.raises(ValueError, match=says) as told:
        Cluster(client_of(found)).check()
    assert "\n" not in str(told.value)
    assert Cluster(client_of({"a": here, "b": here})).check() == 2


def client_of(found: dict[str, Any]) -> Any:
    """Client whose workers answer so."""
    return SimpleNamespace(
        run=lambda *given, **named: found, get_executor=lambda pure: None, subscribe_topic=lambda *given: None,
        nthreads=lambda: found,
    )  # fmt: skip


def port() -> int:
    """Port where nobody listens."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


@pytest.mark.parametrize("given", ["tcp://127.0.0.1:{}", "127.0.0.1:{}", "127.0.0.1", "nowhere.json", "broken.json"])
def test_an_address_that_cannot_be_reached(given: str, verify: Call, tmp_path: Path) -> None:
    (tmp_path / "broken.json").write_text("{}")
    begun = time.monotonic()
    said = one_line(verify("mms", "--quick", "--dask", given.format(port()), "--out", "study"))
    assert "scheduler" in said
    assert time.monotonic() - begun < 30  # 5 s are waited, on a machine with nothing else to do
    assert not (tmp_path / "study").exists()


def test_somebody_else_who_listens_is_no_scheduler(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        address = f"tcp://127.0.0.1:{other.getsockname()[1]}"

        def answer() -> None:
            with other.accept()[0] as first:  # the one who asks whether anybody listens
                first.close()
            with other.accept()[0] as second:
                second.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n" * 9)

        threading.Thread(target=answer, daemon=True).start()
        with pytest.raises(ValueError, match=f"no Dask scheduler answers at {address}"), connected(address):
            pass


def test_a_scheduler_file_gives_the_address(tmp_path: Path) -> None:
    (tmp_path / "file").write_text('{"address": "tcp://10.0.0.1:8786"}')
    assert scheduler(str(tmp_path / "file")) == "tcp://10.0.0.1:8786"
    assert scheduler("10.0.0.1:8786") == "tcp://10.0.0.1:8786"


def test_what_does_not_go_with_a_cluster(verify: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        address = f"127.0.0.1:{other.getsockname()[1]}"
        assert "--jobs is for this machine" in one_line(verify("mms", "--quick", "--dask", address, "--jobs", "2"))
        monkeypatch.setattr(cluster, "find_spec", lambda name: None)
        assert "needs the package distributed" in one_line(verify("mms", "--quick", "--dask", address))
    with pytest.raises(ValueError, match="leave dask out"):
        mv.study("mms", solver=print, dask=address)


# ---- what comes back


def ended(error: BaseException) -> "Future[Any]":
    future: Future[Any] = Future()
    future.set_exception(error)
    return future


def test_a_run_whose_workers_die_is_a_failed_result_and_done_again(tmp_path: Path) -> None:
    study, hands = small(), Cluster(client_of({}))
    store, run = opened(tmp_path, study), study.runs[0]
    checkpoint = store.runs / f"{run.digest}.checkpoint"
    checkpoint.touch()
    result = hands.take(run, store, ended(distributed.KilledWorker("key", SimpleNamespace(address="a"), 3)))
    assert (result.status, result == store.get(run.digest)) == ("failed", True)
    assert failures.failure(result.failure) == "4 workers died in it, for want of memory perhaps"
    assert run in pending(study, store)
    assert checkpoint.exists()  # from which it goes on


def test_a_scheduler_that_is_gone_is_one_line(tmp_path: Path) -> None:
    study, hands = small(), Cluster(client_of({}))
    future: Future[Any] = Future()
    future.cancel()
    with pytest.raises(RunnerError, match="does not answer any more; stored runs are kept"):
        hands.take(study.runs[0], opened(tmp_path, study), future)


def test_notes_come_back_as_they_were() -> None:
    hands, note = Cluster(client_of({})), Note(NoteCode.GOES_ON, "a.checkpoint", "", {"step": 7.0})
    sent: list[Any] = []
    dask_worker = SimpleNamespace(
        get_current_task=lambda: "key", state=SimpleNamespace(tasks={"key": SimpleNamespace(state="executing")}),
        log_event=lambda topic, message: sent.append(message),
    )  # fmt: skip
    teller(dask_worker, "topic")(("digest", note))
    assert type(sent[0][1]["code"]) is str  # msgpack takes no other
    hands.hear((0.0, sent[0]))
    assert hands.heard() == [("digest", note)]
    assert hands.heard() == []
    dask_worker.state.tasks.clear()
    with pytest.raises(RunnerError, match="stopped"):
        teller(dask_worker, "topic")(("digest", 0.5))


def test_a_worker_writes_what_this_machine_cannot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first worker cannot either, the second says so and nobody sees it, the third can."""
    monkeypatch.setattr(cluster, "SEEN", 0.3)
    asked: list[str] = []

    def run(function: Any, path: str, data: bytes, workers: list[str], on_error: str) -> dict[str, str]:
        (worker,) = workers
        asked.append(worker)
        if worker == "c":
            Path(path).parent.mkdir(parents=True, exist_ok=True)
            Path(path).write_bytes(data)
        return {worker: "cannot write" if worker == "a" else ""}

    def cannot(*given: Any) -> None:
        raise StoreError("cannot write here")

    client = client_of({"a": {}, "b": {}, "c": {}})
    client.run = run
    monkeypatch.setattr(Disk, "make", cannot)
    monkeypatch.setattr(Disk, "write", cannot)
    study = small()
    store = opened(tmp_path / "study", study, Through(Cluster(client)))
    store.put(fixtures._result(replace(study.runs[0], cells=8)), {})
    assert asked == ["a", "b", "c"] * 4  # the folder, the study, arrays, the Result
    assert store.study() == study
    client.run = lambda *given, **named: {"a": "no", "b": "no", "c": "no"}
    with pytest.raises(StoreError, match="cannot write here"):
        store.create(study)


def test_a_folder_that_cannot_be_locked_is_worked_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """NFS knows no lock of a folder."""

    def cannot(*given: Any) -> None:
        raise OSError(9, "Bad file descriptor")

    monkeypatch.setattr("fcntl.flock", cannot)
    with Store(tmp_path).locked():
        pass


# ---- workers in processes of their own


@pytest.fixture(scope="module")
def local() -> Iterator[Any]:
    """Cluster of two processes, in which a run is given up after it has killed two workers."""
    import dask

    once, two = {"distributed.scheduler.allowed-failures": 1}, {"threads_per_worker": 1, "dashboard_address": None}
    with dask.config.set(once), distributed.LocalCluster(2, **two) as found:
        yield found


def workers(client: Any) -> dict[str, int]:
    """Process of each worker."""
    return dict(client.run(os.getpid))


@pytest.mark.slow
def test_a_run_whose_worker_is_killed_goes_on_elsewhere(local: Any, tmp_path: Path) -> None:
    """The second worker begins at the checkpoint of the first, and has the bits of a run that nobody killed."""
    study = column(duration=[0.03])
    (run,) = study.runs
    with connected(local.scheduler_address) as away:
        away.check()
        processes = workers(away.client)

        def kill() -> None:
            while not list((tmp_path / "away").glob("runs/*.checkpoint")):
                time.sleep(0.05)
            (busy,) = (worker for worker, keys in away.client.processing().items() if keys)
            os.kill(processes[busy], signal.SIGKILL)

        killer = threading.Thread(target=kill, daemon=True)
        killer.start()
        store, done, news = by_cluster(away, study, tmp_path / "away", every=0.0)
        killer.join(1)
    assert done[run.digest].status == "finished"
    assert [told.code for _, told in news if isinstance(told, Note)] == [NoteCode.GOES_ON]
    assert not list(store.runs.glob("*checkpoint*"))
    check_same(study, store, tmp_path / "here")


@pytest.mark.slow
def test_a_run_that_kills_its_workers_does_not_end_the_study(local: Any, tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text(OWN)
    study = build(Asked(str(tmp_path / "own.py"), {"number": [1, 2, 3]}), "verify own.py", "t")
    with connected(local.scheduler_address) as away:
        store, done, _ = by_cluster(away, study, tmp_path / "study")
        found = {result.run.number: result for result in done.values()}
        assert found[2].failure.kind == "worker_died"
        assert found[2].failure.numbers == {"times": 2.0}
        assert {number: found[number].values["number"] for number in (1, 3) if found[number].status == "finished"}
        assert 2 in {run.number for run in pending(study, store)}
        (tmp_path / "own.py").rename(tmp_path / "gone.py")


@pytest.mark.slow
def test_ctrl_c_stops_the_workers_too(local: Any, tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "mpm_verify",
        "column",
        "--cells",
        "14",
        "--ppc",
        "9",
        "--out",
        str(tmp_path / "s"),
    ]
    with connected(local.scheduler_address) as away:
        process = subprocess.Popen([*command, "--dask", local.scheduler_address], stderr=subprocess.PIPE, text=True)

        def busy() -> bool:
            return any(away.client.processing().values())

        wait_for(busy)
        time.sleep(2)  # the worker is in the run
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=60)[1]
        assert (process.returncode, said.count("\n")) == (130, 1)
        assert "the same command goes on from there" in said
        wait_for(lambda: not busy())
        wait_for(lambda: not any(away.client.run(lambda dask_worker: dask_worker.state.executing_count).values()))


def wait_for(what: Any) -> None:
    until = time.monotonic() + 60
    while not what():
        assert time.monotonic() < until
        time.sleep(0.1)


@pytest.mark.slow
def test_from_python_and_by_the_command(local: Any, tmp_path: Path, verify: Call) -> None:
    done = mv.study("column", cells=4, ppc=4, duration=0.004, dask=local.scheduler_address, out=tmp_path / "study")
    assert len(done.record.results) == 1
    (tmp_path / "scheduler.json").write_text(f'{{"address": "{local.scheduler_address}"}}')
    words = ("column", "--cells", "4", "--ppc", "4", "--duration", "0.004", "--json", "--out", "study")
    code, _, err = verify(*words, "--dask", "scheduler.json")
    assert (code in (0, 1, 3), err) == (True, "")
    assert "--dask" not in Store(tmp_path / "study", "column").study().command
