"""Command of somebody else's solver: its words, its two folders, and the version of what it names."""

import hashlib
import re
import shlex
import shutil
import sys
from contextlib import suppress
from pathlib import Path

FOLDERS = ("{case}", "{out}")
PYTHON = "python:"  # begins the name of a function, see callables.py


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
    if shutil.which(words[0]) is None and Path(words[0]).is_file():
        raise ValueError(
            f"--solver {command!r}: {words[0]} may not be executed; type chmod +x {words[0]}, "
            f"or name what runs it, such as 'python {command}'"
        )
    if shutil.which(words[0]) is None:
        path = sys.executable if re.fullmatch(r"python[\d.]*", words[0]) else "./mycode"
        raise ValueError(f"--solver {command!r}: there is no program {words[0]!r}; give its path, such as {path}")
    return words


def version(command: str) -> str:
    """Hash of the program and of all files among its arguments, 12 hex digits."""
    found = hashlib.sha256()
    for number, word in enumerate(parts(command)):
        file = Path(shutil.which(word) or word) if number == 0 else Path(word)
        found.update(b"\0" + word.encode())
        if file.is_file():
            with suppress(OSError):
                found.update(file.read_bytes())
    return found.hexdigest()[:12]


def program(command: str) -> str:
    """Name of the program: of the first file among its arguments, as of `python mine.py`, or of its first word."""
    if command.startswith(PYTHON):
        return command.rpartition(".")[2]
    first, *others = parts(command)
    return next((Path(word).name for word in others if Path(word).is_file()), Path(first).name)


def filled(command: str, case: Path, out: Path) -> list[str]:
    """Words of a command with the two folders; a path to the program is that of where verify was started."""
    words = [word.replace("{case}", str(case)).replace("{out}", str(out)) for word in parts(command)]
    return [str(Path(shutil.which(words[0]) or words[0]).absolute()), *words[1:]]
