"""One planted copy after the other in a server's children: what each check answers. One workshop a process."""

import fcntl
import json
import os
import shutil
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from mpm_verify.cases.detect.defect import NONE, Defect, defects
from mpm_verify.cases.detect.plant import Planted, copied, examined, home

SERVER = Path(__file__).with_name("server.py")
ENTRY = "mpm_verify.verify.detecting.child"
SECONDS, MEGABYTES = 150, 6000  # processor time and room of a child: what recompiles most takes 30 s and 1500 MB
FIRST = 600  # seconds of the first child, which compiles and runs everything
ALONE = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "GOMP_SPINCOUNT": "20000",
    "MPLBACKEND": "Agg",
    "PYTHONHASHSEED": "0",
}


@dataclass(frozen=True)
class Answer:
    """Answer of one check: its outcome, a code for the first thing that it found, and processor time in s."""

    check: str
    outcome: str
    evidence: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Asked:
    """All that a child answered, and how it ended: "" by itself, crash, hang."""

    answers: tuple[Answer, ...]
    ended: str
    cpu: float


class Workshop:
    """A copy of the package and a server of this process."""

    def __init__(self) -> None:
        for left in home().glob("copy-*"):  # of a process that was killed
            if not Path("/proc", left.name.removeprefix("copy-")).exists():
                shutil.rmtree(left, ignore_errors=True)
        self.folder = home() / f"copy-{os.getpid()}"
        self.copy = copied(self.folder)
        environment = {**os.environ, **ALONE, "XDG_CACHE_HOME": str(home() / "cache")}
        environment.pop("PYTHONPATH", None)
        (home() / "cache").mkdir(mode=0o700, exist_ok=True)
        self.server = subprocess.Popen(
            [sys.executable, str(SERVER)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
            cwd=self.folder,
        )

    def ask(self, one: Defect, method: str, checks: tuple[str, ...], keep: bool = False) -> Asked:
        """Plant a defect and ask the checks. With `keep` the Results go to the folder of those of the sound package."""
        answers, work = self.folder / "answers", self.folder / "work"
        answers.unlink(missing_ok=True)
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir()
        request = {
            "copy": str(self.copy),
            "entry": ENTRY,
            "answers": str(answers),
            "log": str(self.folder / "log"),
            "seconds": FIRST if keep else SECONDS,
            "megabytes": MEGABYTES,
            "method": method,
            "checks": list(checks),
            "keep": keep,
            "sound": str(home() / "sound"),
            "work": str(work),
        }
        with Planted(self.copy, one):
            assert self.server.stdin is not None
            assert self.server.stdout is not None
            self.server.stdin.write(json.dumps(request) + "\n")
            self.server.stdin.flush()
            line = self.server.stdout.readline()
        ended: dict[str, Any] = json.loads(line) if line else {"ended": "crash", "cpu": 0.0}
        return Asked(tuple(self._told(answers)), str(ended["ended"]), float(ended["cpu"]))

    def _told(self, answers: Path) -> list[Answer]:
        """Lines of the child, as far as it came."""
        lines = answers.read_text(encoding="utf-8").splitlines() if answers.is_file() else []
        found = []
        for line in lines:
            with suppress(ValueError, TypeError):
                found.append(Answer(**json.loads(line)))
        return found

    def close(self) -> None:
        """End the server and remove the copy."""
        if self.server.stdin:
            self.server.stdin.close()
        self.server.wait(timeout=10)
        shutil.rmtree(self.folder, ignore_errors=True)


@cache
def workshop() -> Workshop:
    """The workshop of this process."""
    import atexit

    made = Workshop()
    atexit.register(made.close)
    return made


def warmed(method: str, checks: tuple[str, ...]) -> None:
    """Run the checks once without a defect, by one process alone, so that Results and kernels are there for all."""
    done = home() / f"sound-{examined()}-{method}-{len(checks)}"
    if done.exists():
        return
    with done.with_suffix(".lock").open("w") as handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        if not done.exists():
            asked = workshop().ask(defects()[NONE], method, checks, keep=True)
            if asked.ended:
                raise RuntimeError(f"the checks of the sound package end with {asked.ended}: {asked.answers}")
            done.touch()
