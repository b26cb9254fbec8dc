"""Check of exported sources: compiled and run in a temporary folder, and held against values at 30 digits."""

import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from mpm_verify.mms.components import COMPONENTS
from mpm_verify.mms.export.expected import Table
from mpm_verify.mms.export.language import filled
from mpm_verify.mms.export.languages import LANGUAGES
from mpm_verify.mms.export.process import Ended, run
from mpm_verify.solver.state import Floats

COMPILES, RUNS = 120.0, 60.0  # seconds
ROWS = "rows.txt"


@dataclass(frozen=True)
class Toolchain:
    """Way to run the sources of a language.

    Parameters
    ----------
    driver
        Template of the program that calls them, and its file.
    programs
        Compilers or interpreters, the first that is there is taken; empty for the Python that runs this.
    compiles
        Arguments of the compiler; empty where nothing is compiled.
    runs
        Arguments of the interpreter, or the program that was compiled.
    """

    driver: str
    programs: tuple[str, ...]
    compiles: tuple[str, ...] = ()
    runs: tuple[str, ...] = ("./driver",)
    file: str = ""

    def program(self) -> str | None:
        """Path of the compiler or interpreter; None where there is none."""
        if not self.programs:
            return sys.executable
        return next(filter(None, map(shutil.which, self.programs)), None)


CPP = ("-std=c++11", "-O1", "-o", "driver", "driver.cpp")
TOOLCHAINS = {
    "c": Toolchain("driver.c", ("cc", "gcc", "clang"), ("-std=c99", "-O1", "-o", "driver", "driver.c", "-lm")),
    "cpp": Toolchain("driver.cpp", ("c++", "g++", "clang++"), CPP),
    "cuda": Toolchain("driver.cpp", ("c++", "g++", "clang++"), CPP),
    "fortran": Toolchain(
        "driver.f90", ("gfortran", "flang", "ifx"), ("-O1", "-o", "driver", "body_force.f90", "driver.f90")
    ),
    "python": Toolchain("driver.py", (), runs=("driver.py",)),
    "julia": Toolchain("driver.jl", ("julia",), runs=("--startup-file=no", "driver.jl")),
    "octave": Toolchain("driver.m", ("octave-cli", "octave"), runs=("--quiet", "--no-init-file", "driver.m")),
}


class Outcome(StrEnum):
    """End of the check of a language."""

    AGREES = "agrees"
    DISAGREES = "disagrees"
    NO_COMPILER = "no_compiler"
    NOT_COMPILED = "not_compiled"
    NOT_RUN = "not_run"  # it ended with another exit code than 0, or its time was up
    NOT_READ = "not_read"  # what it printed is no table of numbers


@dataclass(frozen=True)
class Checked:
    """Outcome of a language.

    Parameters
    ----------
    language, outcome
        What was checked, and how that ended.
    program
        Compiler or interpreter.
    worst
        Largest error over its tolerance.
    column
        Function and component where that is.
    failed, rows
        Rows where an error is above its tolerance, and all of them.
    ended
        How the compiler or the program ended, where that was not well.
    """

    language: str
    outcome: Outcome
    program: str = ""
    worst: float = 0.0
    column: str = ""
    failed: int = 0
    rows: int = 0
    ended: Ended | None = None


def there(folder: Path) -> list[str]:
    """Languages that can be checked and whose sources are in a folder."""
    return [name for name in TOOLCHAINS if (folder / LANGUAGES[name].file).exists()]


def check(folder: Path, language: str, dimension: int, known: Table) -> Checked:
    """Compile and run the sources of one language, and compare what they give.

    Parameters
    ----------
    folder
        Case folder that has them.
    language
        A key of TOOLCHAINS.
    dimension
        Number of coordinates.
    known
        Rows and right values.

    Returns
    -------
    Checked
        Outcome, with the largest error over its tolerance.
    """
    tools = TOOLCHAINS[language]
    program = tools.program()
    if program is None:
        return Checked(language, Outcome.NO_COMPILER, tools.programs[0])
    with TemporaryDirectory(prefix="mpm-verify-") as temporary:
        scratch = Path(temporary)
        prepare(folder, scratch, language, dimension, known)
        if tools.compiles:
            ended = run([program, *tools.compiles], scratch, COMPILES, into="compiler.txt")
            if not ended.well:
                return Checked(language, Outcome.NOT_COMPILED, program, ended=ended)
        words = list(tools.runs) if tools.compiles else [program, *tools.runs]
        ended = run(words, scratch, RUNS, given=ROWS)
        if not ended.well:
            return Checked(language, Outcome.NOT_RUN, program, ended=ended)
        printed = (scratch / "out.txt").read_text(encoding="utf-8", errors="replace")
    return compared(language, program, printed, known)


def prepare(folder: Path, scratch: Path, language: str, dimension: int, known: Table) -> None:
    """Copy the sources, and write the driver and its rows."""
    source, name = folder / LANGUAGES[language].file, LANGUAGES[language].file
    if source.is_dir():
        shutil.copytree(source, scratch / name)
    else:
        shutil.copy(source, scratch / name)
    driver = TOOLCHAINS[language].driver
    prefix = "mms::" if language == "cpp" else "mms_"
    text = filled(f"drivers/{driver}", dimension=dimension, stress=len(COMPONENTS[dimension]), header=name,
                  gradient=sum(one[0] == "F" for one in known.names), prefix=prefix)  # fmt: skip
    (scratch / driver).write_text(text, encoding="utf-8")
    rows = (" ".join(f"{value:.17g}" for value in row) for row in known.given)
    (scratch / ROWS).write_text("\n".join(rows) + "\n", encoding="utf-8")


def compared(language: str, program: str, printed: str, known: Table) -> Checked:
    """Outcome of what a driver printed."""
    try:
        found = np.array([[float(word) for word in line.split()] for line in printed.splitlines()])
    except ValueError:
        found = np.empty(0)
    if found.shape != known.values.shape:
        return Checked(language, Outcome.NOT_READ, program)
    ratio = over(np.abs(found - known.values), known.tolerance)
    row, column = np.unravel_index(int(ratio.argmax()), ratio.shape)
    failed = int((ratio > 1).any(axis=1).sum())
    outcome = Outcome.DISAGREES if failed else Outcome.AGREES
    return Checked(language, outcome, program, float(ratio[row, column]), known.names[column], failed, len(ratio))


def over(error: Floats, tolerance: Floats) -> Floats:
    """Errors over tolerances: zero for no error, infinite for one that is not a number or has no tolerance."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio: Floats = np.where(error == 0, 0.0, error / tolerance)
    return np.where(np.isnan(ratio), np.inf, ratio)


def exit_code(checks: Sequence[Checked]) -> int:
    """0 where all that could be checked agree, 1 where one does not, 3 where nothing could be checked."""
    done = [one for one in checks if one.outcome is not Outcome.NO_COMPILER]
    if not done:
        return 3
    return 0 if all(one.outcome is Outcome.AGREES for one in done) else 1
