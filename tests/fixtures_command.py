"""The command `verify` for tests: called in this process with what it is asked, or in one of its own."""

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from mpm_verify.verify.main import application, files, main

TOP = Path(__file__).resolve().parent.parent
NEEDED = {"sweep": ["figure3"], "material": ["linear_elastic"], "audit": ["bar"], "report": ["study"],
          "example": ["python", "case"],
          "diff": ["study", "other"], "export": ["bump", "--to", "case", "--cells", "4"],
          "check-force": ["study"], "compare": ["--solver", "./study {case} {out}"],
          "judge": [str(TOP / "docs" / "examples" / "errors.csv")]}  # fmt: skip
QUICK = {"methods": ["--quick"], "mms": ["--quick"], "wave_bar": ["--quick"], "benchmark": ["cell_crossing"]}
Spoken = tuple[int, str, str]
Call = Callable[..., Spoken]


def commands() -> dict[str, set[str]]:
    """Options of every command, by its name."""
    import typer

    group = typer.main.get_command(application())  # type: ignore[arg-type]
    found = {name: {word for item in command.params for word in (*item.opts, *item.secondary_opts)}
             for name, command in group.commands.items()}  # type: ignore[attr-defined]  # fmt: skip
    assert found.keys() == files().keys()
    return found


def study_commands() -> list[str]:
    """Names of the commands that run one study."""
    return [name for name, options in commands().items() if {"--dry-run", "--junit"} <= options]


def asked(name: str) -> list[str]:
    """The command with the arguments that it needs, and the quickest of its studies."""
    return [name, *NEEDED.get(name, []), *QUICK.get(name, [])]


def caller(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], folder: Path) -> Call:
    """A function that calls the command in a folder: exit code, standard output, standard error."""
    monkeypatch.chdir(folder)
    monkeypatch.delenv("GITHUB_STEP_SUMMARY", raising=False)

    def call(*arguments: str) -> Spoken:
        monkeypatch.setattr(sys, "argv", ["verify", *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        return int(ended.value.code or 0), *capsys.readouterr()

    return call


def one_line(said: Spoken, code: int = 2) -> str:
    """The one line of a complaint."""
    assert (said[0], said[1]) == (code, ""), said
    assert said[2].startswith("verify: ")
    assert said[2].count("\n") == 1
    assert len(said[2]) < 1000
    return said[2]


@dataclass(frozen=True)
class Process:
    """What a process of its own ended with."""

    code: int
    out: str
    err: str


def process(*arguments: str, folder: Path = TOP) -> Process:
    """The console script, in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-m", "mpm_verify", *arguments], capture_output=True, text=True, cwd=folder, timeout=300,
        env={**os.environ, "PYTHONPATH": str(TOP)},
    )  # fmt: skip
    return Process(done.returncode, done.stdout, done.stderr)
