"""Checkpoints: a run that is stopped goes on with the same bits; a file that cannot be used is told and not used."""

import json
import os
import signal
import subprocess
import sys
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.column import execute as column
from mpm_verify.cases.column.run import ColumnResult, ColumnRun
from mpm_verify.cases.harness import checkpoint, runner, state
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.checkpoint import Checkpoint, Note, NoteCode
from mpm_verify.cases.harness.state import Taken, fits, written
from mpm_verify.cases.harness.store import Store
from mpm_verify.reports.sentences import checkpoints as words

SAND = ColumnRun(cells=4, ppc=4, duration=0.006, start="k0")
RUNS = {
    "mohr_coulomb": SAND,
    "ubcsand": replace(SAND, material="ubcsand", start="oedometric", duration=0.003, transfer="apic"),
    "rough": replace(SAND, floor="frictional", left="frictional", damping=0.05, gate=1.0, mirror=True),
    "pooled": replace(SAND, pooling=True),
    "smoothed": replace(SAND, smoothing="volumetric", transfer="fmpm", method="bspline2"),
}
SAME: dict[str, Any] = {"wall_s": 0.0, "cpu_s": 0.0, "peak_memory_mb": 0.0}
Outcome = tuple[ColumnResult, dict[str, Any]]


class Stopped(BaseException):
    """As SIGKILL, between two steps."""


def stop_at(fraction: float) -> Callable[[float], None]:
    def tick(done: float) -> None:
        if done >= fraction:
            raise Stopped

    return tick


def stopped(run: ColumnRun, path: Path, fraction: float = 0.5) -> None:
    """Run so far, with a checkpoint in each step."""
    with pytest.raises(Stopped):
        column.execute(run, stop_at(fraction), Checkpoint(path, run.digest, 0.0))


def gone_on(run: ColumnRun, path: Path) -> tuple[Outcome, list[Note]]:
    """Run to the end from what is there, and what it tells."""
    notes: list[Note] = []
    return column.execute(run, lambda done: None, Checkpoint(path, run.digest, 1e9, notes.append)), notes


@cache
def straight(run: ColumnRun) -> Outcome:
    return column.execute(run)


def differ(a: Outcome, b: Outcome) -> set[str]:
    """Names of what is not the same to the last bit."""
    found = {name for name in a[1] if a[1][name].tobytes() != b[1][name].tobytes()} | (a[1].keys() ^ b[1].keys())
    found |= {name for name in a[0].values if repr(a[0].values[name]) != repr(b[0].values[name])}
    rest = [replace(one[0], values={}, **SAME) for one in (a, b)]
    return found | ({"result"} if rest[0] != rest[1] else set())


# ---- the same bits


@pytest.mark.parametrize("name", RUNS)
def test_a_run_that_is_stopped_three_times_has_the_same_bits(name: str, tmp_path: Path) -> None:
    run, path = RUNS[name], tmp_path / "a.checkpoint"
    for fraction in (0.2, 0.21, 0.8):
        stopped(run, path, fraction)
    done, notes = gone_on(run, path)
    assert [note.code for note in notes] == [NoteCode.GOES_ON]
    assert notes[0].numbers["step"] == pytest.approx(0.8 * done[0].steps, abs=2)
    assert differ(straight(run), done) == set()
    assert {"curve_residual", "curve_convection", "snapshot_sigma"} <= done[1].keys()  # budget and fields among them


