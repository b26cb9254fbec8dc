"""`verify mms`: sweep the axes of a run over manufactured solutions, and judge the orders."""

from pathlib import Path
from typing import Annotated, Any

import typer

from mpm_verify.cases.mms.run import AXES, QUICK, STARTS, Run
from mpm_verify.verify.options import study_command, values

Replicates = Annotated[
    int,
    typer.Option(help="Runs of each point, with the particles elsewhere in their cells: an order with its scatter."),
]
Quick = Annotated[
    bool,
    typer.Option(
        "--quick",
        help="axis_aligned and clamped_shear on 8,12,16,24,32 cells with 4 particles each (of a solver of your own "
        "axis_aligned alone), and no page: a verdict in seconds.",
    ),
]

As = Annotated[str | None, typer.Option("--as", help="Method that a solver of your own is judged as.")]


def mms(
    asked: dict[str, list[str]], replicates: int, quick: bool, judged_as: str | None, out: Path | None, **more: Any
) -> int:
    """Convergence of MPM and its family to a manufactured solution: errors, observed orders, verdict, HTML report."""
    from mpm_verify.verify.run import Settings, conduct, study_of, usage

    if asked.get("start") == ["all"]:
        asked["start"] = list(STARTS)
    if judged_as:
        asked["method"] = [judged_as]
    with usage():
        from mpm_verify.cases.harness.build import Asked

        study, folder = study_of(Asked("mms", values(Run, asked), replicates, quick), out)
    usual = (QUICK if quick else AXES)["cells"]
    chosen = sorted({run.cells for run in study.runs})
    if "cells" not in asked and "solver" not in asked and chosen != list(usual):
        cells = ",".join(map(str, chosen))
        wanted = ",".join(map(str, usual))
        typer.echo(f"cells chosen: {cells}, which fill the body as {wanted} do not; --cells takes others", err=True)
    return conduct(study, Settings(folder, quick=quick, **more))


def add(app: typer.Typer) -> None:
    """Add the command, with an option for each field of a run."""
    own = {"judged_as": (As, None), "replicates": (Replicates, 1), "quick": (Quick, False)}
    study_command(app, "mms", Run, mms, AXES, own)
