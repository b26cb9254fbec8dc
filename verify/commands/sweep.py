"""`verify sweep`: studies of the column, the paper's figures among them, from TOML files."""

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from mpm_verify.cases.harness.shipped import shipped
from mpm_verify.verify.options.common import Jobs, Json, Junit, Vtk


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
    threads: Annotated[int, typer.Option(help="Threads of each run.")] = 1,
    out: Annotated[Path | None, typer.Option(help="Study folder.", show_default="results/STUDY")] = None,
    json_output: Json = False,
    junit: Junit = None,
) -> int:
    """Run all combinations of a study's axes on the collapsing column, and hold them against the paper."""
    from mpm_verify.verify.collapse import Wanted, conduct
    from mpm_verify.verify.conduct import usage

    with usage():
        from mpm_verify.cases.column.sweep import read

        read_ = read(study, "verify " + shlex.join(sys.argv[1:]))
    return conduct(read_, out or Path("results") / read_.name, jobs, threads, Wanted(vtk, json_output, junit))