@pytest.mark.parametrize(
    ("hidden", "seen"), [("history", "snapshot_gamma_p"), ("sums", "curve_residual"), ("rows", "curve_front_99"),
                         ("frames", "frame_x"), ("steps", "curve_t")]
)  # fmt: skip
def test_what_is_left_out_is_seen(hidden: str, seen: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each part of the state counts: without it other numbers come out."""
    path, original = tmp_path / "a.checkpoint", state.attributes
    monkeypatch.setattr(state, "attributes", lambda value: (one for one in original(value) if one[0] != hidden))
    stopped(SAND, path)
    assert seen in differ(straight(SAND), gone_on(SAND, path)[0])


def test_time_and_memory_of_all_pieces_count(tmp_path: Path) -> None:
    path = tmp_path / "a.checkpoint"
    stopped(SAND, path, 0.9)
    with np.load(path) as stored:
        wall, cpu, peak = json.loads(stored["head"].tobytes())["spent"]
    (result, _), _ = gone_on(SAND, path)
    assert result.wall_s > wall > 0
    assert result.cpu_s > cpu > 0
    assert result.peak_memory_mb >= peak > 0


def test_it_is_written_when_it_is_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock of one second a step: every 4 s is each fourth step."""
    clock, sizes = iter(range(10**6)), []
    monkeypatch.setattr(checkpoint.time, "perf_counter", lambda: float(next(clock)))
    monkeypatch.setattr(Checkpoint, "write", lambda self, file, model: sizes.append(model.steps))
    result, _ = column.execute(SAND, lambda done: None, Checkpoint(tmp_path / "a.checkpoint", SAND.digest, 4.0))
    assert 0.7 < 4 * len(sizes) / result.steps <= 1.1
    assert max(np.diff(sizes)) - min(np.diff(sizes)) <= 1


# ---- a file that cannot be used


def damage(path: Path, how: float) -> None:
    """Cut the file to a fraction, or flip a bit in its middle."""
    content = bytearray(path.read_bytes())
    if how < 1:
        path.write_bytes(content[: int(how * len(content))])
        return
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


@pytest.mark.parametrize("how", [0.0, 0.001, 0.5, 0.9999, 1.0])
def test_a_damaged_checkpoint_is_told_and_not_used(how: float, tmp_path: Path) -> None:
    path = tmp_path / "a.checkpoint"
    stopped(SAND, path)
    damage(path, how)
    done, notes = gone_on(SAND, path)
    assert notes == [Note(NoteCode.DAMAGED, "a.checkpoint", "a.unused")]
    assert "a.checkpoint is damaged and not used" in words.note(notes[0])
    assert differ(straight(SAND), done) == set()
    assert (path.exists(), path.with_suffix(".unused").exists()) == (False, True)


def test_a_folder_in_its_way_is_told(tmp_path: Path) -> None:
    path = tmp_path / "a.checkpoint"
    path.mkdir()
    done, notes = gone_on(SAND, path)
    assert notes[0] == Note(NoteCode.DAMAGED, "a.checkpoint", "a.unused")
    assert differ(straight(SAND), done) == set()


def test_a_checkpoint_of_another_run_or_of_other_sources_is_not_used(tmp_path: Path) -> None:
    path, other = tmp_path / "a.checkpoint", replace(SAND, g=9.81)
    stopped(other, path)
    done, notes = gone_on(SAND, path)
    assert [note.code for note in notes] == [NoteCode.FOREIGN]
    assert differ(straight(SAND), done) == set()


def test_a_checkpoint_of_another_processor_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.checkpoint"
    stopped(SAND, path)
    monkeypatch.setattr(checkpoint, "numerics", lambda: {"processor": "another"})
    done, notes = gone_on(SAND, path)
    assert [note.code for note in notes] == [NoteCode.ELSEWHERE]
    assert differ(straight(SAND), done) == set()


def test_every_note_has_its_words() -> None:
    for code in NoteCode:
        line = words.note(Note(code, "a.checkpoint", "a.unused", {"step": 7}))
        assert ("a.checkpoint" in line, "{" in line, "\n" in line) == (True, False, False)


# ---- writing


def test_a_cut_while_writing_leaves_the_one_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.checkpoint"
    stopped(SAND, path, 0.3)
    before = path.read_bytes()

    def cut(*given: object) -> None:
        raise Stopped

    monkeypatch.setattr("os.fsync", cut)
    with pytest.raises(Stopped):
        column.execute(SAND, lambda done: None, Checkpoint(path, SAND.digest, 0.0))
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


def test_a_full_disk_is_told_and_the_run_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*given: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    notes: list[Note] = []
    done = column.execute(
        SAND, lambda done: None, Checkpoint(tmp_path / "a.checkpoint", SAND.digest, 0.0, notes.append)
    )
    assert {note.code for note in notes} == {NoteCode.NOT_WRITTEN}
    assert differ(straight(SAND), done) == set()
    assert list(tmp_path.iterdir()) == []


def test_it_is_removed_once_the_result_is_stored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = build(Asked("column", {"cells": [4], "ppc": [4], "duration": [0.002]}), "verify column", "t")
    store, run = Store(tmp_path, "column"), study.runs[0]
    store.create(study)
    path, there = store.runs / f"{run.digest}.checkpoint", []
    put = Store.put_files
    monkeypatch.setattr(Store, "put_files", lambda self, *given: (there.append(path.exists()), put(self, *given))[1])
    runner.perform(run, run.digest, tmp_path, 1, 0.0)
    assert (there, path.exists()) == ([True], False)
    assert store.get(run.digest).status == "finished"


def test_checkpoints_of_no_run_of_the_study_are_told(tmp_path: Path) -> None:
    study = build(Asked("column", {"cells": [4], "ppc": [4]}), "verify column", "t")
    store = Store(tmp_path, "column")
    store.create(study)
    for name in (study.runs[0].digest, "0123", ".0123.checkpoint.77"):
        (store.runs / f"{name}.checkpoint").touch()
    assert store.abandoned(study) == ["0123.checkpoint"]
    assert words.abandoned(["0123.checkpoint"]).startswith("0123.checkpoint belongs to no run of this study")
    assert words.abandoned([]) == ""


# ---- numbers and arrays of any kind


@dataclass
class Inner:
    a: Any = field(default_factory=lambda: np.zeros(2))
    alias: Any = None


@dataclass
class Outer:
    numbers: Any
    inner: Inner
    strategy: Callable[[], None] = print


def test_values_come_back_to_the_last_bit() -> None:
    numbers = {"x": [-0.0, float("inf"), 0.1, np.float64(1 / 3)], "y": (1, True, None, "text"), "z": np.arange(3.0)}
    outer = Outer(numbers, Inner(np.array([np.nan, -0.0])))
    outer.inner.alias = outer.inner.a
    found = Taken(outer)
    assert len(found.arrays) == 2  # what is met twice is taken once
    text, arrays = json.loads(json.dumps(found.state)), [array.copy() for array in found.arrays]
    fresh = Outer({}, Inner())
    mine = fresh.inner.alias = fresh.inner.a
    assert fits(text, fresh)
    written(text, fresh, arrays)
    assert fresh.inner.a is fresh.inner.alias is mine
    assert mine.tobytes() == outer.inner.a.tobytes()
    assert repr(fresh.numbers) == repr({**numbers, "x": [-0.0, float("inf"), 0.1, 1 / 3]})
    assert fresh.strategy is print


def test_what_does_not_fit_is_not_written() -> None:
    found = Taken({"a": Inner(), "b": [Inner()]}).state
    assert fits(found, {"a": Inner(), "b": [Inner()]})
    assert not fits(found, {"a": 1, "b": [Inner()]})
    assert not fits(found, {"a": Inner(), "b": []})
    with pytest.raises(TypeError, match="keys"):
        Taken({1: 2})
    for unknown in ({1}, deque([1]), bytearray(1), np.random.default_rng(1)):
        with pytest.raises(TypeError, match="no checkpoint holds a"):
            Taken({"a": unknown})


# ---- SIGKILL


def killed(words: list[str], folder: Path, after: float) -> bool:
    """Whether the command was still at work when it was killed, some time after its first checkpoint."""
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 120
    while not any((folder / "runs").glob("*.checkpoint")) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.01)
    time.sleep(after)
    process.send_signal(signal.SIGKILL)
    return process.wait() == -signal.SIGKILL


