"""A program of somebody else, run in a folder: no shell, a process group of its own, limits of time and of output."""

import os
import resource
import signal
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

MOST_BYTES = 100 * 2**20  # in one file that it writes
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


def run(words: Sequence[str], folder: Path, seconds: float, given: str = "", into: str = "out.txt") -> Ended:
    """Run a program to its end, and end all that it has started.

    Parameters
    ----------
    words
        Program and arguments.
    folder
        Working directory; the output is written to the file `into` in it.
    seconds
        Time that it may take.
    given
        Name of the file in the folder that it reads as its input; nothing is given to it without one.

    Returns
    -------
    Ended
        Its exit code, and the last lines of its error output.
    """
    errors = folder / f"{into}.err"
    source = folder / given if given else Path(os.devnull)
    with source.open("rb") as reads, (folder / into).open("wb") as writes, errors.open("wb") as complains:
        try:
            process = subprocess.Popen(
                list(words), cwd=folder, stdin=reads, stdout=writes, stderr=complains, start_new_session=True,
                preexec_fn=limited,
            )  # fmt: skip
        except OSError as error:
            return Ended(127, f"{words[0]}: {error.strerror}")
        code: int | None = None
        try:
            code = process.wait(timeout=seconds)
        except subprocess.TimeoutExpired:
            pass
        finally:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    return Ended(code, errors.read_bytes()[-LAST:].decode(errors="replace").strip())


def limited() -> None:
    """Limit what a process writes to one file."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_BYTES, MOST_BYTES))
