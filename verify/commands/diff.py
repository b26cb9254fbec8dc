"""`verify diff A B`: what has changed between two stored studies: errors, verdicts, how runs ended."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mpm_verify.verify.options import Json
from mpm_verify.verify.terminal.output import printing

if TYPE_CHECKING:
    from mpm_verify.reports.compared import Change


def diff(
    before: Annotated[Path, typer.Argument(metavar="A", help="Folder of a study.")],
    after: Annotated[Path, typer.Argument(metavar="B", help="Folder of the same study, run with other source code.")],
    tolerance: Annotated[float, typer.Option(help="Relative change of a number that counts; 0: any.")] = 1e-9,
    json_output: Json = False,
) -> int:
    """Say whether another commit changed an error, a verdict, or how a run ended. Exit codes: 0 no, 1 yes."""
    from mpm_verify.verify.run import usage

    with usage():
        from mpm_verify.reports.compared import changes
        from mpm_verify.reports.frames import read

        if not 0 <= tolerance < 1:
            raise ValueError(f"--tolerance {tolerance} must be from 0 to 1, such as 1e-9")
        found, compared = changes(read(before), read(after), tolerance)
    with printing():
        if json_output:
            typer.echo(json.dumps({"compared": compared, "changes": [line(one) for one in found]}, indent=1))
        else:
            for one in found:
                typer.echo(str(one))
            typer.echo(f"{len(found)} changes in {compared} runs that both have")
    return 1 if found else 0


def line(change: "Change") -> dict[str, Any]:
    """Row of a change for JSON."""
    from dataclasses import asdict

    from mpm_verify.reports.export.document import finite

    found: dict[str, Any] = finite(asdict(change))
    return found


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("diff")(diff)
