"""`verify column`: one granular column, from release to rest."""

import shlex
import sys
from dataclasses import fields
from math import inf
from pathlib import Path
from typing import Annotated

import typer

from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS
from mpm_verify.verify.options.choices import choices, completion
from mpm_verify.verify.options.common import Json, Junit, Vtk


def column(
    method: Annotated[
        str, typer.Option(help=f"{choices(METHODS, own=True)}.", autocompletion=completion(METHODS))
    ] = "cpdi",
    cells: Annotated[int, typer.Option(help="Cells of the column's width; the paper prints 135.")] = 14,
    ppc: Annotated[int, typer.Option(help="Particles per cell, a square number.")] = 9,
    law: Annotated[
        str,
        typer.Option(
            help=f"{choices(MATERIALS, own=True)}, in rate form; parameters as mohr_coulomb:phi=35.",
            autocompletion=completion(MATERIALS),
        ),
    ] = "mohr_coulomb",
    damping: Annotated[float, typer.Option(help="Share of the unbalanced force at each node, 0.05 for 5 %.")] = 0.0,
    damping_kind: Annotated[str, typer.Option(help="local (component by component) or objective.")] = "local",
    smoothing: Annotated[
        str,
        typer.Option(
            help=f"none, {choices(SMOOTHINGS, own=True)}; parameters as deviatoric:of=rate,where=node.",
            autocompletion=completion(SMOOTHINGS),
        ),
    ] = "none",
    transfer: Annotated[
        str, typer.Option(help=f"{choices(TRANSFERS, own=True)}.", autocompletion=completion(TRANSFERS))
    ] = "flip",
    deformation: Annotated[str, typer.Option(help="Update of F: exponential, or linear as printed.")] = "exponential",
    limit: Annotated[float, typer.Option(help="Longest half diagonal of a CPDI domain, in cells; inf for none.")] = 0.5,
    void: Annotated[bool, typer.Option(help="Void-strain memory of the law.")] = True,
    courant: Annotated[float, typer.Option(help="dt c / dx, c the law's compression wave.")] = 0.4,
    duration: Annotated[float, typer.Option(help="Seconds.")] = 1.4,
    start: Annotated[str, typer.Option(help="Stress at first: none, k0 or oedometric.")] = "none",
    left: Annotated[str, typer.Option(help="The wall: roller or fixed (nothing slips).")] = "roller",
    gate: Annotated[float, typer.Option(help="Speed at which the gate is lifted, m/s; inf: gone at once.")] = inf,
    stops: Annotated[bool, typer.Option(help="Walls hand their reaction on to the particles.")] = True,
    offset: Annotated[str, typer.Option(help="Shift of the particles, in shares of their spacing.")] = "0,0",
    mirror: Annotated[bool, typer.Option(help="Wall to the right.")] = False,
    width: Annotated[float, typer.Option(help="Of the column, m.")] = 0.0905,
    aspect: Annotated[float, typer.Option(help="Height over width.")] = 7.0,
    channel: Annotated[float, typer.Option(help="Length of the channel, in widths.")] = 18.0,
    g: Annotated[float, typer.Option(help="m/s2; the paper has 10.")] = 10.0,
    vtk: Vtk = False,
    threads: Annotated[int, typer.Option(help="Threads of the run.")] = 1,
    out: Annotated[Path, typer.Option(help="Folder of the study.")] = Path("results/column"),
    json_output: Json = False,
    junit: Junit = None,
) -> int:
    """Let a column of sand collapse: front, height, profile, energies, an animation."""
    given = dict(locals())
    from mpm_verify.verify.collapse import Wanted, conduct
    from mpm_verify.verify.conduct import usage

    with usage():
        from mpm_verify.cases.column.run import ColumnRun, ColumnStudy
        from mpm_verify.cases.column.sweep import run_of

        values = {item.name: given[item.name] for item in fields(ColumnRun) if item.name in given}
        run = run_of(values | {"offset": pair(offset)})
    command = "verify " + shlex.join(sys.argv[1:])
    study = ColumnStudy("column", "Collapse of a granular column", command, (run,), finish=1)
    return conduct(study, out, 1, threads, Wanted(vtk, json_output, junit))


def pair(text: str) -> tuple[float, float]:
    """`0.25,-0.1` as two numbers. Raises ValueError."""
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        raise ValueError(f"--offset {text!r} must be two numbers, such as 0.25,-0.1") from None
    return x, y
