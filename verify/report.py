"""`verify report DIR`: make the report of a stored study again; runs nothing."""

from pathlib import Path
from typing import Annotated

import typer

from verify.choices import integers
from verify.output import printing


def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Study folder.")],
    field: Annotated[str, typer.Option(help="Run of the error field: cells,particles per cell.")] = "16,4",
) -> None:
    """Make the HTML report, figures and tables of a stored study again, without running anything."""
    from verify.conduct import usage

    with usage():
        chosen = integers(field, "--field")
        if len(chosen) != 2 or min(chosen) < 1:
            raise ValueError(f"--field {field!r} is no run; write cells,particles per cell, such as 64,4")
        from reports.render import render

        page = render(folder, *chosen)
    with printing():
        typer.echo(f"report: {page}")
