"""The cache folder: kernels of one file in one folder, removed when nobody uses it, and nobody else's is trusted."""

import fcntl
import os
import stat
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from mpm_verify.solver import cache_folder

OLD, USED = "old-" + 24 * "a", "used-" + 24 * "b"


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    cache_folder.base.cache_clear()
    yield cache_folder.base()
    monkeypatch.undo()
    cache_folder.base.cache_clear()


def unused(folder: Path, days: float) -> None:
    """The folder was marked, or its files were written and read, so many days ago."""
    for path in (*folder.rglob("*"), folder):
        os.utime(path, (time.time() - 86400 * days,) * 2)


def test_what_nobody_uses_is_removed(home: Path) -> None:
    """And nothing that is used, that is no folder of ours by its name, or that is a link."""
    old, used = cache_folder.kernel_folder(OLD), cache_folder.kernel_folder(USED)
    former, running = home / "0123456789abcdef-numba0.61.0", home / "1123456789abcdef-numba0.61.0"
    foreign, link = home / "notes", home / ("link-" + 24 * "c")
    for folder in (former, running, foreign):
        folder.mkdir()
    for folder in (old, used, former, running, foreign):
        (folder / "kernel.nbi").write_text("")
        unused(folder, 40)
    unused(used, 29)
    os.utime(running / "kernel.nbi", (time.time(), time.time() - 86400 * 40))  # written long ago, read today
    link.symlink_to(foreign)
    os.utime(link, (0, 0), follow_symlinks=False)
    cache_folder.tidy()
    assert {path.name for path in home.iterdir()} == {used.name, running.name, foreign.name, link.name}
    assert (foreign / "kernel.nbi").exists()


def test_a_folder_in_use_is_marked(home: Path) -> None:
    folder = cache_folder.kernel_folder(USED)
    unused(folder, 40)
    assert cache_folder.kernel_folder(USED) == folder
    assert time.time() - folder.stat().st_mtime < 60
    cache_folder.tidy()
    assert folder.is_dir()


def test_nothing_is_removed_while_another_process_marks_a_folder(home: Path) -> None:
    folder = cache_folder.kernel_folder(OLD)
    unused(folder, 40)
    with cache_folder._locked(fcntl.LOCK_SH):
        cache_folder.tidy()
        assert folder.is_dir()
    cache_folder.tidy()
    assert not folder.exists()


@pytest.fixture
def spare(home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The temporary folder that serves where a file stands in the place of the cache."""
    (tmp_path / "file").write_text("")
    (tmp_path / "spare").mkdir()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr(cache_folder.tempfile, "tempdir", str(tmp_path / "spare"))
    cache_folder.base.cache_clear()
    return tmp_path / "spare" / f"mpm-verify-{os.getuid()}"


def test_a_home_that_cannot_be_written(spare: Path) -> None:
    """A folder of our own in its place, that nobody else looks into; found again by the next process."""
    assert cache_folder.base() == spare
    assert stat.S_IMODE(spare.stat().st_mode) == 0o700
    cache_folder.base.cache_clear()
    assert cache_folder.base() == spare


@pytest.mark.parametrize("fault", ["mode", "owner", "link", "file"])
def test_a_guessed_folder_is_not_trusted(spare: Path, monkeypatch: pytest.MonkeyPatch, fault: str) -> None:
    if fault == "link":
        (spare.parent / "elsewhere").mkdir(mode=0o700)
        spare.symlink_to(spare.parent / "elsewhere")
    elif fault == "file":
        spare.write_text("")
    elif fault == "mode":
        spare.mkdir()
        spare.chmod(0o770)
    else:
        owner = os.getuid() + 1
        monkeypatch.setattr(cache_folder.os, "getuid", lambda: owner)
        spare = spare.with_name(f"mpm-verify-{owner}")
        spare.mkdir(mode=0o700)
    folder = cache_folder.base()
    assert folder.parent == spare.parent
    assert folder not in (spare, spare.parent / "elsewhere")
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    monkeypatch.undo()


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o722])
def test_a_folder_that_others_can_write_to_is_not_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mode: int
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (tmp_path / "mpm-verify").mkdir()
    (tmp_path / "mpm-verify").chmod(mode)
    cache_folder.base.cache_clear()
    try:
        assert cache_folder.base() != tmp_path / "mpm-verify"
    finally:
        monkeypatch.undo()
        cache_folder.base.cache_clear()
