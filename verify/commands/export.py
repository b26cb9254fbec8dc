"""`verify export SOLUTION`: a case folder for a solver of your own: particles, body force in nine languages, values."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mpm_verify.cases.mms.run import PRECISIONS
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS
from mpm_verify.verify.choices import choices, completing, completion
from mpm_verify.verify.terminal.output import printing

if TYPE_CHECKING:
    from mpm_verify.mms.export.case import Exported

MOST_PARTICLES = 4_000_000


def export(
    solution: Annotated[
        str,
        typer.Argument(
            metavar="SOLUTION",
            help=f"{choices(SOLUTIONS)}, with parameters as axis_aligned:A=0.01, or a file: path/to/own.py.",
            autocompletion=completion(SOLUTIONS),
        ),
    ],
    to: Annotated[Path, typer.Option("--to", help="Folder, new or of an exported case.")],
    cells: Annotated[int, typer.Option(help="Cells along the width of the body.")] = 16,
    ppc: Annotated[int, typer.Option(help="Particles per cell, a square number.")] = 4,
    material: Annotated[
        str | None,
        typer.Option(
            help=f"{choices(MATERIALS)}; parameters as neo_hookean:nu=0.2.",
            autocompletion=completion(MATERIALS),
            show_default="the solution's own",
        ),
    ] = None,
    courant: Annotated[float, typer.Option(help="C dt / dx, C the reference speed of the solution.")] = 0.4,
    frames: Annotated[int, typer.Option(help="Output steps, spread over the run.")] = 16,
    precision: Annotated[
        str,
        typer.Option(
            help="Precision that the solver computes with: double, single.",
            autocompletion=completing(lambda: PRECISIONS),
        ),
    ] = "double",
) -> None:
    """Write a folder with all that another solver needs to be verified with a manufactured solution."""
    from mpm_verify.verify.run import check_count, usage

    with usage():
        from mpm_verify.reports.export.case_folder import usable, write

        check_count(frames, "--frames")
        usable(to)
        case = made(solution, material, cells, ppc, courant, frames, precision)
        written = write(to, case)
    with printing():
        typer.echo(f"{to}: {len(written)} files, {case.record.particles} particles, {case.record.steps} steps")
        typer.echo(f"read {to / 'README.md'}; check the sources with: verify check-force {to}")


def made(
    solution: str, material: str | None, cells: int, ppc: int, courant: float, frames: int, precision: str = "double"
) -> "Exported":
    """Content of a case, after the checks that a run of it has to pass. Raises ValueError."""
    from mpm_verify.cases.mms.case import canonical, check
    from mpm_verify.cases.mms.run import Run
    from mpm_verify.mms.export.case import Names, export
    from mpm_verify.solver.plugins import create

    values = canonical({"solution": solution, "material": material or "", "precision": precision})
    run = Run(**values, cells=cells, ppc=ppc, courant=courant)
    if run.particles > MOST_PARTICLES:
        raise ValueError(f"{run.particles} particles are too many for a table; choose fewer cells or --ppc")
    check([replace(run, precision=Run.precision)])  # that of the reference solver
    plugin = create(SOLUTIONS, run.solution)
    return export(
        Names(run.solution, run.material),
        plugin,
        create(MATERIALS, run.material),
        cells,
        ppc,
        courant,
        frames,
        precision=run.precision,  # type: ignore[arg-type]
    )


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("export")(export)
