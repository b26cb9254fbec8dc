"""Folders that are written for other solvers: where one may be written, and the words in it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

TEMPLATES = Path(__file__).absolute().parent.parent / "templates"
README = "README.md"


def usable(folder: Path, ours: Callable[[Path], object], kind: str) -> None:
    """Raise ValueError unless a folder of a kind can be written there: nothing is there yet, or one of that kind.

    Parameters
    ----------
    folder
        Where it is to be.
    ours
        Raises ValueError for a folder that is not of the kind.
    kind
        Its name in a sentence, `case`.
    """
    if folder.is_symlink() and not folder.exists():
        raise ValueError(f"{folder} is a link that leads nowhere; name another folder")
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is a file; name a folder")
    if folder.exists() and any(folder.iterdir()):
        try:
            ours(folder)
        except ValueError:
            raise ValueError(
                f"{folder} holds something that is not an exported {kind}; name a new folder, or an empty one"
            ) from None


def rendered(template: str, **values: Any) -> str:
    """Text of a template with these values. Raises jinja2.UndefinedError for one that it lacks."""
    environment = Environment(loader=FileSystemLoader(TEMPLATES), undefined=StrictUndefined, keep_trailing_newline=True)
    environment.trim_blocks = environment.lstrip_blocks = True
    return environment.get_template(template).render(**values)
