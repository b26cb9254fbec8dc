"""Printing to somebody who may have gone: `verify list | head -1` is no error."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import typer


@contextmanager
def printing() -> Iterator[None]:
    """Whatever is printed inside goes nowhere once nobody reads it; a full disk is one line.

    An error that names a file is none of standard output, and is left as it is.
    """
    try:
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