@pytest.mark.slow
@pytest.mark.parametrize(
    ("threads", "after", "given"),
    [("1", 0.07, {"material": ["mohr_coulomb"], "duration": [0.06]}),
     ("2", 0.31, {"material": ["ubcsand"], "start": ["oedometric"], "duration": [0.03]})],
)  # fmt: skip
def test_killed_in_the_middle(threads: str, after: float, given: dict[str, list[Any]], tmp_path: Path) -> None:
    """While it writes a checkpoint each step; the Result and all arrays are those of a run that nobody killed."""
    values = {"cells": [4], "ppc": [4]} | given
    study = build(Asked("column", values), "verify column", "t")
    axes = [word for name, (value,) in values.items() for word in (f"--{name}", str(value))]
    words = [sys.executable, "-m", "mpm_verify", "column", *axes, "--no-page", "--threads", threads]
    words += ["--out", str(tmp_path), "--checkpoint"]
    assert killed([*words, "0"], tmp_path, after), "it came to its end before it was killed"
    done = subprocess.run([*words, "10"], capture_output=True, text=True, timeout=300)
    assert (done.returncode in (0, 1, 3), "the run goes on from step" in done.stderr) == (True, True), done.stderr
    store, run = Store(tmp_path, "column"), study.runs[0]
    result = store.get(run.digest)
    whole, arrays = straight(run)
    here, there = (
        (replace(one, environment={}), found) for one, found in ((whole, arrays), (result, store.arrays(run.digest)))
    )
    assert differ(here, there) == set()
    assert not [file for file in os.listdir(store.runs) if "checkpoint" in file]
