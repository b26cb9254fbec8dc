"""A study that is killed goes on where it stopped, and one that is done is not done again. All in real processes."""

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from mpm_verify.cases.harness.store import Store

VERIFY = [sys.executable, "-m", "mpm_verify.verify.main", "mms"]
POOL = "from mpm_verify.verify import main, run; run.SMALL = 0; main.main()"
WITH_WORKERS = [sys.executable, "-c", POOL]  # so little work would be done without worker processes
EIGHT = """
[run]
cells = 7
[sweep]
ppc = [4, 9]
damping = [0.0, 0.02, 0.05, 0.1]
"""
PROC = Path("/proc")
pytestmark = pytest.mark.skipif(not (PROC / "self" / "stat").exists(), reason="reads /proc to see what still runs")


class Sweep:
    """A study on two worker processes, in a folder; counts of Results are as on disk."""

    def __init__(self, folder: Path, words: list[str], case: str = "mms") -> None:
        self.folder, self.runs, self.case = folder / "study", folder / "study" / "runs", case
        self.command = [*WITH_WORKERS, *words, "--jobs", "2", "--out", str(self.folder)]
        self.seen: dict[str, tuple[bytes, int]] = {}

    def start(self) -> subprocess.Popen[str]:
        return subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def results(self) -> dict[str, tuple[bytes, int]]:
        return {file.name: (file.read_bytes(), file.stat().st_mtime_ns) for file in sorted(self.runs.glob("*.json"))}

    def kill(self, delay: float, new: int) -> None:
        """Start, wait for so many new Results and the delay, kill, and see that the workers end too."""
        process = self.start()
        deadline = time.monotonic() + 60
        while len(list(self.runs.glob("*.json"))) < len(self.seen) + new and time.monotonic() < deadline:
            time.sleep(0.01)
        time.sleep(delay)
        workers = set(descendants(process.pid))
        assert process.poll() is None, "ended before it was killed"
        process.send_signal(signal.SIGKILL)
        process.communicate()
        assert len(workers) >= 2 or not new  # killed at its start, it has none yet
        gone_within(workers, 2.0)
        self.still_there()
        self.seen = self.results()

    def still_there(self) -> None:
        """What was finished before was not computed again: its time of computing is in it."""
        found = self.results()
        assert {name: found.get(name) for name in self.seen} == self.seen

    def finish(self) -> None:
        """Run to the end; every Result is there and no run was done twice."""
        process = self.start()
        out, err = process.communicate(timeout=120)
        assert (process.returncode in (0, 1, 3), err) == (True, "")
        assert "report: " in out
        self.still_there()
        store = Store(self.folder, self.case)
        study = store.study()
        assert set(self.results()) == {f"{run.digest}.json" for run in study.runs}
        assert all(store.arrays(run.digest) for run in study.runs)
        assert (self.folder / "report.html").is_file()


def of_mms(folder: Path, ppc: str) -> Sweep:
    """Six levels for each particle count."""
    return Sweep(folder, ["mms", "--cells", "8,16,24,32,40,48", "--ppc", ppc])


def table() -> Iterator[tuple[int, int, str]]:
    """Process, parent and state of everything that runs here."""
    for entry in PROC.iterdir():
        if entry.name.isdigit():
            try:
                state, parent = (entry / "stat").read_text().rpartition(")")[2].split()[:2]
            except OSError:  # ended meanwhile
                continue
            yield int(entry.name), int(parent), state


def descendants(pid: int) -> list[int]:
    children = [child for child, parent, _ in table() if parent == pid]
    return children + [grandchild for child in children for grandchild in descendants(child)]


def gone_within(pids: set[int], seconds: float) -> None:
    """A process that has ended and waits for somebody to ask is Z."""
    deadline = time.monotonic() + seconds
    while left := {pid for pid, _, state in table() if pid in pids and state not in "ZX"}:
        assert time.monotonic() < deadline, f"{len(left)} workers outlive the study"
        time.sleep(0.02)


@pytest.mark.slow
def test_killed_three_times(tmp_path: Path) -> None:
    """While it starts, right after a Result, and in the middle of a run."""
    sweep = of_mms(tmp_path, "4")
    for delay, new in ((0.5, 0), (0.0, 1), (0.2, 1)):
        sweep.kill(delay, new)
    assert sweep.seen
    sweep.finish()


@pytest.mark.slow
def test_killed_ten_times(tmp_path: Path) -> None:
    sweep = of_mms(tmp_path, "1,4,9")
    moments = [(0.2, 0), (0.0, 1), (0.7, 0), (0.05, 1), (1.2, 0), (0.1, 1), (1.7, 0), (0.15, 1), (0.01, 1), (2.2, 0)]
    for delay, new in moments:
        sweep.kill(delay, new)
    assert len(sweep.seen) >= 5
    sweep.finish()


@pytest.mark.slow
def test_eight_columns_killed_four_times(tmp_path: Path) -> None:
    (tmp_path / "eight.toml").write_text(EIGHT)
    sweep = Sweep(tmp_path, ["sweep", str(tmp_path / "eight.toml")], "column")
    for delay, new in ((0.5, 0), (0.0, 1), (0.8, 1), (0.3, 2)):
        sweep.kill(delay, new)
    assert len(sweep.seen) >= 4
    sweep.finish()
    assert len(sweep.results()) == 8


@pytest.mark.slow
def test_same_study_twice(tmp_path: Path) -> None:
    """Nothing is computed the second time, and report, figures and tables are the same bytes."""
    command = [*VERIFY, "--cells", "8,16", "--ppc", "4", "--method", "cpdi", "--method", "mpm", "--out", "study"]

    def run() -> tuple[str, dict[str, bytes], dict[str, int]]:
        done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, timeout=120)
        assert (done.returncode, done.stderr) == (3, "")  # two levels are too few for a verdict
        files = [file for file in tmp_path.rglob("*") if file.is_file()]
        written = {file.name: file.stat().st_mtime_ns for file in files if file.parent.name == "runs"}
        return done.stdout, {str(file): file.read_bytes() for file in files}, written

    out, files, written = run()
    assert len(written) == 2 * (3 + 2)  # Result and arrays; CPDI has a run with half the time step
    assert {Path(name).suffix for name in files} >= {".html", ".svg", ".pdf", ".png", ".csv", ".json", ".npz"}
    again = run()
    assert again[0] == out
    assert [name for name in files if again[1].get(name) != files[name]] == []
    assert again[1].keys() == files.keys()
    assert again[2] == written
