"""A fork of this process for what may write anywhere in memory, as a kernel with a wrong index does."""

import faulthandler
import os
import pickle
import resource
import select
import signal
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from os import _exit
from typing import Any


class ForkError(Exception):
    """Error of a fork that ended by a signal, or not in time; the message says which."""


def forked(action: Callable[[], Any], seconds: float) -> Any:
    """Copy of what an action returns in a fork of this process.

    The fork says nothing on the terminal. It must use no thread that this process has started, as parallel kernels do.

    Parameters
    ----------
    action
        Function without arguments; what it returns is pickled.
    seconds
        Time that it may take.

    Returns
    -------
    object
        What it returned.

    Raises
    ------
    ForkError
        Where the fork dies, raises, or is not done in time.
    """
    reader, writer = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of Python 3.12, where this process has threads
        child = os.fork()
    if child == 0:
        _answer(action, writer)
    os.close(writer)
    try:
        data = _read(reader, time.monotonic() + seconds)
    finally:
        os.close(reader)
        with suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)  # it has said all, or it hangs
        _, status = os.waitpid(child, 0)
    if data is None:
        raise ForkError(f"it has not ended after {seconds:g} s")
    try:
        return pickle.loads(data)
    except (EOFError, pickle.UnpicklingError):
        number = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
        raise ForkError(f"it ended by {signal.Signals(number).name}" if number else "it ended") from None


def _answer(action: Callable[[], Any], writer: int) -> None:
    """Do the action in the fork, write what it gives, and leave without a word."""
    try:
        faulthandler.disable()
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        silent = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silent, 1)
        os.dup2(silent, 2)
        data = pickle.dumps(action())
        with open(writer, "wb") as file:
            file.write(data)
    finally:
        _exit(0)


def _read(reader: int, end: float) -> bytes | None:
    """All that is written until the other side closes; None where that takes too long."""
    parts: list[bytes] = []
    while select.select([reader], [], [], max(0.0, end - time.monotonic()))[0]:
        part = os.read(reader, 1 << 20)
        if not part:
            return b"".join(parts)
        parts.append(part)
    return None
