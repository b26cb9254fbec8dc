"""`verify export SOLUTION`: a case folder for a solver of your own: particles, body force in nine languages, values.

Of a benchmark, `verify export self_weight`, it has particles and known answers.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mpm_verify.cases.mms.run import PRECISIONS
from mpm_verify.solver.plugins import MATERIALS, PROBLEMS, SOLUTIONS, available, is_file, load, split
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
            help=f"{choices(SOLUTIONS)}, with parameters as axis_aligned:A=0.01, or a file: path/to/own.py; or a "
            f"benchmark: {choices(PROBLEMS)}.",
            autocompletion=completion(SOLUTIONS),
        ),
    ],
    to: Annotated[Path, typer.Option("--to", help="Folder, new or of an exported case.")],
    cells: Annotated[int, typer.Option(help="Cells along the width of the body.")] = 16,
    ppc: Annotated[
        int | None,
        typer.Option(
            help="Particles per cell, a square number; of a solution in three dimensions a cube number, in one any.",
            show_default="4, 8 or 2",
        ),
    ] = None,
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
    dim: Annotated[
        int | None,
        typer.Option(
            help="Dimensions, 1 to 3: with 3 a plane-strain solution is one cell thick.",
            show_default="the solution's own",
        ),
    ] = None,
) -> None:
    """Write a folder with all that another solver needs to be verified with a manufactured solution."""
    from mpm_verify.verify.run import check_count, usage

    if states_problem(solution):
        benchmark(solution, to, material, cells, ppc, courant, others=(frames, precision, dim) != (16, "double", None))
        return
    with usage():
        from mpm_verify.reports.export.case_folder import usable, write

        check_count(frames, "--frames")
        usable(to)
        case = made(solution, material, cells, ppc, courant, frames, dim, precision)
        written = write(to, case)
    with printing():
        typer.echo(f"{to}: {len(written)} files, {case.record.particles} particles, {case.record.steps} steps")
        typer.echo(f"read {to / 'README.md'}; check the sources with: verify check-force {to}")


def states_problem(specification: str) -> bool:
    """Whether this is a benchmark, or a file with a problem of one's own."""
    name = split(specification)[0]
    if not is_file(specification):
        return name in available(PROBLEMS)
    try:
        load(PROBLEMS, name)
    except ValueError:
        return False
    return True


def benchmark(
    problem: str, to: Path, material: str | None, cells: int, ppc: int | None, courant: float, others: bool
) -> None:
    """Write the folder of a benchmark; `others`: whether options are given that it does not have."""
    from mpm_verify.verify.run import usage

    with usage():
        from mpm_verify.cases.benchmark.exported import exported
        from mpm_verify.reports.export.benchmark_folder import write
        from mpm_verify.solver.plugins import create

        if others:
            raise ValueError(f"{problem} has neither frames, precision nor dim; leave these options out")
        case = exported(problem, material, cells, ppc, courant)
        written = write(to, case, create(PROBLEMS, problem))
    with printing():
        typer.echo(f"{to}: {len(written)} files, {case.record.particles} particles; read {to / 'README.md'}")


def made(
    solution: str,
    material: str | None,
    cells: int,
    ppc: int | None,
    courant: float,
    frames: int,
    dim: int | None = None,
    precision: str = "double",
) -> "Exported":
    """Content of a case, after the checks that a run of it has to pass. Raises ValueError."""
    from mpm_verify.cases.mms.case import canonical, check_solutions
    from mpm_verify.cases.mms.run import LINE, SOLID, Run
    from mpm_verify.mms.discretisation import dimension
    from mpm_verify.mms.export.case import Names, export
    from mpm_verify.mms.export.slice import sliced
    from mpm_verify.solver.plugins import create

    asked = {"dim": dim} if dim is not None else {}
    values = canonical({"solution": solution, "material": material or "", "precision": precision, **asked})
    plugin = create(SOLUTIONS, values["solution"])
    usual = {1: LINE["ppc"][0], 2: Run.ppc, 3: SOLID["ppc"][0]}[dimension(plugin)]
    run = Run(**values, cells=cells, ppc=usual if ppc is None else ppc, courant=courant)
    if run.particles > MOST_PARTICLES:
        raise ValueError(f"{run.particles} particles are too many for a table; choose fewer cells or --ppc")
    check_solutions([run])
    if run.strays:
        raise ValueError(
            f"{run.material} has a rate without an energy, and is another solid than the one whose motion is exact; "
            "export --material hencky, which is that one"
        )
    names, model = Names(run.solution, run.material), create(MATERIALS, run.material)
    return export(
        names,
        sliced(plugin, run.dim, cells),
        model,
        cells,
        run.ppc,
        courant,
        frames,
        precision=run.precision,  # type: ignore[arg-type]
    )


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("export")(export)
