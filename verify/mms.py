"""`verify mms`: sweep methods, cells and particles per cell over a manufactured solution, and judge the orders."""

import shlex
import sys
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from solver.plugins import MATERIALS, METHODS, SOLUTIONS
from verify.choices import choices, completion, integers

USUAL = {"cells": "8,16,32,64,128", "ppc": "1,4,9"}
QUICK = {"cells": "8,12,16,24,32", "ppc": "4"}


def mms(
    method: Annotated[
        list[str] | None,
        typer.Option(
            help=f"{choices(METHODS)}; may be repeated.", autocompletion=completion(METHODS), show_default="cpdi"
        ),
    ] = None,
    solution: Annotated[
        str,
        typer.Option(
            help=f"{choices(SOLUTIONS)}; parameters as axis_aligned:A=0.01,phase=0.5.",
            autocompletion=completion(SOLUTIONS),
        ),
    ] = "axis_aligned",
    cells: Annotated[
        str | None, typer.Option(help="Cells along a side of the domain.", show_default=USUAL["cells"])
    ] = None,
    ppc: Annotated[
        str | None, typer.Option(help="Particles per cell, square numbers.", show_default=USUAL["ppc"])
    ] = None,
    material: Annotated[
        str,
        typer.Option(
            help=f"{choices(MATERIALS)}; parameters as neo_hookean:nu=0.2.", autocompletion=completion(MATERIALS)
        ),
    ] = "neo_hookean",
    courant: Annotated[float, typer.Option(help="C dt / dx, C the reference speed of the solution.")] = 0.4,
    flip: Annotated[float, typer.Option(help="Share of FLIP in the particle velocity, the rest is PIC.")] = 1.0,
    staggered: Annotated[bool, typer.Option(help="Start v half a step behind x.")] = True,
    jobs: Annotated[int | None, typer.Option(help="Runs at a time.", show_default="processors / threads")] = None,
    threads: Annotated[int, typer.Option(help="Threads of one run; any number gives the same bits.")] = 1,
    quick: Annotated[bool, typer.Option("--quick", help="8,12,16,24,32 cells with 4 particles each.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Run time steps above the stability limit too.")] = False,
    out: Annotated[Path | None, typer.Option(help="Study folder.", show_default="results/NAME-OF-THE-STUDY")] = None,
    json_output: Annotated[
        bool, typer.Option("--json", help="One JSON document on standard output, nothing else.")
    ] = False,
    junit: Annotated[Path | None, typer.Option(help="Write the verdicts as JUnit XML.")] = None,
) -> int:
    """Convergence of MPM and CPDI to a manufactured solution: errors, observed orders, verdict, HTML report."""
    from verify.conduct import Settings, conduct, usage

    label = "-quick" if quick and cells is None and ppc is None else ""
    default = QUICK if quick else USUAL
    methods = tuple(dict.fromkeys(method or ["cpdi"]))
    with usage():
        from cases.mms_study import Sweep, build

        sweep = Sweep(
            methods,
            solution,
            material,
            integers(default["cells"] if cells is None else cells, "--cells"),
            integers(default["ppc"] if ppc is None else ppc, "--ppc"),
            courant,
            flip,
            staggered,
            force,
        )
        named = replace(sweep, cells=Sweep.cells, ppc=Sweep.ppc) if label else sweep
        command = "verify " + shlex.join(repeatable(sys.argv[1:]))
        study = build(sweep, command, named.name + label)
    if (jobs is not None and jobs < 1) or threads < 1:
        raise typer.TyperException("--jobs and --threads take whole numbers from 1 on")
    folder = out or Path("results") / study.name
    return conduct(study, Settings(folder, jobs, threads, json_output, junit))


def repeatable(arguments: list[str]) -> list[str]:
    """The arguments without those that say only where the result goes."""
    kept, skip = [], False
    for argument in arguments:
        if skip:
            skip = False
        elif argument in ("--out", "--junit", "--jobs", "--threads"):
            skip = True
        elif argument != "--json" and not argument.startswith(("--out=", "--junit=", "--jobs=", "--threads=")):
            kept.append(argument)
    return kept
