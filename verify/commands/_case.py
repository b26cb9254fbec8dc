"""Command of a case that has none of its own: an option for each field of its Run, and those of any study.

A user's case is such a command too: `verify path/to/own.py --cells 8,16,32`.
"""

import ast
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from mpm_verify.solver.plugins import CASES, is_file, path
from mpm_verify.verify.options import study_command, values

Replicates = Annotated[int, typer.Option(help="Runs of each point, with the particles elsewhere in their cells.")]
Quick = Annotated[bool, typer.Option("--quick", help="A smaller or shorter study, and no page: a verdict in seconds.")]


def add(app: typer.Typer, case: str) -> None:
    """Add the command `verify CASE`; its Run and axes stand in cases/CASE/run.py, or in the user's file."""
    typed, module = case, records(case)
    case = str(Path(case).absolute()) if is_file(case) else case

    def command(asked: dict[str, list[str]], replicates: int, quick: bool, out: Path | None, **more: Any) -> int:
        from mpm_verify.verify.run import Settings, conduct, study_of, usage

        with usage():
            from mpm_verify.cases.harness.build import Asked

            study, folder = study_of(Asked(case, values(module.Run, asked), replicates, quick), out)
        return conduct(study, Settings(folder, quick=quick, **more))

    file = Path(case) if is_file(case) else path(CASES, case)
    command.__doc__ = (ast.get_docstring(ast.parse(file.read_text())) or "").partition("\n")[0]
    own = {"replicates": (Replicates, 1), "quick": (Quick, False)}
    study_command(app, typed, module.Run, command, getattr(module, "AXES", {}), own)


def records(case: str) -> Any:
    """The module with the Run and the axes of a case."""
    if not is_file(case):
        return import_module(f"{CASES}.{case}.run")
    from mpm_verify.cases.harness.contract import case_named
    from mpm_verify.verify.run import usage

    with usage():
        return case_named(str(Path(case).absolute())).module
