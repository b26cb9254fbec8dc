"""`verify list`: what there is to choose from. Reads file names and docstrings, imports nothing."""

import ast
from pathlib import Path

import typer

from solver.plugins import available
from verify.output import printing

KINDS = {
    "cases": "cases.library",
    "methods": "solver.basis",
    "solutions": "mms.solutions",
    "materials": "solver.material",
}


def list_plugins() -> None:
    """List cases, methods, solutions and materials with a line about each."""
    with printing():
        for kind, package in KINDS.items():
            typer.echo(kind)
            for name in available(package):
                typer.echo(f"  {name:16}{summary(package, name)}")


def summary(package: str, name: str) -> str:
    """First sentence of a plug-in's docstring, without importing it."""
    folder = Path(__file__).resolve().parent.parent.joinpath(*package.split("."))
    text = ast.get_docstring(ast.parse((folder / f"{name}.py").read_text())) or ""
    return text.partition("\n")[0]
