"""`verify report DIR`: make the report of a stored study again; runs nothing."""

from pathlib import Path
from typing import Annotated

import typer

from verify.output import printing


def report(folder: Annotated[Path, typer.Argument(metavar="DIR", help="Study folder.")]) -> None:
    """Make the HTML report, figures and tables of a stored study again, without running anything."""
    from verify.conduct import usage

    with usage():
        from reports.render import render

        page = render(folder)
    with printing():
        typer.echo(f"report: {page}")
