"""`verify methods`: every method on the solutions that tell them apart, ending in error against cost."""

from pathlib import Path
from typing import Annotated, Any

import typer

from mpm_verify.solver.plugins import METHODS
from mpm_verify.verify.choices import choices, completion, integers
from mpm_verify.verify.options import common, split


def methods(
    method: Annotated[
        list[str] | None,
        typer.Option(
            help=f"{choices(METHODS)}; several with commas.", autocompletion=completion(METHODS), show_default="all"
        ),
    ] = None,
    ppc: Annotated[str, typer.Option(help="Particles per cell, square numbers.")] = "4",
    quick: Annotated[bool, typer.Option("--quick", help="The bar alone, on up to 64 cells.")] = False,
    *,
    out: Path | None,
    **more: Any,
) -> int:
    """All methods on seven solutions: orders, verdicts, and the error that each reaches at which cost."""
    from mpm_verify.verify.run import Settings, command, conduct, named, usage
    from mpm_verify.verify.terminal.overview import show_overview

    with usage():
        from mpm_verify.cases.mms.methods import LEVELS, QUICK, build_methods, every_method

        asked = list(dict.fromkeys(name for text in method or () for name in split(text)))
        name = "-".join(["methods", *asked, *(["quick"] if quick else [])])
        name += f"-ppc-{ppc.replace(',', '-')}" if ppc != "4" else ""
        levels = QUICK if quick else LEVELS
        study = build_methods(asked or every_method(), levels, integers(ppc, "--ppc", "4,9"), command(), name)
    return conduct(study, Settings(named(study, out), quick=quick, show=show_overview, **more))


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("methods")(common(methods))
