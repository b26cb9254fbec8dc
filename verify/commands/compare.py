"""`verify compare`: digits of a solver of your own beside those of the reference, and where the two part."""

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mpm_verify.solver.plugins import MATERIALS, METHODS, SOLUTIONS, TRANSFERS
from mpm_verify.verify.choices import choices, completing, completion
from mpm_verify.verify.options import Json, Threads, split
from mpm_verify.verify.terminal.output import printing

if TYPE_CHECKING:
    from mpm_verify.cases.mms.digits.examine import Examined, Tick

STRESSES = ("usl", "musl", "usf")


def compare(
    solver: Annotated[
        str, typer.Option(help="Solver of your own: a command such as './mine {case} {out}', see docs/own-solver.md.")
    ],
    solution: Annotated[
        str, typer.Option(help=f"{choices(SOLUTIONS, own=True)}.", autocompletion=completion(SOLUTIONS))
    ] = "clamped_shear",
    material: Annotated[
        str | None,
        typer.Option(
            help=f"{choices(MATERIALS)}.", autocompletion=completion(MATERIALS), show_default="the solution's own"
        ),
    ] = None,
    cells: Annotated[int, typer.Option(help="Cells along a side of the domain.")] = 16,
    ppc: Annotated[int, typer.Option(help="Particles per cell, a square number.")] = 4,
    courant: Annotated[float, typer.Option(help="C dt / dx, C the reference speed of the solution.")] = 0.4,
    method: Annotated[
        str,
        typer.Option(
            help=f"Bases of the references, with commas: {choices(METHODS)}.",
            autocompletion=completion(METHODS),
            show_default="mpm,gimp,cpgimp,cpdi,bspline2,bspline3,tlmpm",
        ),
    ] = "",
    stress: Annotated[
        str,
        typer.Option(
            help="Their stress updates, with commas.",
            autocompletion=completing(lambda: STRESSES),
            show_default="usl,musl,usf",
        ),
    ] = "",
    transfer: Annotated[
        str,
        typer.Option(
            help=f"Their transfers, with commas: {choices(TRANSFERS)}.",
            autocompletion=completion(TRANSFERS),
            show_default="flip,pic,apic",
        ),
    ] = "",
    stored: Annotated[
        bool, typer.Option("--stored", help="Hold it against stored rms values alone; the reference is not run.")
    ] = False,
    time_limit: Annotated[float, typer.Option(help="Seconds that your solver may take.")] = 600.0,
    memory_limit: Annotated[float, typer.Option(help="Address space that it may have, MB; 0: any.")] = 0.0,
    threads: Threads = 1,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the page.", show_default="results/compare-NAME-SOLUTION-CELLS")
    ] = None,
    page: Annotated[
        bool | None, typer.Option("--page/--no-page", help="Draw the page.", show_default="page, unless --json")
    ] = None,
    json_output: Json = False,
) -> int:
    """Hold an answer against runs of the reference. Exit codes: 0 agrees, 1 parts, 3 too few digits, 4 no answer."""
    from mpm_verify.verify.run import command, folder_of, usage

    with usage():
        from mpm_verify.verify.comparing import examined_of, name_of, page_of, run_of, schemes_of

        limits = {"time_limit": time_limit, "memory_limit": memory_limit}
        run = run_of(solver, solution, material, cells=cells, ppc=ppc, courant=courant, **limits)
        chosen = schemes_of(split(method), split(stress), split(transfer))
        with told() as tick:
            examined = examined_of(run, chosen, stored, threads, tick)
        wanted = not json_output if page is None else page
        path = page_of(examined, folder_of(name_of(examined), out), command()) if wanted else None
    with printing():
        return print_all(examined, path, json_output)


@contextmanager
def told() -> "Iterator[Tick]":
    """Number of references that are done, on standard error where that is a terminal."""
    there = sys.stderr is not None and sys.stderr.isatty()

    def tick(done: int, of: int) -> None:
        if there:
            print(f"\r{done} of {of} references", end="", file=sys.stderr, flush=True)

    yield tick
    if there:
        print("\r\033[K", end="", file=sys.stderr, flush=True)


def print_all(examined: "Examined", page: Path | None, json_output: bool) -> int:
    """Print the comparison, or one JSON document; gives the exit code."""
    from mpm_verify.reports.export.digits import document

    row = document(examined.run, examined.compared, str(page) if page else None)
    if json_output:
        typer.echo(json.dumps(row, indent=1))
    else:
        from mpm_verify.verify.terminal.digits import show

        show(examined, page)
    code: int = row["exit_code"]
    return code


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("compare")(compare)
