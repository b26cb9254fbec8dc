"""`verify sweep`: studies from TOML files, the paper's figures among them."""

from typing import Annotated

import typer

from mpm_verify.cases.harness.shipped import shipped
from mpm_verify.verify.options import DryRun, Jobs, Json, Junit, Out, Page, Summary, Threads, Vtk, Yes


def sweep(
    study: Annotated[
        str,
        typer.Argument(
            metavar="STUDY",
            help=f"A file.toml of your own, or one that ships: {', '.join(shipped())}.",
            autocompletion=lambda incomplete: [name for name in shipped() if name.startswith(incomplete)],
        ),
    ],
    vtk: Vtk = False,
    jobs: Jobs = None,
    threads: Threads = 1,
    out: Out = None,
    json_output: Json = False,
    junit: Junit = None,
    summary: Summary = None,
    page: Page = None,
    dry_run: DryRun = False,
    yes: Yes = False,
) -> int:
    """Run all combinations of a study's axes, of any case, and judge them; the column is held against the paper."""
    from mpm_verify.verify.run import Settings, command, conduct, named, usage

    with usage():
        from mpm_verify.cases.harness.study_file import read

        read_ = read(study, command())
    settings = Settings(
        named(read_, out), jobs=jobs, threads=threads, json_output=json_output, junit=junit, summary=summary, page=page,
        vtk=vtk, dry_run=dry_run, yes=yes,
    )  # fmt: skip
    return conduct(read_, settings)


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("sweep")(sweep)
