"""`verify methods`: every method on the solutions that tell them apart, ending in error against cost."""

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from mpm_verify.solver.plugins import METHODS
from mpm_verify.verify.commands.mms import repeatable
from mpm_verify.verify.options.choices import choices, completion, integers
from mpm_verify.verify.options.common import Jobs, Json, check_count


def methods(
    method: Annotated[
        list[str] | None,
        typer.Option(
            help=f"{choices(METHODS)}; may be repeated.", autocompletion=completion(METHODS), show_default="all"
        ),
    ] = None,
    ppc: Annotated[str, typer.Option(help="Particles per cell, square numbers.")] = "4",
    quick: Annotated[bool, typer.Option("--quick", help="The bar alone, on up to 64 cells.")] = False,
    jobs: Jobs = None,
    out: Annotated[Path | None, typer.Option(help="Study folder.", show_default="results/methods")] = None,
    json_output: Json = False,
    junit: Annotated[Path | None, typer.Option(help="Write the verdicts as JUnit XML.")] = None,
) -> int:
    """All methods on seven solutions: orders, verdicts, and the error that each reaches at which cost."""
    from mpm_verify.verify.conduct import Settings, conduct, usage

    with usage():
        from mpm_verify.cases.mms.methods import QUICK, Comparison, build_methods, everything

        whole = everything()
        chosen = tuple(dict.fromkeys(method or whole.methods))
        comparison = Comparison(chosen, QUICK if quick else whole.levels, integers(ppc, "--ppc"))
        name = "-".join(["methods", *(chosen if method else ()), *(["quick"] if quick else [])])
        name += f"-ppc-{ppc.replace(',', '-')}" if ppc != "4" else ""
        study = build_methods(comparison, "verify " + shlex.join(repeatable(sys.argv[1:])), name)
        check_count(jobs, "--jobs")
    return conduct(study, Settings(out or Path("results") / study.name, jobs, 1, json_output, junit, compare=True))
