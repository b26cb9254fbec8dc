"""Copies of the package that defects are planted in, below a folder of the campaign's own; the original is read."""

import compileall
import hashlib
import os
import shutil
import tempfile
from functools import cache
from pathlib import Path

from mpm_verify.cases.detect.defect import Defect, replaced
from mpm_verify.solver.cache_folder import private
from mpm_verify.solver.source_hash import PACKAGE, TOP, closure, parse

ROOMS = ("solver", "mms", "cases", "reports", "verify")
CHECKS = tuple(f"mpm_verify.verify.detecting.{name}" for name in ("child", "checks", "known", "rule", "stored"))


@cache
def examined() -> str:
    """Digest of what is examined and of the checks, 16 hex digits: of Python files their trees, of others contents.

    The campaign itself counts where it plants and asks: as the import closure of execute.py, which names its runs.
    """
    parts = []
    for file in files():
        content = file.read_bytes()
        parts.append((str(file.relative_to(TOP)), parse(content).digest if file.suffix == ".py" else content.hex()))
    parts += sorted((name, tree) for entry in CHECKS for name, tree in closure(entry).items())
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:16]


def files() -> list[Path]:
    """Files of the numeric floors in their order, without those of the campaign."""
    every = (file for room in ("solver", "mms", "cases") for file in (TOP / room).rglob("*"))
    mine = TOP / "cases" / "detect"
    return sorted(file for file in every if file.is_file() and file.suffix != ".pyc" and mine not in file.parents)


@cache
def home() -> Path:
    """The campaign's own folder below the temporary one: nobody else may write there. Raises OSError where one may.

    Kernels and Results of the sound package in it are named by what they are made from, and serve every version.
    """
    base = Path(tempfile.gettempdir()) / f"mpm-verify-detect-{os.getuid()}"
    base.mkdir(mode=0o700, parents=True, exist_ok=True)
    if not private(base):
        raise PermissionError(1, "another user may write into the folder of the campaign", str(base))
    return base


def copied(to: Path) -> Path:
    """Copy the package into a folder, with the byte code of its files; the folder."""
    target = to / PACKAGE
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir(parents=True)
    for name in ("__init__.py", "__main__.py", "py.typed"):
        shutil.copy2(TOP / name, target / name)
    for room in ROOMS:
        shutil.copytree(TOP / room, target / room, ignore=shutil.ignore_patterns("__pycache__"))
    compileall.compile_dir(target, quiet=2)
    return to


class Planted:
    """A copy with one defect in it, as long as the context lasts.

    The file gets another time of change, as byte code is known by the second and the size of its source alone.
    """

    def __init__(self, copy: Path, one: Defect) -> None:
        self.file, self.one, self.sound = copy / PACKAGE / one.file, one, b""

    def __enter__(self) -> None:
        if not self.one.file:
            return
        self.sound, self.stat = self.file.read_bytes(), self.file.stat()
        self.file.write_bytes(replaced(self.sound.decode(), self.one).encode())
        os.utime(self.file, (self.stat.st_atime, self.stat.st_mtime + 10))

    def __exit__(self, *error: object) -> None:
        if self.sound:
            self.file.write_bytes(self.sound)
            os.utime(self.file, ns=(self.stat.st_atime_ns, self.stat.st_mtime_ns))
