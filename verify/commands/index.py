"""`verify index FOLDER`: a page over a folder of studies: verdict, what came out, date, link; runs nothing."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mpm_verify.verify.options import Json
from mpm_verify.verify.terminal.output import printing

if TYPE_CHECKING:
    from mpm_verify.reports.indexed import Entry


def index(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Folder with studies below it.")] = Path("results"),
    json_output: Json = False,
) -> None:
    """Write FOLDER/index.html, a page that leads to the studies in a folder, and print what it says."""
    from mpm_verify.verify.run import usage

    with usage():
        from dataclasses import asdict

        from mpm_verify.reports.indexed import entries
        from mpm_verify.reports.pages._index import page

        found = entries(folder)
        path = page(folder, found)
    with printing():
        if json_output:
            typer.echo(json.dumps({"index": str(path), "studies": [asdict(one) for one in found]}, indent=1))
        else:
            show(found, path)


def show(found: "list[Entry]", path: Path) -> None:
    """Print a row for each study."""
    from rich.text import Text

    from mpm_verify.verify.terminal.table import STYLES, bare, listened

    out = listened(120)
    table = bare()
    for name in ("", "study", "what came out", "written (UTC)"):
        table.add_column(name, overflow="fold")
    for one in found:
        table.add_row(Text(one.outcome, STYLES.get(one.outcome, "")), Text(one.folder), Text(one.headline), one.date)
    out.print(table)
    out.print(f"\nindex: {path}", soft_wrap=True)


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("index")(index)
