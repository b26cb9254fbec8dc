"""`verify mms`: sweep methods, cells and particles per cell over a manufactured solution, and judge the orders."""

import shlex
import sys
from dataclasses import replace
from pathlib import Path
from typing import Annotated, get_args

import typer

from mpm_verify.solver.plugins import LAYOUTS, MATERIALS, METHODS, SOLUTIONS, TRANSFERS
from mpm_verify.solver.stress_update import Stress
from mpm_verify.verify.options.choices import choices, completion, integers
from mpm_verify.verify.options.common import Json

USUAL = {"cells": "8,16,32,64,128", "ppc": "1,4,9"}
QUICK = {"cells": "8,12,16,24,32", "ppc": "4"}


def mms(
    method: Annotated[
        list[str] | None,
        typer.Option(
            help=f"{choices(METHODS, own=True)}; may be repeated.",
            autocompletion=completion(METHODS),
            show_default="cpdi",
        ),
    ] = None,
    solution: Annotated[
        str,
        typer.Option(
            help=f"{choices(SOLUTIONS, own=True)}; parameters as axis_aligned:A=0.01,phase=0.5.",
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
            help=f"{choices(MATERIALS, own=True)}; parameters as neo_hookean:nu=0.2.",
            autocompletion=completion(MATERIALS),
            show_default="the solution's own",
        ),
    ] = "",
    courant: Annotated[
        str,
        typer.Option(
            help="C dt / dx, C the reference speed of the solution; with more, 0.4,0.2,0.1, the finest cells run with "
            "each, and the report has an axis of time."
        ),
    ] = "0.4",
    replicates: Annotated[
        int,
        typer.Option(
            help="Runs of each point, with the particles elsewhere in their cells: an order with its scatter."
        ),
    ] = 1,
    transfer: Annotated[
        str,
        typer.Option(
            help=f"{choices(TRANSFERS, own=True)}; parameters as flip:share=0.95 or fmpm:order=3.",
            autocompletion=completion(TRANSFERS),
        ),
    ] = "flip",
    stress: Annotated[
        str,
        typer.Option(
            help=f"{', '.join(get_args(Stress))}: update last, modified last, first.",
            autocompletion=lambda incomplete: [word for word in get_args(Stress) if word.startswith(incomplete)],
        ),
    ] = "usl",
    layout: Annotated[
        str,
        typer.Option(
            help=f"How particles are spread: {choices(LAYOUTS, own=True)}; parameters as graded:contrast=3,power=0.5.",
            autocompletion=completion(LAYOUTS),
        ),
    ] = "uniform",
    staggered: Annotated[bool, typer.Option(help="Start v half a step behind x.")] = True,
    jobs: Annotated[int | None, typer.Option(help="Runs at a time.", show_default="processors / threads")] = None,
    threads: Annotated[int, typer.Option(help="Threads of one run; any number gives the same bits.")] = 1,
    quick: Annotated[bool, typer.Option("--quick", help="8,12,16,24,32 cells with 4 particles each.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Run time steps above the stability limit too.")] = False,
    out: Annotated[Path | None, typer.Option(help="Study folder.", show_default="results/NAME-OF-THE-STUDY")] = None,
    json_output: Json = False,
    junit: Annotated[Path | None, typer.Option(help="Write the verdicts as JUnit XML.")] = None,
) -> int:
    """Convergence of MPM and CPDI to a manufactured solution: errors, observed orders, verdict, HTML report."""
    from mpm_verify.verify.conduct import Settings, conduct, usage

    label = "-quick" if quick and cells is None and ppc is None else ""
    default = QUICK if quick else USUAL
    methods = tuple(dict.fromkeys(method or ["cpdi"]))
    with usage():
        from mpm_verify.cases.mms.sweep import Sweep, build

        first, *times = courants(courant)
        sweep = Sweep(
            methods,
            solution,
            material,
            integers(default["cells"] if cells is None else cells, "--cells"),
            integers(default["ppc"] if ppc is None else ppc, "--ppc"),
            first,
            transfer,
            stress,
            staggered,
            force,
            tuple(times),
            replicates,
            layout,
        )
        named = replace(sweep, cells=Sweep.cells, ppc=Sweep.ppc) if label else sweep
        command = "verify " + shlex.join(repeatable(sys.argv[1:]))
        study = build(sweep, command, named.name + label)
    if (jobs is not None and jobs < 1) or threads < 1:
        raise typer.TyperException("--jobs and --threads take whole numbers from 1 on")
    folder = out or Path("results") / study.name
    return conduct(study, Settings(folder, jobs, threads, json_output, junit))


def courants(text: str) -> list[float]:
    """`0.4` or `0.4,0.2,0.1` as numbers; a usage error otherwise."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise typer.TyperException(f"--courant {text!r} is no list of numbers; write 0.4 or 0.4,0.2,0.1") from None


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
