"""A program of somebody else, run in a folder: no shell, a process group of its own, limits of time and of output."""

import os
import resource
import signal
import subprocess
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

MOST_BYTES = 100 * 2**20  # in one file that it writes
PAUSE, GRACE = 0.05, 2.0  # seconds between two looks, and between a request to end and the end
LAST = 2000  # characters of what it said that are kept


@dataclass(frozen=True)
class Ended:
    """End of a program: its exit code, negative for a signal, None where its time was up; what it said last."""

    code: int | None
    said: str

    @property
    def well(self) -> bool:
        """Whether it ended with 0."""
        return self.code == 0


def run(
    words: Sequence[str],
    folder: Path,
    seconds: float,
    given: str = "",
    into: str = "out.txt",
    memory: float = 0.0,
    look: Callable[[], None] = lambda: None,
    here: Path | None = None,
) -> Ended:
    """Run a program to its end, and end all that it has started.

    Parameters
    ----------
    words
        Program and arguments.
    folder
        Folder of its output, which is written to the file `into`; its working directory too.
    seconds
        Time that it may take.
    given
        Name of the file in the folder that it reads as its input; nothing is given to it without one.
    into
        Name of the file in the folder that takes its output; that of its errors has the ending .err.
    memory
        Bytes of address space that it may have; 0: any number.
    look
        Called while it runs; what it raises ends the program too.
    here
        Another working directory.

    Returns
    -------
    Ended
        Its exit code, and the last lines of its error output.
    """

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_BYTES, MOST_BYTES))
        if memory:
            resource.setrlimit(resource.RLIMIT_AS, (int(memory), int(memory)))

    errors = folder / f"{into}.err"
    source = folder / given if given else Path(os.devnull)
    with source.open("rb") as reads, (folder / into).open("wb") as writes, errors.open("wb") as complains:
        try:
            process = subprocess.Popen(
                list(words), cwd=here or folder, stdin=reads, stdout=writes, stderr=complains, start_new_session=True,
                preexec_fn=limited,
            )  # fmt: skip
        except OSError as error:
            said = f"{words[0]}: {error.strerror}"
            complains.write(said.encode())
            return Ended(127, said)
        code: int | None = None
        until = time.monotonic() + seconds
        try:
            while code is None and time.monotonic() < until:
                look()
                with suppress(subprocess.TimeoutExpired):
                    code = process.wait(timeout=min(PAUSE, max(0.0, until - time.monotonic())))
        finally:
            end(process)
    return Ended(code, errors.read_bytes()[-LAST:].decode(errors="replace").strip())


def end(process: "subprocess.Popen[bytes]") -> None:
    """End a process group, first asked and then killed, if it has not ended."""
    if process.poll() is None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGTERM)
        with suppress(subprocess.TimeoutExpired):
            process.wait(GRACE)
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
