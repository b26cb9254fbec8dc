"""Options that several commands have, and the check of a count; the help of each is said once."""

from pathlib import Path
from typing import Annotated

import typer

Jobs = Annotated[int | None, typer.Option(help="Runs at a time.", show_default="processors")]
Json = Annotated[bool, typer.Option("--json", help="One JSON document on standard output, nothing else.")]
Junit = Annotated[Path | None, typer.Option(help="Write the checks as JUnit XML.")]
Vtk = Annotated[bool, typer.Option("--vtk", help="Write snapshots for ParaView.")]


def check_count(count: int | None, option: str) -> None:
    """Raises ValueError unless it is left out or 1 and more."""
    if count is not None and count < 1:
        raise ValueError(f"{option} takes whole numbers from 1 on")
