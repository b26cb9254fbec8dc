"""`verify list`: what there is to choose from. Reads file names and docstrings, imports nothing."""

import ast

import typer

from mpm_verify.cases.harness.shipped import shipped, title
from mpm_verify.solver.plugins import (
    CASES,
    KINDS,
    LAYOUTS,
    MATERIALS,
    METHODS,
    NEGATIVE_CONTROLS,
    PROBLEMS,
    RATES,
    SMOOTHINGS,
    SOLUTIONS,
    TRANSFERS,
    available,
    path,
)
from mpm_verify.verify.terminal.output import printing

PACKAGES = (CASES, METHODS, TRANSFERS, SMOOTHINGS, LAYOUTS, SOLUTIONS, PROBLEMS, MATERIALS, RATES, NEGATIVE_CONTROLS)
REMARKS = {
    PROBLEMS: " (of verify benchmark)",
    RATES: " (of the materials in rate form)",
    NEGATIVE_CONTROLS: " (negative controls, taken as a rate)",
}


def list_plugins() -> None:
    """List cases, plug-ins of every kind and studies, with a line about each."""
    with printing():
        for package in PACKAGES:
            typer.echo(f"{KINDS[package]}s{REMARKS.get(package, '')}")
            for name in available(package):
                typer.echo(f"  {name:20}{summary(package, name)}")
        typer.echo("studies (verify sweep)")
        for name in shipped():
            typer.echo(f"  {name:20}{title(name)}")


def summary(package: str, name: str) -> str:
    """First sentence of a plug-in's docstring, without importing it."""
    text = ast.get_docstring(ast.parse(path(package, name).read_text())) or ""
    return text.partition("\n")[0]


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("list")(list_plugins)
