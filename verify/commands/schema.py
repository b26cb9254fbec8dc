"""`verify schema CASE`: JSON schema of what --json prints, of verify compare too, or of an exported folder."""

import json
from typing import Annotated, Any

import typer

from mpm_verify.solver.plugins import CASES, available, meant
from mpm_verify.verify.choices import completing
from mpm_verify.verify.terminal.output import printing

COMPARE, FOLDER, BENCHMARK = "compare", "case-folder", "benchmark-folder"


def names() -> list[str]:
    """Names of what has a schema."""
    return [*available(CASES), COMPARE, FOLDER, BENCHMARK]


def schema(
    case: Annotated[
        str,
        typer.Argument(metavar="CASE", help=f"{', '.join(names())}.", autocompletion=completing(names)),
    ] = "mms",
) -> None:
    """Print the JSON schema (draft 2020-12) of what --json prints for a case or compare; of folders: of case.json."""
    from mpm_verify.verify.run import usage

    with usage():
        text = json.dumps(derived(case), indent=1)
    with printing():
        typer.echo(text)


def derived(case: str) -> dict[str, Any]:
    """Schema of a name. Raises ValueError for another one."""
    if case == FOLDER:
        from mpm_verify.reports.export.case_folder import schema as of_folder

        return of_folder()
    if case == BENCHMARK:
        from mpm_verify.reports.export.benchmark_folder import schema as of_benchmark

        return of_benchmark()
    if case == COMPARE:
        from mpm_verify.reports.export.digits import schema as of_comparison

        return of_comparison()
    from mpm_verify.reports.export.document import schema as of_document

    if not case.endswith(".py") and case not in names():
        raise ValueError(f"no schema {case!r}{meant(case, names())}; choose from {', '.join(names())}, or give a file")
    return of_document(case)


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("schema")(schema)
