"""Names that options complete and list; from file names, so that neither Numba nor SymPy is imported."""

from collections.abc import Callable, Sequence

import typer

from mpm_verify.solver.plugins import available


def completion(package: str) -> Callable[[str], list[str]]:
    """Completion of plug-in names of a package."""
    return completing(lambda: available(package))


def completing(names: Callable[[], Sequence[str]]) -> Callable[[str], list[str]]:
    """Completion of names, of a list with commas its last."""

    def complete(incomplete: str) -> list[str]:
        before, comma, last = incomplete.rpartition(",")
        return [f"{before}{comma}{name}" for name in names() if name.startswith(last)]

    return complete


def choices(package: str, own: bool = False) -> str:
    """Names of the plug-ins of a package, for a help text, and that a user's file is taken."""
    return ", ".join(available(package)) + "; or a file of your own" * own


def integers(text: str, option: str, example: str = "8,16,32,64") -> tuple[int, ...]:
    """Whole numbers of a text such as `8,16,32`; a usage error that names the option, with an example, otherwise."""
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise typer.TyperException(f"{option} {text!r} is not a list of whole numbers; write {example}") from None
