"""Log of a solver of somebody else: what it printed, kept up to a limit, and its last lines to be shown."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

LINES, WIDTH = 8, 200  # of the lines that are shown
MOST = 2**20  # bytes of each output that are kept, the last ones


@dataclass(frozen=True)
class Log:
    """Log: its last lines, what was printed on the error output last; and all of it that is kept."""

    lines: tuple[str, ...] = ()
    text: str = ""

    @property
    def kept(self) -> dict[str, str]:
        """Text that is stored beside a Result."""
        return {"log": self.text} if self.text else {}


EMPTY = Log()


def logged(files: Iterable[Path], names: Mapping[str, str]) -> Log:
    """Log of the files that took the outputs of a program, in this order, with names for folders that are gone."""
    text = "\n".join(kept for kept in (end_of(file).rstrip() for file in files) if kept)
    for folder, name in names.items():
        text = text.replace(folder, name)
    return of_text(text)


def of_text(text: str) -> Log:
    """Log of a text."""
    lines = [line for line in map(shown, text[-4 * LINES * WIDTH :].splitlines()) if line.strip()]
    return Log(tuple(lines[-LINES:]), f"{text.rstrip()}\n" if text.strip() else "")


def shown(line: str) -> str:
    """Line as it is shown: indented as it was, without bytes of control such as those of colours, not too long."""
    told = "".join(letter if letter.isprintable() else " " for letter in line.expandtabs(4)).rstrip()
    return told if len(told) <= WIDTH else f"{told[: WIDTH - 1]}…"


def end_of(file: Path) -> str:
    """Last part of a file as text; none of one that is not there."""
    if not file.is_file():
        return ""
    with file.open("rb") as read:
        size = read.seek(0, 2)
        read.seek(max(0, size - MOST))
        return read.read().decode("utf-8", "replace")
