"""`verify diff A B`: what has changed between two stored studies: verdicts, orders, errors, how runs ended."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mpm_verify.verify.options import Json
from mpm_verify.verify.terminal.output import printing

if TYPE_CHECKING:
    from mpm_verify.reports.compared import Change

MOST = 40  # rows on a terminal


def diff(
    before: Annotated[Path, typer.Argument(metavar="A", help="Folder of a study.")],
    after: Annotated[Path, typer.Argument(metavar="B", help="Folder of the same study, run with other source code.")],
    tolerance: Annotated[float, typer.Option(help="Relative change of a number that counts; 0: any.")] = 1e-9,
    page: Annotated[Path | None, typer.Option(help="Write a page with all changes to this file.")] = None,
    json_output: Json = False,
) -> int:
    """Say whether another commit changed an error, a verdict, or how a run ended. Exit codes: 0 no, 1 yes."""
    from mpm_verify.verify.run import usage

    with usage():
        from mpm_verify.reports.compared import changes
        from mpm_verify.reports.frames import read

        if not 0 <= tolerance < 1:
            raise ValueError(f"--tolerance {tolerance} must be from 0 to 1, such as 1e-9")
        if page is not None and page.suffix != ".html":
            raise ValueError(f"--page {page} must be a file that ends with .html, such as changes.html")
        a, b = read(before), read(after)
        found, compared = changes(a, b, tolerance)
        if page is not None:
            from mpm_verify.reports.pages._diff import page as draw

            draw(page, a, b, found, compared, tolerance)
    with printing():
        if json_output:
            typer.echo(json.dumps({"compared": compared, "changes": [line(one) for one in found]}, indent=1))
        else:
            show(found)
            typer.echo(f"{len(found)} changes in {compared} runs that both have")
            typer.echo(f"page: {page}") if page else None
    return 1 if found else 0


def line(change: "Change") -> dict[str, Any]:
    """Row of a change for JSON."""
    from dataclasses import asdict

    from mpm_verify.reports.export.document import finite

    found: dict[str, Any] = finite(asdict(change))
    return found


def show(found: "Sequence[Change]") -> None:
    """Print a table of changes, the first where they are many."""
    if not found:
        return
    from rich.text import Text

    from mpm_verify.reports import words
    from mpm_verify.verify.terminal.table import bare, listened

    out = listened(160)
    table = bare()
    for name in ("what", "before", "after", "after / before", "of"):
        table.add_column(name, overflow="fold", justify="left" if name in ("what", "of") else "right")
    for one in found[:MOST]:
        table.add_row(one.what, words.value(one.before), words.value(one.after), one.ratio, Text(one.of))
    out.print(table)
    if len(found) > MOST:
        out.print(f"and {len(found) - MOST} more; --page changes.html or --json has all")


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("diff")(diff)
