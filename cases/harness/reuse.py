"""Reuse of a study that a folder holds, where the same code was asked for the same: it need not be derived again."""

import hashlib
import os
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.cases.harness.study import Study

ROOMS = ("solver", "mms", "cases")  # all that builds a study


def study(asked: Asked, command: str, folder: Path) -> Study[Any]:
    """Study that is asked for: the one in the folder, if it is the same, or a new one.

    Raises ValueError with one line for what cannot be run.
    """
    name = named(asked)
    try:
        stored: Study[Any] | None = Store(folder, asked.case).study() if name and folder.is_dir() else None
    except StoreError:
        stored = None  # what is wrong with the folder is said by whoever writes into it
    if stored and stored.made == name:
        return replace(stored, command=command)
    return replace(build(asked, command), made=name)


def named(asked: Asked) -> str:
    """Hash of what is asked for and of the files that build a study of it; empty where something of a user's is asked.

    That may have changed since: a file, or the program of a command.
    """
    if any(item.metadata.get("whole") for item in fields(asked.contract.Run) if item.name in asked.values):
        return ""
    given = [asked.case, *(value for values in asked.values.values() for value in values)]
    if any(isinstance(value, str) and ".py" in value for value in given):  # a material's parameter may be a file too
        return ""
    here = Path(__file__).absolute().parents[2]
    files = []
    for room in ROOMS:
        for folder, _, names in os.walk(here / room):
            files += [os.path.join(folder, name) for name in names if name.endswith(".py")]
    seen = [(path, stat.st_size, stat.st_mtime_ns) for path in sorted(files) for stat in (os.stat(path),)]
    return hashlib.sha256(repr((asked, seen)).encode()).hexdigest()[:16]
