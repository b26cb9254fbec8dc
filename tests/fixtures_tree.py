"""A copy of the sources that hashes are taken from, to edit."""

import shutil
from pathlib import Path

import pytest

from mpm_verify.cases.harness import identity
from mpm_verify.solver import source_hash
from mpm_verify.solver.source_hash import TOP

FLOORS = ("solver", "mms", "cases", "reports", "verify")


def copied(folder: Path) -> Path:
    """The floors, copied into a package mpm_verify below a folder; the package's path."""
    top = folder / "mpm_verify"
    for floor in FLOORS:
        shutil.copytree(TOP / floor, top / floor, ignore=shutil.ignore_patterns("__pycache__"))
    for file in TOP.glob("*.py"):
        shutil.copy(file, top)
    return top


class Tree:
    """The copy, whose files can be edited; hashes are taken anew after each edit."""

    def __init__(self, top: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.top = top
        monkeypatch.setattr(source_hash, "TOP", top)
        forget()

    def replace(self, file: str, old: str, new: str) -> None:
        """Write `new` for `old`, which must be there."""
        text = (self.top / file).read_text()
        assert old in text, f"{file} no longer holds {old!r}"
        (self.top / file).write_text(text.replace(old, new, 1))
        forget()

    def append(self, file: str, text: str = "EDITED = 1\n") -> None:
        """Write at the end of a file, which is made if it is not there."""
        path = self.top / file
        path.parent.mkdir(exist_ok=True)
        path.write_text((path.read_text() if path.exists() else "") + text)
        forget()


def forget() -> None:
    """As a new process: no hash is remembered."""
    for remembered in (
        source_hash.source_hash,
        source_hash._ours,
        source_hash._shipped,
        identity._shipped,
        identity._digest,
    ):
        remembered.cache_clear()
