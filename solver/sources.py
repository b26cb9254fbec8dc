"""Hash of source files: names the kernel cache and every Result, so that neither outlives the code it came from."""

import hashlib
from collections.abc import Iterable
from pathlib import Path

TOP = Path(__file__).absolute().parent.parent  # the folder of the installed package; links stay as they are


def digest(files: Iterable[Path]) -> str:
    """SHA-256 over names and contents of `files`, below the folder that holds the packages."""
    total = hashlib.sha256()
    for file in sorted(files):
        total.update(file.relative_to(TOP).as_posix().encode() + b"\0" + file.read_bytes())
    return total.hexdigest()
