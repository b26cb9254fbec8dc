"""`verify sweep`: studies of the column, the paper's figures among them, from TOML files."""

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from solver.sources import TOP

STUDIES = TOP / "cases" / "studies"


def names() -> list[str]:
    """Of the studies that ship; by file names, nothing heavy is imported."""
    return sorted(file.stem for file in STUDIES.glob("*.toml"))


def sweep(
    study: Annotated[
        str,
        typer.Argument(
            metavar="STUDY",
            help=f"A file.toml of your own, or one that ships: {', '.join(names())}.",
            autocompletion=lambda incomplete: [name for name in names() if name.startswith(incomplete)],
        ),
    ],
    vtk: Annotated[bool, typer.Option("--vtk", help="Write snapshots for ParaView.")] = False,
    jobs: Annotated[int | None, typer.Option(help="Runs at a time.", show_default="processors")] = None,
    threads: Annotated[int, typer.Option(help="Threads of each run.")] = 1,
    out: Annotated[Path | None, typer.Option(help="Study folder.", show_default="results/STUDY")] = None,
    json_output: Annotated[
        bool, typer.Option("--json", help="One JSON document on standard output, nothing else.")
    ] = False,
    junit: Annotated[Path | None, typer.Option(help="Write the checks as JUnit XML.")] = None,
) -> int:
    """Run all combinations of a study's axes on the collapsing column, and hold them against the paper."""
    from verify.collapse import Wanted, conduct
    from verify.conduct import usage

    with usage():
        from cases.column_sweep import read

        read_ = read(study, "verify " + shlex.join(sys.argv[1:]))
    return conduct(read_, out or Path("results") / read_.name, jobs, threads, Wanted(vtk, json_output, junit))
