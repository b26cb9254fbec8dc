"""`verify sweep`: studies from TOML files, the paper's figures among them."""

from pathlib import Path
from typing import Annotated, Any

import typer

from mpm_verify.cases.harness.shipped import shipped
from mpm_verify.verify.options import Minutes, Vtk, common
from mpm_verify.verify.run import CHECKPOINT


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
    checkpoint: Minutes = CHECKPOINT,
    *,
    out: Path | None,
    **more: Any,
) -> int:
    """Run all combinations of a study's axes, of any case, and judge them; the column is held against the paper."""
    from mpm_verify.verify.run import Settings, command, conduct, named, usage

    with usage():
        from mpm_verify.cases.harness.study_file import read

        read_ = read(study, command())
    return conduct(read_, Settings(named(read_, out), vtk=vtk, checkpoint=checkpoint, **more))


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("sweep")(common(sweep))
