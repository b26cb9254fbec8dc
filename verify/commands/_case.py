"""The command of a case that has none of its own: an option for each field of its Run, and those of any study."""

import ast
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from mpm_verify.solver.plugins import CASES, path
from mpm_verify.verify.options import study_command, values

Replicates = Annotated[int, typer.Option(help="Runs of each point, with the particles elsewhere in their cells.")]
Quick = Annotated[bool, typer.Option("--quick", help="Few cells and particles, and no page: a verdict in seconds.")]


def add(app: typer.Typer, case: str) -> None:
    """Add the command `verify CASE`; its Run and axes stand in cases/CASE/run.py."""
    module: Any = import_module(f"{CASES}.{case}.run")

    def command(asked: dict[str, list[str]], replicates: int, quick: bool, out: Path | None, **more: Any) -> int:
        from mpm_verify.verify.run import Settings, conduct, study_of, usage

        with usage():
            from mpm_verify.cases.harness.build import Asked

            study, folder = study_of(Asked(case, values(module.Run, asked), replicates, quick), out)
        return conduct(study, Settings(folder, quick=quick, **more))

    command.__doc__ = (ast.get_docstring(ast.parse(path(CASES, case).read_text())) or "").partition("\n")[0]
    own = {"replicates": (Replicates, 1), "quick": (Quick, False)}
    study_command(app, case, module.Run, command, module.AXES, own, leave_out=("offset",))
