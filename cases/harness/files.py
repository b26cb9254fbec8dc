"""File that is written whole or not at all: a reader sees the old one or the new one, whenever the power goes."""

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO


@contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """Open a file beside `path` that takes its name once it is on the disk. Raises OSError, and leaves the old one."""
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}")  # two machines may write the same file
    try:
        with temporary.open("wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
