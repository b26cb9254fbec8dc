"""`verify report DIR`: make the page of a stored study again; runs nothing."""

from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mpm_verify.verify.choices import integers
from mpm_verify.verify.terminal.output import printing

if TYPE_CHECKING:
    from mpm_verify.reports.frames import Record


def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a study.")],
    field: Annotated[
        str | None,
        typer.Option(help="Run of the error field: cells,particles per cell.", show_default="the one nearest to 16,4"),
    ] = None,
) -> None:
    """Make the HTML page, figures and tables of what is stored again, without running anything."""
    from mpm_verify.verify.run import page_of, usage

    with usage():
        from mpm_verify.reports.frames import read

        record = read(folder)
        page = page_of(record, vtk=(folder / "vtk").exists(), **({"field": of(field, record)} if field else {}))
    with printing():
        typer.echo(f"report: {page}")


def of(field: str, record: "Record") -> tuple[int, int]:
    """Cells and particles per cell of a run of the study. Raises ValueError for one that it has not."""
    from mpm_verify.verify.run import of_case

    module = of_case("reports.pages", record)
    if module is None or "field" not in signature(module.page).parameters:
        raise ValueError(f"--field: the case {record.study.case} has no error field; leave it out")
    chosen = integers(field, "--field", "64,4")
    if len(chosen) != 2 or min(chosen) < 1:
        raise ValueError(f"--field {field!r} cannot be read; write cells,particles per cell, such as 64,4")
    runs = record.study.runs
    there = sorted({(run.cells, run.ppc) for run in runs if hasattr(run, "cells") and hasattr(run, "ppc")})
    if chosen not in there:
        known = "; ".join(f"{cells},{ppc}" for cells, ppc in there)
        raise ValueError(f"--field {field}: the study has no such run; choose from {known or 'none'}")
    return chosen[0], chosen[1]


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("report")(report)
