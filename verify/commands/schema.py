"""`verify schema CASE`: JSON schema of what --json prints, derived from the records that are printed."""

import json
from typing import Annotated

import typer

from mpm_verify.solver.plugins import CASES, available
from mpm_verify.verify.choices import completion
from mpm_verify.verify.terminal.output import printing


def schema(
    case: Annotated[
        str,
        typer.Argument(metavar="CASE", help=f"{', '.join(available(CASES))}.", autocompletion=completion(CASES)),
    ] = "mms",
) -> None:
    """Print the JSON schema (draft 2020-12) of the document that --json prints for a case."""
    from mpm_verify.verify.run import usage

    with usage():
        from mpm_verify.reports.export.document import schema as derived

        text = json.dumps(derived(case), indent=1)
    with printing():
        typer.echo(text)


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("schema")(schema)
