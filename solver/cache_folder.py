"""The folder of what can be made again: compiled kernels, and texts that take time to make. Ours alone, and tidied.

It holds folders NAME-HASH, one for each kernel file and each kind of text. A folder is removed when no process has used
it for a month.
"""

import atexit
import fcntl
import hashlib
import os
import re
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

DAY = 86400.0  # seconds
UNUSED = 30 * DAY
OTHERS = stat.S_IWGRP | stat.S_IWOTH  # others may write
KERNELS = re.compile(r"[\w.-]+-[0-9a-f]{24}|removed-\w+")
FORMER = re.compile(r"[0-9a-f]{16}-numba[\w.+]+")  # one folder for all kernels, of versions up to 0.4


@cache
def base() -> Path:
    """Folder below $XDG_CACHE_HOME, or a temporary one; only where nobody else may write."""
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "mpm-verify"
    with suppress(OSError):
        home.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = home.stat()
        if found.st_uid == os.getuid() and not found.st_mode & OTHERS and os.access(home, os.W_OK):
            return home
    spare = Path(tempfile.gettempdir()) / f"mpm-verify-{os.getuid()}"
    with suppress(OSError):
        spare.mkdir(mode=0o700, parents=True, exist_ok=True)
        if private(spare):
            return spare
    fresh = Path(tempfile.mkdtemp(prefix="mpm-verify-"))
    atexit.register(shutil.rmtree, fresh, ignore_errors=True)
    return fresh


def private(folder: Path) -> bool:
    """Whether this is a folder, no link, that we own and nobody else can write to or look into."""
    found = folder.lstat()
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and stat.S_IMODE(found.st_mode) == 0o700


def kernel_folder(name: str) -> Path:
    """The folder of one kernel file, marked as in use today: nobody removes it for a month."""
    folder = base() / name
    try:
        fresh = time.time() - folder.stat().st_mtime < DAY
    except OSError:
        fresh = False
    if not fresh:
        base().mkdir(mode=0o700, parents=True, exist_ok=True)  # it may have been removed since
        with _locked(fcntl.LOCK_SH):
            folder.mkdir(exist_ok=True)
            os.utime(folder)
        tidy()
    return folder


def kept(folder: str, name: str, make: Callable[[], str]) -> str:
    """Text `name` of a folder of the cache, made where it is missing or damaged.

    Its first line is the hash of the rest. Where nothing can be written, on a full disk, it is made each time.
    """
    try:
        file = kernel_folder(folder) / name
    except OSError:
        return make()
    with suppress(OSError, UnicodeDecodeError):
        digest, _, text = file.read_text(encoding="utf-8").partition("\n")
        if digest == hashlib.sha256(text.encode()).hexdigest():
            return text
    text = make()
    with suppress(OSError):
        write(file, f"{hashlib.sha256(text.encode()).hexdigest()}\n{text}")
    return text


def write(file: Path, text: str) -> None:
    """Write a file whole or not at all. Raises OSError."""
    handle, name = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as opened:
            opened.write(text)
        os.replace(name, file)
    except BaseException:
        with suppress(OSError):
            os.unlink(name)
        raise


def tidy() -> None:
    """Remove kernel folders that nobody has used for a month, and those of former versions unused for a day.

    Moved away first, while no process marks a folder as in use: what goes is out of everybody's sight.
    """
    with suppress(OSError), _locked(fcntl.LOCK_EX | fcntl.LOCK_NB):
        for number, folder in enumerate(_unused()):
            away = base() / f"removed-{os.getpid()}_{number}_{time.time_ns()}"
            with suppress(OSError):
                os.replace(folder, away)
                shutil.rmtree(away, ignore_errors=True)


def _unused() -> list[Path]:
    now, found = time.time(), []
    for folder in base().iterdir():
        age = UNUSED if KERNELS.fullmatch(folder.name) else DAY if FORMER.fullmatch(folder.name) else None
        ours = age is not None and not folder.is_symlink() and folder.is_dir() and folder.stat().st_uid == os.getuid()
        if ours and age is not None and now - _last_use(folder) > age:
            found.append(folder)
    return found


def _last_use(folder: Path) -> float:
    """Time at which a folder was marked as in use; of a former version, when a file in it was last read or written."""
    if not FORMER.fullmatch(folder.name):
        return folder.stat().st_mtime
    files = [item.stat() for item in folder.rglob("*") if item.is_file()]  # to list a folder is to read it
    return max([folder.stat().st_mtime, *(max(file.st_mtime, file.st_atime) for file in files)])


@contextmanager
def _locked(how: int) -> Iterator[None]:
    handle = os.open(base(), os.O_RDONLY)
    try:
        fcntl.flock(handle, how)
        yield
    finally:
        os.close(handle)
