"""`verify column`: granular columns, from release to rest."""

from pathlib import Path
from typing import Any

import typer

from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.verify.options import Minutes, Vtk, study_command, values
from mpm_verify.verify.run import CHECKPOINT


def column(asked: dict[str, list[str]], out: Path | None, **more: Any) -> int:
    """Let a column of sand collapse: front, height, profile, energies, an animation."""
    from mpm_verify.verify.run import Settings, command, conduct, named, usage

    with usage():
        from mpm_verify.cases.harness.build import Asked, build

        study = build(Asked("column", values(ColumnRun, asked)), command())
    return conduct(study, Settings(named(study, out), **more))


def add(app: typer.Typer) -> None:
    """Add the command, with an option for each field of a run."""
    study_command(app, "column", ColumnRun, column, {}, {"vtk": (Vtk, False), "checkpoint": (Minutes, CHECKPOINT)})
