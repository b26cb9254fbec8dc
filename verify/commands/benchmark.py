"""`verify benchmark`: problems with a known answer: a column under its own weight, bars that meet, and others."""

from pathlib import Path
from typing import Annotated, Any

import typer

from mpm_verify.cases.benchmark.run import Run
from mpm_verify.solver.plugins import PROBLEMS
from mpm_verify.verify.choices import choices, completion
from mpm_verify.verify.commands._case import Quick, Replicates
from mpm_verify.verify.options import study_command, values

Problems = Annotated[
    str | None,
    typer.Argument(
        metavar="[PROBLEM]",
        help=f"{choices(PROBLEMS, own=True)}; several with commas, parameters as self_weight:H=20.",
        show_default="all",
        autocompletion=completion(PROBLEMS),
    ),
]


def benchmark(
    asked: dict[str, list[str]], problems: str | None, replicates: int, quick: bool, out: Path | None, **more: Any
) -> int:
    """Problems with a known answer: errors and orders, numbers against closed forms, and failing controls."""
    from mpm_verify.verify.run import Settings, conduct, study_of, usage

    with usage():
        from mpm_verify.cases.harness.build import Asked

        given = {"problem": [problems], **asked} if problems else asked
        study, folder = study_of(Asked("benchmark", values(Run, given), replicates, quick), out)
    return conduct(study, Settings(folder, quick=quick, **more))


def add(app: typer.Typer) -> None:
    """Add the command, with an option for each field of a run."""
    own = {"problems": (Problems, None), "replicates": (Replicates, 1), "quick": (Quick, False)}
    study_command(app, "benchmark", Run, benchmark, {}, own, leave_out=("problem",))
