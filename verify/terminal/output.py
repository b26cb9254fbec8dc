"""Printing to a reader who may have gone: `verify list | head -1` is not an error."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from typing import Any

import typer

_ours: list[Any] = []  # standard output of the command, where sys.stdout is another


@contextmanager
def aside() -> Iterator[None]:
    """Send to standard error what is printed inside, as by a user's file, but for what is printed by printing()."""
    _ours.append(_ours[-1] if _ours else sys.stdout)
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        _ours.pop()


@contextmanager
def printing() -> Iterator[None]:
    """Discard what is printed inside once nobody reads it; a full disk is one line.

    An error that names a file has nothing to do with standard output, and is left as it is.
    """
    try:
        with redirect_stdout(_ours[-1] if _ours else sys.stdout):
            yield
            if sys.stdout is not None:
                sys.stdout.flush()
    except BrokenPipeError:
        silence()
    except OSError as error:
        if error.filename is not None:
            raise
        silence()
        raise typer.TyperException(f"cannot write to standard output: {error.strerror}") from error


def silence() -> None:
    """Send what is still in the buffer nowhere, or the flush at exit complains once more."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
