"""`verify report DIR`: make the report of a stored study or examination again; runs nothing."""

from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer

from mpm_verify.verify.options.choices import integers
from mpm_verify.verify.terminal.output import printing

PAGES = {
    "objectivity": "mpm_verify.reports.pages.objectivity",
    "material": "mpm_verify.reports.pages.element",
}  # of examinations


def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a study or an examination.")],
    field: Annotated[str, typer.Option(help="Run of the error field: cells,particles per cell.")] = "16,4",
) -> None:
    """Make the HTML report, figures and tables of what is stored again, without running anything."""
    from mpm_verify.verify.conduct import usage

    with usage():
        chosen = integers(field, "--field")
        if len(chosen) != 2 or min(chosen) < 1:
            raise ValueError(f"--field {field!r} is no run; write cells,particles per cell, such as 64,4")
        page = made(folder, *chosen)
    with printing():
        typer.echo(f"report: {page}")


def made(folder: Path, cells: int, ppc: int) -> Path:
    """The page of whatever the folder holds."""
    if (folder / "examination.json").exists():
        return examined(folder)
    from mpm_verify.cases.harness.store import case_of

    if case_of(folder) == "column":
        from mpm_verify.reports.pages.column import page

        return page(folder, vtk=(folder / "vtk").exists())[1]
    return study(folder, cells, ppc)


def study(folder: Path, cells: int, ppc: int) -> Path:
    """The page of a study."""
    from mpm_verify.reports.pages.mms import render

    return render(folder, cells, ppc)


def examined(folder: Path) -> Path:
    """The page of an examination: its name, up to a hyphen, says which. Raises ValueError, StoreError."""
    from mpm_verify.cases.harness.checks import load
    from mpm_verify.cases.harness.store import StoreError

    examination = load(folder)
    kind = examination.name.partition("-")[0]
    if kind not in PAGES:
        known = ", ".join(PAGES)
        raise ValueError(f"{folder} holds an examination {examination.name!r}, which must be of {known}, or newer")
    try:
        page: Path = import_module(PAGES[kind]).page(folder, examination)
    except KeyError as error:
        raise StoreError(f"{folder} lacks {error}, which this version draws; run it again") from error
    return page
