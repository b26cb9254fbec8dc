"""Checkpoint: the state of a run on disk, written every so many seconds, from which it goes on with the same bits.

DIR/runs/<digest>.checkpoint   an archive of NumPy arrays, without pickles; `head` is the JSON document of HEAD

One that is damaged, of another run, of other sources, or of another processor or other versions, is told and not used.
"""

import json
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from enum import StrEnum
from math import inf
from pathlib import Path
from typing import IO, Any

import numpy as np

from mpm_verify.cases.harness.environment import numerics
from mpm_verify.cases.harness.files import replacing
from mpm_verify.cases.harness.state import Taken, fits, parts, written
from mpm_verify.cases.harness.stopwatch import Stopwatch
from mpm_verify.solver.model import Model

FORMAT = 1
HEAD = ("format", "digest", "numerics", "spent", "state")


class NoteCode(StrEnum):
    """Codes of what a run tells on its way; in brackets `numbers` of the Note."""

    GOES_ON = "goes_on"  # from a checkpoint [step]
    DAMAGED = "damaged"  # a checkpoint that cannot be read
    FOREIGN = "foreign"  # of another run, or of other sources
    ELSEWHERE = "elsewhere"  # by another processor or other versions of what computes
    NOT_WRITTEN = "not_written"  # for want of room, say


@dataclass(frozen=True)
class Note:
    """News of a run besides its progress: a code, the file that it is about, and where that went."""

    code: NoteCode
    file: str
    moved: str = ""
    numbers: dict[str, float] = field(default_factory=dict)


News = tuple[str, float | Note]  # of a run, by its digest: the fraction that is done, or a note


class Unusable(Exception):  # noqa: N818 - a note, and the run begins anew
    """A checkpoint cannot be used; `code` says why."""

    def __init__(self, code: NoteCode) -> None:
        super().__init__(code)
        self.code = code


class Checkpoint:
    """State of a run on disk; without a path nothing is read or written.

    Parameters
    ----------
    path
        File of the run.
    digest
        Name of the run.
    every
        Seconds between two checkpoints.
    tell
        Hears notes.
    """

    def __init__(
        self,
        path: Path | None = None,
        digest: str = "",
        every: float = inf,
        tell: Callable[[Note], None] = lambda note: None,
    ) -> None:
        self.path, self.digest, self.every, self.tell = path, digest, every, tell
        self.before = (0.0, 0.0, 0.0)
        self.stopwatch, self.last = Stopwatch(), time.perf_counter()

    @property
    def spent(self) -> tuple[float, float, float]:
        """Wall and processor time in s since `resume`, and largest memory in MB; with those before a restart."""
        (wall, cpu, peak), (now, used, most) = self.before, self.stopwatch.spent
        return wall + now, cpu + used, max(peak, most)

    def resume(self, model: Model) -> bool:
        """Begin to count time, and write the state on disk to a fresh model and its observers, where there is one.

        Returns
        -------
        bool
            Whether the run goes on from there.
        """
        goes_on = self.found(model)
        self.last = time.perf_counter()
        self.stopwatch.start()
        return goes_on

    def found(self, model: Model) -> bool:
        """Whether there is a state, which is then the model's; a file that cannot be used is moved aside."""
        if self.path is None:
            return False
        for cut in self.path.parent.glob(f".{self.path.name}.*"):  # of a process that was killed while it wrote
            with suppress(OSError):
                cut.unlink(missing_ok=True)
        if not self.path.exists():
            return False
        try:
            with self.path.open("rb") as file:
                self.read(file, model)
        except (Unusable, OSError) as error:
            aside = self.path.with_suffix(".unused")
            with suppress(OSError):
                self.path.replace(aside)
            code = error.code if isinstance(error, Unusable) else NoteCode.DAMAGED
            self.tell(Note(code, self.path.name, aside.name))
            return False
        self.tell(Note(NoteCode.GOES_ON, self.path.name, numbers={"step": model.steps}))
        return True

    def keep(self, model: Model) -> None:
        """Write the state after a step, if it is time; where it cannot be written the run goes on."""
        if self.path is None or time.perf_counter() - self.last < self.every:
            return
        try:
            with replacing(self.path) as file:
                self.write(file, model)
        except OSError:
            self.tell(Note(NoteCode.NOT_WRITTEN, self.path.name))
        self.last = time.perf_counter()

    def remove(self) -> None:
        """Remove the file, as the Result of the run is stored."""
        if self.path is not None:
            with suppress(OSError):
                self.path.unlink(missing_ok=True)

    def write(self, file: IO[bytes], model: Model) -> None:
        """Write the state to a file, array by array."""
        found = Taken(parts(model))
        values = (FORMAT, self.digest, numerics(), self.spent, found.state)
        head = json.dumps(dict(zip(HEAD, values, strict=True))).encode()
        named = {str(k): array for k, array in enumerate(found.arrays)}
        np.savez(file, allow_pickle=False, head=np.frombuffer(head, np.uint8), **named)

    def read(self, file: IO[bytes], model: Model) -> None:
        """Write the state in a file to the model and its observers. Raises Unusable, and writes nothing."""
        try:
            with np.load(file, allow_pickle=False) as stored:
                head = json.loads(stored["head"].tobytes())
                self.check(head)
                arrays = [stored[str(k)] for k in range(len(stored.files) - 1)]
            wall, cpu, peak = head["spent"]
            if not fits(head["state"], parts(model)):
                raise Unusable(NoteCode.DAMAGED)
        except (Unusable, MemoryError):
            raise
        except Exception as error:  # a damaged archive raises anything
            raise Unusable(NoteCode.DAMAGED) from error
        written(head["state"], parts(model), arrays)
        self.before = wall, cpu, peak

    def check(self, head: dict[str, Any]) -> None:
        """Raise Unusable unless it is of this run, by this processor and these versions."""
        if (head["format"], head["digest"]) != (FORMAT, self.digest):
            raise Unusable(NoteCode.FOREIGN)
        if head["numerics"] != numerics():
            raise Unusable(NoteCode.ELSEWHERE)
