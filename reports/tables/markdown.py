"""Tables in Markdown."""

from collections.abc import Iterable


def row(cells: Iterable[str]) -> str:
    """Row of a table, without the end of its line."""
    return f"| {' | '.join(map(escaped, cells))} |"


def escaped(text: str) -> str:
    """Text in one line that neither ends a cell nor begins a tag."""
    return " ".join(text.replace("|", "\\|").replace("<", "&lt;").split())
