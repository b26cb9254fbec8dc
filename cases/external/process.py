"""Somebody else's program as a process: no shell, a process group of its own, limits of time and memory, a log."""

import hashlib
import os
import resource
import shlex
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

FOLDERS = ("{case}", "{out}")
GRACE = 2.0  # seconds between the request to end and the end
PAUSE = 0.02  # seconds between two looks
LINES, WIDTH = 5, 300  # of the log that a Result keeps


@dataclass(frozen=True)
class Ended:
    """End of a process: its exit code, negative the number of a signal; None where the time limit ended it."""

    code: int | None
    seconds: float
    last_lines: tuple[str, ...]


def parts(command: str) -> list[str]:
    """Words of a command, as a shell would split them. Raises ValueError with what to write instead."""
    try:
        words = shlex.split(command)
    except ValueError as error:
        raise ValueError(f"--solver {command!r} cannot be split into words: {str(error).lower()}") from None
    if not words:
        raise ValueError("--solver is empty; give a command such as './mycode {case} {out}'")
    missing = [folder for folder in FOLDERS if not any(folder in word for word in words)]
    if missing:
        raise ValueError(f"--solver {command!r} has no {' and no '.join(missing)}; write './mycode {{case}} {{out}}'")
    if shutil.which(words[0]) is None:
        raise ValueError(f"--solver {command!r}: there is no program {words[0]!r}; give its path, such as ./mycode")
    return words


def version(command: str) -> str:
    """Hash of the program and of all files among its arguments, 12 hex digits."""
    found = hashlib.sha256()
    for place, word in enumerate(parts(command)):
        file = Path(shutil.which(word) or word) if place == 0 else Path(word)
        found.update(b"\0" + word.encode())
        if file.is_file():
            with suppress(OSError):
                found.update(file.read_bytes())
    return found.hexdigest()[:12]


def filled(command: str, case: Path, out: Path) -> list[str]:
    """Words of a command with the two folders; a path to the program is that of where verify was started."""
    words = [word.replace("{case}", str(case)).replace("{out}", str(out)) for word in parts(command)]
    return [str(Path(shutil.which(words[0]) or words[0]).absolute()), *words[1:]]


def run(
    words: Sequence[str],
    log: Path,
    seconds: float,
    memory: float = 0.0,
    look: Callable[[], None] = lambda: None,
) -> Ended:
    """Run a program to its end.

    Parameters
    ----------
    words
        Program and arguments.
    log
        File that takes what it prints.
    seconds
        Time limit; the whole process group is ended then, and when this process is interrupted.
    memory
        Limit of address space in bytes; 0 for none.
    look
        Called while it runs; what it raises ends the program too.

    Returns
    -------
    Ended
        Exit code, time and the last lines of the log.
    """
    started = time.monotonic()
    with log.open("wb") as file:
        try:
            process = subprocess.Popen(
                words, stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT, start_new_session=True
            )
        except OSError as error:
            file.write(f"{words[0]}: {error.strerror}\n".encode())
            file.flush()
            return Ended(127, time.monotonic() - started, tail(log))
        try:
            if memory:
                with suppress(OSError, ValueError):
                    resource.prlimit(process.pid, resource.RLIMIT_AS, (int(memory), int(memory)))
            while process.poll() is None and time.monotonic() - started < seconds:
                look()
                time.sleep(PAUSE)
            code = process.poll()
        finally:
            end(process)
    return Ended(code, time.monotonic() - started, tail(log))


def end(process: "subprocess.Popen[bytes]") -> None:
    """End the group of a process: ask, wait, kill. What it has left running ends too."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, number)
        with suppress(subprocess.TimeoutExpired):
            process.wait(GRACE)
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(process.pid, signal.SIGKILL)
            return


def tail(log: Path) -> tuple[str, ...]:
    """Last lines of a log that hold something."""
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - LINES * 4 * WIDTH))
        lines = file.read().decode("utf-8", "replace").splitlines()
    return tuple(line.strip()[:WIDTH] for line in lines if line.strip())[-LINES:]
